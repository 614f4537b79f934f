"""Quaternions, their means, and their interpolation in time."""
