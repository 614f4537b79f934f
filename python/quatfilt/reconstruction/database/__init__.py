"""Databases of poses: made of motions or of folders of files, kept in a file that opens without being read."""

from quatfilt.reconstruction.database.database import MotionDatabase

__all__ = ["MotionDatabase"]
