"""Feet on the ground: where they belong, and the legs that bring them there."""
