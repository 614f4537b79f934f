"""Unit quaternions: algebra, statistics and resampling."""
