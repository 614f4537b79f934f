"""Analysis of rotations by geodesics."""
