"""Local models: the next pose from the last ones, learned from the few examples that are most like them."""
