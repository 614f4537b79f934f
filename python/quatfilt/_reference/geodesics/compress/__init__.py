"""Compression of rotations to a tolerance."""
