"""Confidence for filters that have no weights of their own: doubtful samples give way to their surroundings first."""

import numpy as np

from quatfilt._reference._arrays import Reals
from quatfilt._reference.filters.boundary import extend_by_index
from quatfilt._reference.filters.gaps import fill_gaps
from quatfilt._reference.rotations.quaternion import continuous, norm, normalize
from quatfilt._reference.rotations.resample import geodesic

SIGMA = 2.0
"""Frames: deviation of the Gaussian with which surroundings weigh."""

RADIUS = 8
"""Frames: how far surroundings reach, four deviations."""


def pulled_by_confidence(q: Reals, confidence: Reals) -> Reals:
    """Replace samples as far as they are not trusted.

    Samples of confidence 0 are missing ones: they are filled in along the geodesics between the others. Samples of a
    confidence `c` between 0 and 1 move by `1 − c` of the way towards the mean of their surroundings, themselves
    included,

        `m_t = Σ_r exp(−r² / 2σ²) c_{t+r} q_{t+r} / |Σ_r …|`,    `r = −8 … 8`,    `σ = 2`,

    along the path that is continuous in sign, with mirrored ends. Samples of confidence 1 stay as they are, and so do
    joints that are trusted nowhere.

    Parameters
    ----------
    q : array (frames, joints, 4)
        Rotations without missing samples.
    confidence : array (frames, joints)
        Confidences in [0, 1].

    Returns
    -------
    array (frames, joints, 4)
        Continuous in sign from the first trusted sample.
    """
    if q.size == 0:
        return q.copy()
    trust = confidence.astype(np.float64)
    gone = (trust == 0) & (trust > 0).any(axis=0)
    filled, _ = fill_gaps(np.where(gone[..., None], np.nan, q).astype(q.dtype), -1, "slerp")
    path = normalize(filled.astype(np.float64))
    pulled = geodesic(path, surroundings(path, trust), (1 - trust)[..., None])
    doubtful = (trust > 0) & (trust < 1)
    return continuous(np.where(doubtful[..., None], pulled, filled).astype(q.dtype))


def surroundings(path: Reals, trust: Reals) -> Reals:
    """Means of the samples around each one, weighted by confidence and by nearness in time: unit quaternions.

    Where nothing around is trusted, or the sum is 0, the sample itself.
    """
    frames = len(path)
    weighted = extend_by_index(trust[..., None] * path, RADIUS, "mirror")
    total = np.zeros(path.shape)
    for r in range(-RADIUS, RADIUS + 1):
        start = RADIUS + r
        total += np.exp(-(r**2) / (2 * SIGMA**2)) * weighted[start : start + frames]
    empty = norm(total) == 0
    return normalize(np.where(empty[..., None], path, total))
