"""Orientation filters: a mask for numbers becomes a filter for rotations.

J. Lee and S. Y. Shin, *General Construction of Time-Domain Filters for Orientation Data*, 2002.
"""

import numpy as np

from quatfilt._reference._arrays import Reals
from quatfilt._reference.filters.boundary import Boundary, extend_rotations, extend_vectors
from quatfilt._reference.filters.nonlocal_pose_means.nonlocal_pose_means import in_hemisphere_of
from quatfilt._reference.rotations.quaternion import between, exp, log_short, multiply, normalize


def orientation_filter(
    q: Reals, translation: Reals | None, mask: Reals, iterations: int, boundary: Boundary
) -> tuple[Reals, Reals | None]:
    """Move each frame by a weighted sum of the rotations from frame to frame around it.

    With the increments `ω_i = log(q_i⁻¹ q_{i+1})`, each the shorter way, and the mask `m_{−k} … m_k`, whose sum is made 1,

        `H(q_i) = q_i · exp(Σ_{r=−k}^{k−1} b_r ω_{i+r})`

    with the coefficients of :func:`coefficients`. About one fixed axis this is the mask's mean of the unrolled angles.

    Parameters
    ----------
    q : array (frames, joints, 4)
        Rotations without missing samples.
    translation : array (frames, 3) or None
        Positions of the root, averaged with the mask in each pass.
    mask : array (2k + 1,)
        Weights of the frames `t − k … t + k`; their sum is not 0.
    iterations : int
        How often the filter is applied.
    boundary : "mirror", "linear" or "nearest"
        How the clip goes on beyond its ends, anew for each pass; see :mod:`.boundary`.

    Returns
    -------
    rotations : array (frames, joints, 4)
        Unit quaternions, continuous in sign from the hemisphere of the input's first frame.
    translation : array (frames, 3) or None
    """
    frames, joints = q.shape[:2]
    if frames < 2 or joints == 0:
        return normalize(q), None if translation is None else translation.copy()
    radius = len(mask) // 2
    result = normalize(q.astype(np.float64))
    moved = None if translation is None else translation.astype(np.float64)
    b = coefficients(mask)
    for _ in range(iterations):
        if moved is not None:
            around = extend_vectors(moved, radius, boundary)
            moved = np.zeros((frames, 3))
            for j in range(2 * radius + 1):
                moved += mask[j] / mask.sum() * around[j : j + frames]
        increments = increments_around(result, radius, boundary)
        turn = np.zeros((frames, joints, 3))
        for r in range(len(b)):
            turn += b[r] * increments[r : r + frames]
        result = normalize(multiply(result, exp(turn)))
    rotations = in_hemisphere_of(result, q).astype(q.dtype)
    return rotations, None if translation is None or moved is None else moved.astype(translation.dtype)


def coefficients(mask: Reals) -> Reals:
    """Coefficients `b_{−k} … b_{k−1}` of the increments, for masks `(…, 2k + 1)` → `(…, 2k)`.

    `q_{i+j}` lies `ω_i + … + ω_{i+j−1}` after `q_i` and, for `j < 0`, `ω_{i+j} + … + ω_{i−1}` *before* it. Gathering what
    each increment is weighted with,

        `b_r = −Σ_{j=−k}^{r} m_j`   for `r < 0`,        `b_r = Σ_{j=r+1}^{k} m_j`   for `r ≥ 0`.

    Courty's equation (3) lacks the minus sign; without it the filter adds noise.
    """
    radius = mask.shape[-1] // 2
    m = mask / mask.sum(axis=-1, keepdims=True)
    before = np.cumsum(m[..., :radius], axis=-1)
    after = np.cumsum(m[..., :radius:-1], axis=-1)[..., ::-1]
    return np.concatenate([-before, after], axis=-1)


def increments_around(q: Reals, radius: int, boundary: Boundary) -> Reals:
    """Half rotation vectors `ω_{i}` from each frame to the next, from `i = −radius` on: `(frames + 2·radius − 1, joints, 3)`."""
    path = extend_rotations(q, radius, boundary)
    return log_short(between(path[:-1], path[1:]))
