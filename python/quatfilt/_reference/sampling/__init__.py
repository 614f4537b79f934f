"""The clock of the source: which frames of a clip were measured, and the way from them back to all frames."""
