"""Skeletons, motion, and how to measure it."""
