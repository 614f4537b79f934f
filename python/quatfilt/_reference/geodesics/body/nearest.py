"""The direction of the nearest geodesic of poses, from several starts."""

import numpy as np

from quatfilt._reference._arrays import Reals
from quatfilt._reference.geodesics.body.descent import descent
from quatfilt._reference.geodesics.body.distance import logarithms
from quatfilt._reference.geodesics.body.objective import slope
from quatfilt._reference.rotations.quaternion import norm

SUBSET = 512
"""Poses, at most, on which the starts descend: enough to tell valleys apart."""

SUBSET_STEPS = 60
"""Largest number of steps on the subset; the final descent runs on all poses."""

LOWER = 1e-12
"""Relative: a start that is not better by more is as good as the one before, and roundings do not choose between them."""


def nearest_geodesic(x: Reals, objective: str) -> tuple[Reals, list[float]]:
    """Direction with the lowest objective that was found, and the values of the descent that led to it.

    The starts descend on a subset of the poses; from the best of where they come out, or from the tangent principal axis
    itself if that is better, the descent goes on over all poses. So no tangent principal axis is better than the result.
    """
    tangent, *others = starts(x)
    subset = x[:: -(-len(x) // SUBSET)]
    tried = [tangent, *(descent(subset, v, objective, SUBSET_STEPS)[0] for v in (tangent, *others))]
    best, least = tangent, np.inf
    for v in tried:
        value = slope(x, v, objective).value
        if value < least * (1 - LOWER):
            best, least = v, value
    v, _, values = descent(x, best, objective)
    return v, values


def starts(x: Reals) -> list[Reals]:
    """Directions that the logarithms `y` of the poses suggest, `(joints, 3)` each.

    The first three eigenvectors of `Σ y yᵀ`, which are tangent principal component analysis, and of
    `Σ y yᵀ/|y|²` over the subset, where all poses count alike.
    """
    shape = x.shape[1:-1]
    y = logarithms(x).reshape(len(x), -1)
    few = y[:: -(-len(y) // SUBSET)]
    lengths = norm(few)[:, None]
    alike = few / np.where(lengths > 0, lengths, 1)
    axes = [*axes_of(y)[:3], *axes_of(alike)[:3]]
    return [axis.reshape(*shape, 3) for axis in axes]


def axes_of(vectors: Reals) -> Reals:
    """Eigenvectors of `Σ y yᵀ`, the greatest first."""
    return np.ascontiguousarray(np.linalg.eigh(vectors.T @ vectors)[1].T[::-1])
