"""Places of control points."""

from typing import Any

import numpy as np

from quatfilt._typing import Array
from quatfilt._validation.arrays import floats

_FARTHEST = 1e9
"""Units: a kilometre in micrometres. What some systems write for points that are not seen is larger, and its square leaves no
digits for a body."""


def control_points(value: Any, name: str, points: int, *, one: bool = False) -> Array:
    """Return places ``(frames, points, 3)``, or of `one` frame ``(points, 3)``; NaN where a point is not seen.

    Raises
    ------
    ValueError
        For another shape, for no frames, and for places farther away than any.
    """
    array = floats(value, name)
    frames = () if one else ("frames",)
    if array.ndim != len(frames) + 2 or array.shape[-2:] != (points, 3):
        expected = ", ".join([*frames, str(points), "3"])
        raise ValueError(f"{name}: expected shape ({expected}), got {array.shape}")
    if not len(array):
        raise ValueError(f"{name}: expected at least one frame, got none")
    far = np.argwhere(np.abs(array) > _FARTHEST)
    if len(far):
        at = far[0].tolist()
        where = f"point {at[-2]}" if one else f"frame {at[0]}, point {at[1]}"
        raise ValueError(
            f"{name}: expected numbers of at most {_FARTHEST:g} units, or NaN where a point is not seen, got {array[tuple(at)]:g} at {where}"
        )
    return array
