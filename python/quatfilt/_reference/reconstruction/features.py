"""Poses as vectors whose distances are those of the poses."""

import numpy as np
from numpy.typing import NDArray

from quatfilt._reference._arrays import Reals
from quatfilt._reference.rotations.quaternion import between, is_missing, log_short


def pose_features(q: Reals, means: NDArray[np.float64], weights: NDArray[np.float64]) -> Reals:
    """Poses as weighted rotation vectors from the means of their joints, `(frames, joints, 4)` → `(frames, 3·joints)`.

    `x_j = √w_j · 2 log(m_j⁻¹ q_j)`, each the shorter way: the sign of `q_j` does not matter. The squared distance of two poses
    near the means is the weighted sum of their squared rotation angles.

    Parameters
    ----------
    q : array (frames, joints, 4)
        Rotations, unit quaternions. A missing sample gives three NaN.
    means : array (joints, 4) of float64
        The poses' means `m`.
    weights : array (joints,) of float64
        Weights `w ≥ 0` of the joints.
    """
    with np.errstate(invalid="ignore"):
        vectors = 2 * log_short(between(means[None], q.astype(np.float64)))
    vectors[is_missing(q)] = np.nan
    return (np.sqrt(weights)[:, None] * vectors).reshape(len(q), 3 * len(means)).astype(q.dtype)
