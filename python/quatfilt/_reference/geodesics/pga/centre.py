"""The centre of rotations, and whether it is one."""

import numpy as np

from quatfilt._reference._arrays import Mask, Reals
from quatfilt._reference.rotations.mean import ITERATIONS, STEP, mean
from quatfilt._reference.rotations.quaternion import (
    between,
    exp,
    geodesic_distance,
    is_missing,
    log_short,
    multiply,
    norm,
    normalize,
)

CERTAIN_RADIUS = np.pi / 2
"""Radians of rotation: of samples that lie nearer to their mean there is no other one (Afsari 2011)."""

SAME_MEAN = 1e-6
"""Radians on S³: two ends of the iteration that are nearer are one."""

SUBSET = 4096
"""Samples, at most, that are asked whether there is another mean."""

AS_GOOD = 1e-9
"""Relative difference of mean squared distances up to which another mean is as good."""


def geodesic_centre(q: Reals) -> tuple[Reals, Reals, Mask]:
    """Karcher mean of each joint, how far the samples reach from it, and whether it is the only one.

    Parameters
    ----------
    q : array (frames, joints, 4)
        Rotations. Missing samples are left out.

    Returns
    -------
    means : array (joints, 4), float64
        Unit quaternions with `w ≥ 0`; NaN for a joint without samples.
    radius : array (joints,), radians of rotation, float64
        Greatest angle from the mean to a sample; NaN for a joint without samples.
    unique : array (joints,)
        Whether no other rotation has as small a mean squared distance to the samples: none to which the iteration leads
        from the principal axes of the samples in R⁴ and from the diagonals between them.
    """
    wide = q.astype(np.float64)
    means = mean(wide, None)
    frames, joints = q.shape[:2]
    angles = geodesic_distance(np.broadcast_to(means, wide.shape), wide)
    angles[is_missing(q)] = np.nan
    radius = np.full(joints, np.nan)
    unique = np.ones(joints, dtype=np.bool_)
    for joint in range(joints):
        seen = np.isfinite(angles[:, joint])
        if frames and seen.any():
            radius[joint] = angles[seen, joint].max()
            if radius[joint] >= CERTAIN_RADIUS:
                unique[joint] = is_only_mean(means[joint], wide[seen, joint])
    return means, radius, unique


def is_only_mean(centre: Reals, q: Reals) -> bool:
    """Whether the iteration for the mean ends nowhere else with as small a mean square; `(4,)`, `(n, 4)`."""
    samples = normalize(q[:: -(-len(q) // SUBSET)])
    axes = np.linalg.eigh(np.einsum("na,nb->ab", samples, samples))[1].T
    signs = np.array([[1, a, b, c] for a in (1, -1) for b in (1, -1) for c in (1, -1)])
    here = iterated(centre, samples)
    least = mean_square(here, samples) * (1 + AS_GOOD)
    others = [iterated(start, samples) for start in [*axes, *(signs @ axes / 2)]]
    return not any(
        norm(log_short(between(here, other))) > SAME_MEAN and mean_square(other, samples) <= least
        for other in others
    )


def iterated(start: Reals, q: Reals) -> Reals:
    """Return the result of the iteration for the mean from a start; `(4,)`, `(n, 4)`."""
    x = start
    for _ in range(ITERATIONS):
        step = np.mean(log_short(between(np.broadcast_to(x, q.shape), q)), axis=0)
        x = normalize(multiply(x, exp(step)))
        if norm(step) < STEP:
            break
    return x


def mean_square(x: Reals, q: Reals) -> float:
    """Mean squared distance on S³ from `x` to the samples; `(4,)`, `(n, 4)`."""
    return float(np.mean(norm(log_short(between(np.broadcast_to(x, q.shape), q))) ** 2))
