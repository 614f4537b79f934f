"""Exact principal geodesic analysis: geodesics of rotations through their mean, one after the other."""
