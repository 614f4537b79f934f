"""Unit quaternions: clips and poses."""

import math
from typing import Any

from quatfilt import _backend
from quatfilt._typing import Array
from quatfilt._validation.arrays import quaternions

_FAR_FROM_UNIT = 0.1
"""A norm that differs from 1 by more is no rounding error: such data are not unit quaternions."""


def clip(value: Any, name: str = "rotations", *, scalar_first: bool = True) -> tuple[Array, int]:
    """Return `value` as ``(frames, joints, 4)``, and how many of its samples are missing.

    Raises
    ------
    ValueError
        For another shape, and for samples that are neither missing nor near unit length.
    """
    array = quaternions(value, name, scalar_first=scalar_first)
    if array.ndim not in (2, 3):
        raise ValueError(f"{name}: expected shape (frames, joints, 4) or (frames, 4), got {array.shape}")
    array = array.reshape(array.shape[0], -1 if array.size else math.prod(array.shape[1:-1]), 4)
    missing, worst, index = _backend.ops().scan(array)
    if worst > _FAR_FROM_UNIT:
        frame, joint = divmod(index, array.shape[1])
        norm = math.hypot(*array[frame, joint].tolist())
        raise ValueError(
            f"{name}: expected unit quaternions, got norm {norm:.6g} at frame {frame}, joint {joint}",
        )
    return array, missing


def pose(value: Any, like: Array | None, *, scalar_first: bool) -> Array:
    """Return `value` as ``(joints, 4)`` or ``(4,)``: the shape and dtype of `like`, the first pose, if there was one."""
    array = quaternions(value, "pose", scalar_first=scalar_first)
    if array.ndim not in (1, 2):
        raise ValueError(f"pose: expected shape (joints, 4) or (4,), got {array.shape}")
    if like is not None and array.shape != like.shape:
        raise ValueError(f"pose: expected shape {like.shape} as in the first push, got {array.shape}")
    if like is not None and array.dtype != like.dtype:
        raise TypeError(f"pose: expected dtype {like.dtype} as in the first push, got {array.dtype}")
    rows = array.reshape(1, -1, 4)
    _, worst, joint = _backend.ops().scan(rows)
    if worst > _FAR_FROM_UNIT:
        norm = math.hypot(*rows[0, joint].tolist())
        raise ValueError(f"pose: expected unit quaternions, got norm {norm:.6g} at joint {joint}")
    return array
