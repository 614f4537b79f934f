"""Motion from a few trajectories."""
