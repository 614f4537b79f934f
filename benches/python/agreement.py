"""Correctness before time: nothing is timed that does not agree."""

import numpy as np
import quatfilt as qf
from clips import Array

ANGLE = {np.dtype(np.float32): 1e-4, np.dtype(np.float64): 1e-9}
"""Radians. Peers sum in other orders and, in float32, with relaxed arithmetic."""


def angles(name: str, ours: Array, theirs: Array) -> None:
    """Stop unless two arrays hold the same rotations."""
    distance = qf.geodesic_distance(ours, np.ascontiguousarray(theirs, ours.dtype))
    numbers(name, distance, np.zeros_like(distance))


def numbers(name: str, ours: Array, theirs: Array) -> None:
    """Stop unless two arrays hold the same numbers."""
    worst = float(np.max(np.abs(ours - theirs)))
    if not worst <= ANGLE[ours.dtype]:
        raise SystemExit(f"{name}: differs from quatfilt by {worst:.3g}")
