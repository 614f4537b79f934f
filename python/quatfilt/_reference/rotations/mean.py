"""Karcher means of rotations."""

import numpy as np

from quatfilt._reference._arrays import Reals
from quatfilt._reference.rotations.quaternion import (
    between,
    exp,
    is_missing,
    log_short,
    multiply,
    norm,
    normalize,
)

STEP = 1e-14
"""Steps shorter than this (radians on S³) end the iteration: a few roundings of float64."""

ITERATIONS = 100
"""Most steps. Each one shrinks the error at least to a third where rotations spread evenly about an axis."""


def mean(q: Reals, weights: Reals | None) -> Reals:
    """Karcher mean of each joint's rotations over the frames, `(frames, joints, 4)` → `(joints, 4)`.

    The mean minimises `Σ_t w_t d(x, q_t)²`, where `d` is the geodesic distance. At the minimum the logarithms seen from
    it cancel, so the iteration steps along their mean, `x ← x · exp(Σ w_t log(x⁻¹ q_t) / Σ w_t)`, each taken the
    shorter way. It starts from the chordal mean. The signs of the samples do not matter; the result has `w ≥ 0`.

    Parameters
    ----------
    q : array (frames, joints, 4)
        Rotations. Missing samples are left out.
    weights : array (frames, joints) or None
        Weights `≥ 0`; `None` counts all samples alike. A joint whose weights are all 0 gets NaN.
    """
    rotations, weights = usable_samples(q, weights)
    total = weights.sum(axis=0)
    x = chordal_mean(rotations, weights)
    for _ in range(ITERATIONS):
        with np.errstate(invalid="ignore"):
            step = np.einsum("tj,tjc->jc", weights, log_short(between(x[None], rotations))) / total[:, None]
        x = normalize(multiply(x, exp(step)))
        if not np.any(norm(step) >= STEP):
            break
    x = x * np.copysign(1, x[:, :1])
    x[total == 0] = np.nan
    return x.astype(q.dtype)


def usable_samples(q: Reals, weights: Reals | None) -> tuple[Reals, Reals]:
    """Return unit quaternions and weights in float64, where missing samples have become 1 with weight 0."""
    missing = is_missing(q)
    rotations = np.where(missing[..., None], [1.0, 0.0, 0.0, 0.0], q.astype(np.float64))
    given = np.ones(missing.shape) if weights is None else weights.astype(np.float64)
    return normalize(rotations), np.where(missing, 0.0, given)


def chordal_mean(q: Reals, weights: Reals) -> Reals:
    """Mean that minimises the squared chords: the eigenvector of `Σ w q qᵀ` for its largest eigenvalue; `(joints, 4)`."""
    outer_products = np.einsum("tj,tja,tjb->jab", weights, q, q)
    _, vectors = np.linalg.eigh(outer_products)
    return np.ascontiguousarray(vectors[..., -1])
