"""Automatic smoothing: how much, is read off the clip."""

from quatfilt._reference.filters.smooth.smooth import smooth

__all__ = ["smooth"]
