"""Motion from a few trajectories: the database of poses, local models."""
