"""Motions and their skeletons."""
