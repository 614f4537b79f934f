"""Places of control points."""

from typing import Any

import numpy as np

from quatfilt._typing import Array
from quatfilt._validation.arrays import floats


def control_points(value: Any, name: str, points: int, *, one: bool = False) -> Array:
    """Return places ``(frames, points, 3)``, or of `one` frame ``(points, 3)``; NaN where a point is not seen.

    Raises
    ------
    ValueError
        For another shape, for no frames, and for places at infinity.
    """
    array = floats(value, name)
    frames = () if one else ("frames",)
    if array.ndim != len(frames) + 2 or array.shape[-2:] != (points, 3):
        expected = ", ".join([*frames, str(points), "3"])
        raise ValueError(f"{name}: expected shape ({expected}), got {array.shape}")
    if not len(array):
        raise ValueError(f"{name}: expected at least one frame, got none")
    infinite = np.argwhere(np.isinf(array))
    if len(infinite):
        at = infinite[0].tolist()
        where = f"point {at[-2]}" if one else f"frame {at[0]}, point {at[1]}"
        raise ValueError(
            f"{name}: expected finite numbers, or NaN where a point is not seen, got {array[tuple(at)]} at {where}"
        )
    return array
