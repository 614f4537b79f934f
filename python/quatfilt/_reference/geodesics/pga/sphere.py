"""The direction of the nearest geodesic, sought on the whole sphere of directions.

Branch and bound leaves no valley out. The half sphere is a cube's three faces, cut into squares. Within `δ` of the middle
`c` of a square a sample's distance changes by no more than `δ·r`, `r = |u|`, and, where it has no cone point there, it bends
down by no more than `r/w`, so that the mean over such samples is at least

    F(c) − |∇F(c)| δ − M δ²/2,    M the mean of r/w.

Squares that cannot hold anything lower than what a descent has found are dropped, the others cut into four.
"""

import numpy as np

from quatfilt._reference._arrays import Indices, Reals
from quatfilt._reference.geodesics.pga.descent import descent
from quatfilt._reference.geodesics.pga.objective import value
from quatfilt._reference.rotations.quaternion import log, norm

SUBSET = 512
"""Largest number of samples for the search; its results descend over all samples."""

SQUARES = 4
"""Along the edge of a face, at first."""

LEVELS = 12
"""Cuts at most: squares are then a hundredth of a degree wide, and one valley wide."""

MOST_SQUARES = 4096
"""Squares at once: where more are left, the floor is flat along a line, and any of its points will do."""

ENOUGH = 1e-7
"""Relative tolerance: a region is pruned unless it can improve the best value by more than this."""

BENT = 1.0
"""Slope that a sample's curvature may add within a square. Beyond, its distance is bounded by its slope alone."""

APART = np.radians(2.0)
"""Between directions that descend over all samples: nearer ones end in the same valley."""

ENTRIES = 4
"""Squares of the first cut whose middles descend on the subset."""

DESCENTS = 3
"""Directions that descend over all samples."""


def nearest_geodesic(x: Reals, objective: str) -> tuple[Reals, list[float]]:
    """Direction with the lowest objective, and the objectives of the descent that led to it; samples `(n, 4)`, not all 1."""
    subset = x[:: -(-len(x) // SUBSET)]
    starts = np.array([*suggested_directions(x), *valleys(subset, objective)])
    values = np.array([value(x, v, objective) for v in starts])
    found = [descent(x, v, objective) for v in lowest(starts, values, DESCENTS)]
    return min(found, key=lambda result: result[1][-1])


def lowest(directions: Reals, values: Reals, most: int) -> list[Reals]:
    """Return the directions with the lowest values, so many at most, each apart from the others."""
    chosen: list[Reals] = []
    for index in np.argsort(values, kind="stable"):
        if len(chosen) < most and all(abs(directions[index] @ v) < np.cos(APART) for v in chosen):
            chosen.append(directions[index])
    return chosen


def suggested_directions(x: Reals) -> Reals:
    """Directions that formulas suggest, `(7, 3)`.

    The principal axes of the vector parts `u` minimise the mean of `sin² d`; those of the logarithms are tangent PCA. The
    last is eq. (14).
    """
    return np.stack([*principal_axes(x[:, 1:]), *principal_axes(log(x)), paper_start(x)])


def paper_start(x: Reals) -> Reals:
    """Eq. (14), `Σ |u| u` with the signs of a half-space; exact for samples on one geodesic.

    The half-space is the one about the first principal axis: a fixed one misleads where it cuts through the samples, and
    would tie the result to the frame.
    """
    u = x[:, 1:]
    axis = principal_axes(u)[0]
    total = np.sum((norm(u) * np.copysign(1, u @ axis))[:, None] * u, axis=0)
    length = norm(total)
    start: Reals = total / length if length > 0 else axis
    return start


def principal_axes(vectors: Reals) -> Reals:
    """Eigenvectors of `Σ y yᵀ`, the greatest first, `(3, 3)`."""
    return np.ascontiguousarray(np.linalg.eigh(vectors.T @ vectors)[1].T[::-1])


def valleys(x: Reals, objective: str) -> list[Reals]:
    """Directions at the bottom of valleys, the lowest of all among them."""
    axes = principal_axes(x[:, 1:])
    suggested = suggested_directions(x)
    values = np.array([value(x, v, objective) for v in suggested])
    found = [descent(x, v, objective) for v in lowest(suggested, values, 1)]
    middles = (2 * np.arange(SQUARES) + 1) / SQUARES - 1
    faces = np.repeat(np.arange(3), SQUARES**2)
    first: Reals = np.tile(np.repeat(middles, SQUARES), 3)
    second: Reals = np.tile(middles, 3 * SQUARES)
    half = 1 / SQUARES
    for level in range(LEVELS):
        directions = square_middles(faces, first, second) @ axes
        values, bounds = lower_bounds(x, directions, np.sqrt(2) * half, objective)
        low = min(history[-1] for _, history in found)
        better = values < (low if level else np.inf)
        starts = lowest(directions[better], values[better], 1 if level else ENTRIES)
        found += [descent(x, v, objective) for v in starts]
        low = min(history[-1] for _, history in found)
        open_squares = np.flatnonzero(bounds < low * (1 - ENOUGH))
        if not 0 < 4 * len(open_squares) <= MOST_SQUARES:
            break
        half /= 2
        faces = np.repeat(faces[open_squares], 4)
        first = np.add.outer(first[open_squares], half * np.array([-1, -1, 1, 1])).ravel()
        second = np.add.outer(second[open_squares], half * np.array([-1, 1, -1, 1])).ravel()
    return [v for v, _ in found]


def square_middles(faces: Indices, first: Reals, second: Reals) -> Reals:
    """Return unit vectors to points of the faces `x = 1`, `y = 1` and `z = 1` of a cube, `(m, 3)`."""
    points = np.ones((len(faces), 3))
    rows = np.arange(len(faces))
    points[rows, (faces + 1) % 3] = first
    points[rows, (faces + 2) % 3] = second
    middles: Reals = points / norm(points)[:, None]
    return middles


def lower_bounds(x: Reals, directions: Reals, reach: float, objective: str) -> tuple[Reals, Reals]:
    """Objectives at directions, and their lower bounds within `reach` radians, `(m,)` each."""
    w, u = x[:, 0], x[:, 1:]
    r = norm(u)
    p = directions @ u.T
    f = np.hypot(w, p)
    d = np.arctan2(norm(np.cross(u, directions[:, None])), f)
    nearest = np.maximum(d - r * reach, 0)
    if objective == "squared":
        values, first, bend, least = d * d, 2 * d, 2 * np.arctan2(r, w) * r / w, nearest * nearest
    elif objective == "chordal":
        values, first, bend, least = 1 - f, np.sin(d), r * r / w, 2 * np.sin(nearest / 2) ** 2
    else:
        values, first, bend, least = d, np.ones_like(d), r / w, nearest
    rough = np.broadcast_to(bend * reach > BENT, d.shape)
    if objective == "geodesic":
        rough = rough | (np.abs(p) >= r * np.cos(reach))
    # The part of `u` across the direction has the length `sin d`.
    pull = np.where(rough, 0, first * p / (f * np.maximum(np.sin(d), np.finfo(np.float64).tiny)))
    gradient = (pull @ u - np.sum(pull * p, axis=1)[:, None] * directions) / len(x)
    smooth = np.where(rough, 0, bend)
    bounds = (
        np.mean(np.where(rough, least, values), axis=1)
        - norm(gradient) * reach
        - np.mean(smooth, axis=1) * reach**2 / 2
    )
    return np.mean(values, axis=1), bounds
