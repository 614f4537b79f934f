"""Descent on the sphere of directions: limited-memory BFGS along great circles (Huang, Gallivan and Absil 2015)."""

import numpy as np

from quatfilt._reference._arrays import Reals
from quatfilt._reference.geodesics.body.distance import logarithms
from quatfilt._reference.geodesics.body.objective import Slope, slope
from quatfilt._reference.rotations.quaternion import norm

STEPS = 200
"""Steps at most; whole bodies take 20 to 60 from the tangent axis."""

MEMORY = 20
"""Pairs of steps and changes of gradient that stand for the curvature."""

HALVINGS = 30
"""Shortenings of a step at most."""

SHORTEST = 1e-12
"""Radians on the sphere of directions: a step that ends the descent."""

LONGEST = 0.5
"""Radians: a longer step has left the neighbourhood that the curvature speaks of."""

FIRST_STEP = 0.05
"""Radians: the first step, before any curvature is known."""

DECREASE = 1e-4
"""Share of the decrease that the slope promises, from which a step is taken (Armijo)."""

ROUNDINGS = 16 * np.finfo(np.float64).eps
"""Relative: a difference of objectives that roundings make; such a step is taken if it halves the gradient."""


def descent(x: Reals, start: Reals, objective: str, steps: int = STEPS) -> tuple[Reals, Slope, list[float]]:
    """Descend from a direction to a minimum near it; the objective never rises.

    Where the mean distance has its minimum at a cone point, the direction of a pose, the descent ends near it, and steps
    onto it in the end if that is lower.

    Returns the direction, the objective there, and the objectives of the descent.
    """
    v, here, values = descent_off_poses(x, start, objective, steps)
    if objective != "geodesic":
        return v, here, values
    nearest = nearest_pose(here)
    if nearest is not None:
        pose = logarithms(x[nearest])
        pose = pose / norm(pose.ravel())
        there = slope(x, pose, objective)
        if there.value < here.value:
            v, here = pose, there
            values.append(there.value)
    return v, here, values


def descent_off_poses(x: Reals, start: Reals, objective: str, steps: int) -> tuple[Reals, Slope, list[float]]:
    """Descend as if the objective were smooth."""
    v = start
    here = slope(x, v, objective)
    values = [here.value]
    pairs: list[tuple[Reals, Reals]] = []
    for _ in range(steps):
        step = newton_like(here.gradient, pairs, v)
        if np.sum(step * here.gradient) >= 0:
            pairs = []
            step = newton_like(here.gradient, pairs, v)
        step *= min(1.0, LONGEST / max(float(norm(step.ravel())), LONGEST))
        promised = float(np.sum(step * here.gradient))
        moved = None
        share = 1.0
        for _ in range(HALVINGS):
            if float(norm(step.ravel())) * share < SHORTEST:
                break
            trial = turned(v, share * step)
            there = slope(x, trial, objective, here.s)
            if there.value <= here.value + DECREASE * share * promised or (
                there.value <= here.value * (1 + ROUNDINGS)
                and norm(there.gradient.ravel()) < norm(here.gradient.ravel()) / 2
            ):
                moved = trial, there
                break
            # The minimum of the parabola through both values and the slope, but no further than it can be trusted.
            excess = 2 * (there.value - here.value - share * promised)
            parabola = -promised * share * share / excess if excess > 0 else share / 2
            share = min(max(parabola, share / 10), share / 2)
        if moved is None:
            break
        trial, there = moved
        taken = across(share * step, trial)
        changed = there.gradient - across(here.gradient, trial)
        pairs = [(across(s, trial), across(y, trial)) for s, y in pairs]
        if np.sum(taken * changed) > 0:
            pairs = [*pairs[-(MEMORY - 1) :], (taken, changed)]
        v, here = trial, there
        values.append(min(here.value, values[-1]))
    return v, here, values


def newton_like(gradient: Reals, pairs: list[tuple[Reals, Reals]], v: Reals) -> Reals:
    """Step of Newton's with the curvature that the pairs know (Nocedal's two loops)."""
    step = -gradient
    shares: list[float] = []
    for s, y in reversed(pairs):
        share = float(np.sum(s * step) / np.sum(s * y))
        shares.append(share)
        step = step - share * y
    if pairs:
        s, y = pairs[-1]
        step = step * (np.sum(s * y) / np.sum(y * y))
    else:
        length = float(norm(gradient.ravel()))
        step = step * (FIRST_STEP / length if length > 0 else 0)
    for (s, y), share in zip(pairs, reversed(shares), strict=True):
        step = step + s * (share - np.sum(y * step) / np.sum(s * y))
    return across(step, v)


def nearest_pose(here: Slope) -> int | None:
    """Pose whose direction is nearest to that of the geodesic, seen from 1; None if all poses are 1."""
    far = np.abs(here.s)
    angles = np.where(far > 0, here.distances / np.where(far > 0, far, 1), np.inf)
    nearest = int(np.argmin(angles))
    return nearest if np.isfinite(angles[nearest]) else None


def across(step: Reals, v: Reals) -> Reals:
    """Part of a vector across the unit vector `v`."""
    return step - np.sum(step * v) * v


def turned(v: Reals, step: Reals) -> Reals:
    """Move the unit vector `v` along the sphere by a vector across it."""
    angle = norm(step.ravel())
    moved = np.cos(angle) * v + np.sinc(angle / np.pi) * step
    unit: Reals = moved / norm(moved.ravel())
    return unit
