"""Descent to the direction of a geodesic that is nearer than all around it.

Newton's method on the sphere of directions. Each step is made to descend: curvatures count by their size, and a step that
does not lower the objective is halved. Where a sample lies on the geodesic its distance has a cone point; such a direction
is a minimum if the other samples pull less than those on it hold (Kuhn's test for the Weber point), and the descent
leaves it along the pull otherwise.
"""

import numpy as np

from quatfilt._reference._arrays import Reals
from quatfilt._reference.geodesics.pga.objective import basis, slope, value
from quatfilt._reference.rotations.quaternion import norm

STEPS = 100
"""Newton steps at most; a handful is enough unless samples lie very near the geodesic, but not on it."""

HALVINGS = 40
"""Largest number of halvings of a step: after them it is below the rounding error of a direction."""

SHORTEST = 1e-13
"""Radians: a step that ends the descent."""

LONGEST = 0.5
"""Radians: a longer step has left the neighbourhood that the curvature speaks of."""

LEAST_CURVATURE = 1e-8
"""Of the greater curvature: a smaller one says nothing."""

ROUNDINGS = 64 * np.finfo(np.float64).eps
"""Relative: a difference of objectives that roundings make."""

ONTO_SAMPLE = 4.0
"""Steps: how far the direction of a sample may lie to be tried itself."""


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
            moved = onto_sample(x, v, here.nearest, here.value, ONTO_SAMPLE * length)
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
    # Away from a cone point only the steepest way is sure to lead downhill.
    along = gradient[:, None] / steepness if cone > 0 else np.linalg.eigh(hessian)[1]
    curvatures = np.abs(np.einsum("ak,ab,bk->k", along, hessian, along))
    sizes = np.maximum(curvatures, LEAST_CURVATURE * curvatures.max() + np.finfo(np.float64).tiny)
    step: Reals = -along @ ((along.T @ gradient) / sizes) * (1 - cone / steepness)
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
