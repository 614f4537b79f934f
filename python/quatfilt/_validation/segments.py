"""Examples for the next pose, and the last poses of a motion."""

from typing import Any

import numpy as np

from quatfilt._typing import Array
from quatfilt._validation.arrays import floats, quaternions
from quatfilt._validation.poses import clip


def segments(value: Any, recent: Any, *, scalar_first: bool) -> tuple[Array, Array]:
    """Return examples ``(K, m + 1, joints, 4)`` and the last poses ``(m, joints, 4)``, of one dtype and without missing samples."""
    examples = quaternions(value, "segments", scalar_first=scalar_first)
    if examples.ndim != 4 or examples.shape[0] < 1 or examples.shape[1] < 2 or examples.shape[2] < 1:
        raise ValueError(
            "segments: expected shape (K, m + 1, joints, 4) with at least one example of two poses, "
            f"got {examples.shape}"
        )
    poses = quaternions(recent, "recent", scalar_first=scalar_first)
    expected = (examples.shape[1] - 1, *examples.shape[2:])
    if poses.shape != expected:
        raise ValueError(
            f"recent: expected shape {expected}, that of the first poses of segments, got {poses.shape}"
        )
    for name, array in (("segments", examples.reshape(-1, *expected[1:])), ("recent", poses)):
        _, missing = clip(array, name)
        if missing:
            raise ValueError(f"{name}: expected no missing samples, got {missing}")
    dtype = np.result_type(examples.dtype, poses.dtype)
    return examples.astype(dtype, copy=False), poses.astype(dtype, copy=False)


def root_steps(value: Any, examples: Array) -> Array:
    """Return `value` as ``(K, n)``, of the dtype of the examples; none for None."""
    if value is None:
        return np.zeros((len(examples), 0), examples.dtype)
    steps = floats(value, "root_steps")
    if steps.ndim != 2 or len(steps) != len(examples):
        raise ValueError(f"root_steps: expected shape ({len(examples)}, n), got {steps.shape}")
    if not np.isfinite(steps).all():
        raise ValueError(f"root_steps: expected finite numbers, got {steps[~np.isfinite(steps)][0]}")
    return np.require(steps, examples.dtype, ("C_CONTIGUOUS", "ALIGNED"))


def joint_weights(value: Any, joints: int) -> Array:
    """Return `value` as one weight per joint, float64; ones for None."""
    if value is None:
        return np.ones(joints)
    weights = floats(value, "joint_weights").astype(np.float64)
    if weights.shape != (joints,):
        raise ValueError(f"joint_weights: expected shape ({joints},), got {weights.shape}")
    wrong = weights[~(np.isfinite(weights) & (weights >= 0))]
    if len(wrong):
        raise ValueError(f"joint_weights: expected finite numbers of at least 0, got {wrong[0]}")
    return weights
