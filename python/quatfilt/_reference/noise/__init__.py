"""The noise level of clips of rotations."""
