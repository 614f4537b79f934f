"""Skeletons in motion."""
