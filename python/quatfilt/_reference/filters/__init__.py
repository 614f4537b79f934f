"""Filters of clips of rotations."""
