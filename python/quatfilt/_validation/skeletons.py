"""Skeletons, and what moves them."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from quatfilt._typing import Array
from quatfilt._validation.arrays import floats
from quatfilt._validation.poses import clip


def parents(value: ArrayLike, joints: int) -> NDArray[np.int64]:
    """Return `value` as the parents of `joints` joints, read-only: each comes before its child, −1 for a root."""
    array = np.asarray(value)
    if array.size == 0:
        array = array.astype(np.int64)
    if array.dtype.kind not in "iu":
        raise TypeError(f"parents: expected integers, got dtype {array.dtype}")
    if array.shape != (joints,):
        raise ValueError(f"parents: expected one parent for each of {joints} names, got shape {array.shape}")
    result = array.astype(np.int64)
    for joint, parent in enumerate(result):
        if not -1 <= parent < joint:
            raise ValueError(
                f"parents: expected −1 or the index of a joint before it for joint {joint}, got {parent}"
            )
    result.setflags(write=False)
    return result


def offsets(value: ArrayLike, joints: int) -> NDArray[np.float64]:
    """Return `value` as the offsets of `joints` joints, read-only."""
    array = floats(value, "offsets").astype(np.float64)
    if array.shape != (joints, 3) and not (joints == 0 and array.size == 0):
        raise ValueError(f"offsets: expected shape ({joints}, 3), got {array.shape}")
    if not np.isfinite(array).all():
        raise ValueError(f"offsets: expected finite numbers, got {array[~np.isfinite(array)][0]}")
    array = array.reshape(joints, 3)
    array.setflags(write=False)
    return array


def posed(
    rotations: ArrayLike,
    translation: ArrayLike,
    joint_translations: ArrayLike | None,
    parents: NDArray[np.int64],
) -> tuple[Array, Array, Array | None]:
    """Return rotations, translation and joint translations of a skeleton in motion, of one dtype."""
    q, _ = clip(rotations)
    frames, joints = q.shape[:2]
    if joints != len(parents):
        raise ValueError(f"rotations: expected {len(parents)} joints as in the skeleton, got {joints}")
    moved = floats(translation, "translation")
    if moved.shape != (frames, 3):
        raise ValueError(f"translation: expected shape ({frames}, 3), got {moved.shape}")
    moved = np.require(moved, q.dtype, ("C_CONTIGUOUS", "ALIGNED"))
    if joint_translations is None:
        return q, moved, None
    own = floats(joint_translations, "joint_translations")
    if own.shape != (frames, joints, 3):
        raise ValueError(f"joint_translations: expected shape ({frames}, {joints}, 3), got {own.shape}")
    return q, moved, np.require(own, q.dtype, ("C_CONTIGUOUS", "ALIGNED"))
