"""The direction of the nearest geodesic, sought on the whole sphere of directions.

Newton's method on the sphere descends from several starts. Each step is made to descend: curvatures count by their size,
and a step that does not lower the objective is halved. Where a sample lies on the geodesic its distance has a cone point;
such a direction is a minimum if the other samples pull less than those on it hold (Kuhn's test for the Weber point), and
the descent leaves it along the pull otherwise.
"""

import numpy as np

from quatfilt._reference._arrays import Reals
from quatfilt._reference.geodesics.pga.objective import basis, slope, value
from quatfilt._reference.rotations.quaternion import log, norm

STEPS = 100
"""Newton steps at most; a handful is enough unless samples lie very near the geodesic, but not on it."""

HALVINGS = 40
"""Shortenings of a step at most: what is left is below the roundings of a direction."""

SHORTEST = 1e-13
"""Radians: a step that ends the descent."""

LONGEST = 0.5
"""Radians: a longer step has left the neighbourhood that the curvature speaks of."""

LEAST_CURVATURE = 1e-8
"""Of the greater curvature: a smaller one says nothing."""

ROUNDINGS = 64 * np.finfo(np.float64).eps
"""Relative: a difference of objectives that roundings make."""

SUBSET = 512
"""Samples, at most, on which the starts are tried: enough to tell valleys apart."""

GRID = 8
"""Steps from the middle of a face to the edge of the cube whose grid is tried: seven degrees, and fewer at the corners."""

APART = (np.radians(10.0), np.radians(2.0))
"""Radians between starts: the first for other valleys, the second for dents in the floor of the deepest one."""

STARTS = 12
"""Starts that descend on the subset, for each angle apart."""

DESCENTS = 4
"""The best starts from the subset that descend over all samples."""


def nearest_geodesic(x: Reals, objective: str) -> tuple[Reals, list[float]]:
    """Direction with the lowest objective, and the objectives of the descent that led to it.

    Starts are those that some formula suggests, a grid on the sphere in the frame of the samples' principal axes, and the
    directions of the samples themselves. They are compared on a subset of the samples, the most promising descend there,
    and the best of what comes out descend over all samples.
    """
    suggested = suggested_starts(x)
    subset = x[:: -(-len(x) // SUBSET)]
    tried = [*suggested, *grid(principal_axes(subset)), *sample_directions(subset, objective)]
    valleys = [descent(subset, v, objective)[0] for v in promising(subset, np.array(tried), objective)]
    starts = np.concatenate([valleys, suggested])
    order = np.argsort([value(x, v, objective) for v in starts], kind="stable")
    found = [descent(x, v, objective) for v in starts[order[:DESCENTS]]]
    return min(found, key=lambda result: result[1][-1])


def suggested_starts(x: Reals) -> Reals:
    """Directions that formulas suggest, `(7, 3)`.

    The principal axes of the vector parts `u` minimise the mean of `sin² d`; those of the logarithms are tangent PCA. The
    last is eq. (14), `Σ |u| u`, where the sign of each axis is that of its half-space; here the half-space about the
    first principal axis, for a fixed one misleads where it cuts through the samples.
    """
    u = x[:, 1:]
    axes = principal_axes(x)
    folded = u * np.copysign(1, u @ axes[0])[:, None]
    chordal = np.sum(norm(u)[:, None] * folded, axis=0)
    length = norm(chordal)
    return np.stack([*axes, *axes_of(log(x)), chordal / length if length > 0 else axes[0]])


def principal_axes(x: Reals) -> Reals:
    """Eigenvectors of `Σ u uᵀ`, the greatest first, `(3, 3)`."""
    return axes_of(x[:, 1:])


def axes_of(vectors: Reals) -> Reals:
    """Eigenvectors of `Σ y yᵀ`, the greatest first, `(3, 3)`."""
    return np.ascontiguousarray(np.linalg.eigh(vectors.T @ vectors)[1].T[::-1])


def grid(axes: Reals) -> Reals:
    """Directions of a half of the grid on a cube along `axes`, which the signs of the axes do not change."""
    steps = np.arange(-GRID, GRID + 1)
    points = np.stack(np.meshgrid(steps, steps, steps, indexing="ij"), axis=-1).reshape(-1, 3)
    surface = points[np.abs(points).max(axis=-1) == GRID]
    half = surface[len(surface) // 2 :]
    directions: Reals = half / norm(half)[:, None] @ axes
    return directions


def sample_directions(x: Reals, objective: str) -> Reals:
    """Directions of the samples, where the mean distance has cone points; the other objectives have none."""
    u = x[:, 1:]
    length = norm(u)
    there = (length > 0) & (objective == "geodesic")
    return u[there] / length[there, None]


def promising(x: Reals, directions: Reals, objective: str) -> list[Reals]:
    """Return the best of directions that lie apart, for each of the angles apart."""
    values = np.array([value(x, v, objective) for v in directions])
    order = np.argsort(values, kind="stable")
    chosen: list[Reals] = []
    for apart in APART:
        group: list[Reals] = []
        for index in order:
            if len(group) < STARTS and all(abs(directions[index] @ other) < np.cos(apart) for other in group):
                group.append(directions[index])
        chosen += group
    return chosen


def descent(x: Reals, start: Reals, objective: str) -> tuple[Reals, list[float]]:
    """Descend from a direction to a minimum near it; the objective never rises."""
    v = start
    across = basis(v)
    here = slope(x, v, across, objective)
    values = [here.value]
    for _ in range(STEPS):
        step = newton_step(here.gradient, here.hessian, here.cone)
        length = float(norm(step))
        if length < SHORTEST:
            break
        moved = None
        if objective == "geodesic" and here.nearest >= 0:
            moved = onto_sample(x, v, here.nearest, here.value, 4 * length)
        for _ in range(HALVINGS):
            if moved is not None:
                break
            trial = turned(v, step @ across)
            there = slope(x, trial, basis(trial), objective)
            lower = there.value < here.value
            level = there.value <= here.value * (1 + ROUNDINGS)
            if lower or (level and norm(there.gradient) < norm(here.gradient) / 2):
                moved = trial
            step = step / 2
        if moved is None:
            break
        v = moved
        across = basis(v)
        here = slope(x, v, across, objective)
        values.append(min(here.value, values[-1]))
    return v, values


def newton_step(gradient: Reals, hessian: Reals, cone: float) -> Reals:
    """Step that descends, `(2,)`; 0 at a minimum, which a cone point is if the gradient of the others is no steeper."""
    steepness = float(norm(gradient))
    if steepness <= cone:
        return np.zeros(2)
    curvatures, directions = np.linalg.eigh(hessian)
    sizes = np.maximum(np.abs(curvatures), LEAST_CURVATURE * np.abs(curvatures).max() + np.finfo(float).tiny)
    step: Reals = -directions @ ((directions.T @ gradient) / sizes) * (1 - cone / steepness)
    return step * min(1.0, LONGEST / float(norm(step)))


def onto_sample(x: Reals, v: Reals, nearest: int, before: float, reach: float) -> Reals | None:
    """Direction of the nearest sample, if it lies within `reach` radians and is better."""
    u = x[nearest, 1:]
    direction = u / norm(u)
    away = float(norm(np.cross(direction, v)))
    if 0 < away < reach and value(x, direction, "geodesic") < before:
        return direction
    return None


def turned(v: Reals, step: Reals) -> Reals:
    """Move the unit vector `v` along the sphere by a vector across it."""
    angle = norm(step)
    moved = np.cos(angle) * v + np.sinc(angle / np.pi) * step
    unit: Reals = moved / norm(moved)
    return unit
