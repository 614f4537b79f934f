"""The chart of some examples: rotations of poses as vectors."""

import numpy as np

from quatfilt._reference._arrays import Reals
from quatfilt._reference.rotations.quaternion import between, log_short, normalize


def mean_chart(segments: Reals) -> Reals:
    """Where each joint's chart touches the rotations: the renormalised mean of the examples' poses, `(joints, 4)`.

    Signs are taken so that each rotation lies in the hemisphere of the first example's last pose but one, which a sum that
    contains itself never cancels. Models subtract the means of the vectors, so that the chart need not touch at the Karcher
    mean exactly, and is the mean of neighbours that are alike to the square of their angles anyway.

    Parameters
    ----------
    segments : array (K, m + 1, joints, 4)
        Examples: m poses and the next one.
    """
    rotations = segments.astype(np.float64)
    signs = np.where(np.sum(rotations * rotations[0, -2], axis=-1, keepdims=True) < 0, -1.0, 1.0)
    return normalize(np.sum(signs * rotations, axis=(0, 1)))


def seen_from(chart: Reals, rotations: Reals) -> Reals:
    """Rotation vectors `2 log(c⁻¹ q)` in radians, the shorter way, `(..., joints, 4)` → `(..., joints, 3)`."""
    wide = rotations.astype(np.float64)
    return 2 * log_short(between(np.broadcast_to(chart, wide.shape), wide))
