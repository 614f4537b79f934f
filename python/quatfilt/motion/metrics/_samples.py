"""What the measures share: comparable clips, missing samples, means that leave those out."""

from typing import Literal, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from quatfilt import _validation
from quatfilt._backend import ops
from quatfilt._typing import Mask

Values: TypeAlias = NDArray[np.float64]

Per: TypeAlias = Literal["clip", "joint"]
"""Over what a mean is taken."""

PerSample: TypeAlias = Literal["clip", "joint", "sample"]

PER: tuple[Per, ...] = ("clip", "joint")
PER_SAMPLE: tuple[PerSample, ...] = ("clip", "joint", "sample")


def clip(q: ArrayLike, name: str, *, scalar_first: bool) -> tuple[Values, tuple[int, ...]]:
    """Return rotations ``(frames, joints, 4)`` with NaN for missing samples, and the shape of what was passed."""
    array = _validation.quaternions(q, name, scalar_first=scalar_first)
    rotations, missing = _validation.clip(array, name)
    result = rotations.astype(np.float64)
    if missing:
        result[~(np.isfinite(result).all(axis=-1) & (result != 0).any(axis=-1))] = np.nan
    return result, array.shape


def pair(
    reference: ArrayLike, estimate: ArrayLike, *, scalar_first: bool
) -> tuple[Values, Values, tuple[int, ...]]:
    """Return two clips of one shape."""
    truth, shape = clip(reference, "reference", scalar_first=scalar_first)
    other, found = clip(estimate, "estimate", scalar_first=scalar_first)
    if found != shape:
        raise ValueError(f"estimate: expected the reference's shape {shape}, got {found}")
    return truth, other, shape


def turns(a: Values, b: Values) -> Values:
    """Rotation vectors of ``a⁻¹b``, the shorter way, in radians; NaN where either is missing; ``(..., 3)``."""
    missing: Mask = np.asarray(np.isnan(a + b).any(axis=-1))
    identity = np.array([1.0, 0.0, 0.0, 0.0])
    left = np.where(missing[..., None], identity, a).reshape(-1, 4)
    right = np.where(missing[..., None], identity, b).reshape(-1, 4)
    between = ops().multiply(ops().conjugate(left), right)
    between *= np.where(between[:, :1] < 0, -1.0, 1.0)
    vectors: Values = 2 * ops().log(between).reshape(*a.shape[:-1], 3)
    vectors[missing] = np.nan
    return vectors


def mean(values: Values, axis: int | tuple[int, ...] | None = None) -> Values:
    """Mean of what is not NaN; NaN where there is nothing."""
    valid = ~np.isnan(values)
    count = np.sum(valid, axis=axis)
    total = np.sum(np.where(valid, values, 0.0), axis=axis)
    return np.asarray(np.where(count > 0, total / np.maximum(count, 1), np.nan), np.float64)


def percentile(values: Values, percent: float) -> Values:
    """Percentile over the frames of what is not NaN; NaN for joints without any; ``(joints,)``."""
    result = np.full(values.shape[1:], np.nan)
    for joint, column in enumerate(values.T):
        present = column[~np.isnan(column)]
        if len(present):
            result[joint] = np.percentile(present, percent)
    return result


def reduced(values: Values, per: PerSample, shape: tuple[int, ...]) -> float | Values:
    """Mean of ``(frames, joints)`` as asked for, in the shape that fits the caller's rotations."""
    if per == "clip":
        return float(mean(values))
    if per == "joint":
        return mean(values, axis=0).reshape(shape[1:-1])
    return values.reshape(shape[:-1])
