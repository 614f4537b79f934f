"""Filters: a clip in, a cleaner clip out."""
