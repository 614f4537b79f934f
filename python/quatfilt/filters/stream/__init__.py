"""Streams: a pose in, a cleaner pose out."""
