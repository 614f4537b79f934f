"""Noise: how much there is, and how to add some."""
