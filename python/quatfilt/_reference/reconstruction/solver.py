"""The most probable pose: control points against what the local model expects."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from quatfilt._reference._arrays import Mask
from quatfilt._reference.reconstruction.kinematics import (
    Base,
    Body,
    Floats,
    control_points,
    matrix,
    pose,
    right_jacobian,
)
from quatfilt._reference.rotations.quaternion import between, log_short

FIRST_DAMPING = 0.1
"""Share of the prior that is added where a plain Gauss-Newton step does not lower the energy."""

DAMPING_FACTOR = 8.0
"""How much stronger the damping becomes after a step that failed, and weaker after one that did not."""

WEAKEST_DAMPING = 1e-3
"""Below it steps are Gauss and Newton's."""

STRONGEST_DAMPING = 1e9
"""Where not even steps of a billionth lower the energy, rounding decides."""

SETTLED = 1e-9
"""Relative fall of the energy after which what is left to gain, a fraction of it, moves no joint by anything that shows. A fall
near the roundings of the energy would be decided by these."""


class Prior(NamedTuple):
    """What is expected of the coordinates of a pose: a Gaussian with the covariance `diag(deviation²) + axes·axesᵀ`.

    Parameters
    ----------
    mean, deviation : array (coordinates,)
        Expected value, and standard deviation beside the axes, above 0.
    axes : array (coordinates, n)
        Directions in which poses spread moreover, each as long as one standard deviation; n may be 0.
    """

    mean: Floats
    deviation: Floats
    axes: Floats

    def spread(self, rows: Floats) -> Floats:
        """Multiply the covariance by `rowsᵀ`; `(rows, coordinates)` → `(coordinates, rows)`."""
        result: Floats = (self.deviation**2)[:, None] * rows.T + self.axes @ (self.axes.T @ rows.T)
        return result

    def force(self, difference: Floats) -> Floats:
        """Multiply the inverse of the covariance by a difference from the mean, by Woodbury's identity."""
        plain = difference / self.deviation**2
        if self.axes.shape[1] == 0:
            return plain
        scaled = self.axes / (self.deviation**2)[:, None]
        inner = np.eye(self.axes.shape[1]) + self.axes.T @ scaled
        result: Floats = plain - scaled @ np.linalg.solve(inner, self.axes.T @ plain)
        return result


class Targets(NamedTuple):
    """Where control points are seen.

    Parameters
    ----------
    positions : array (points, 3)
        Their places.
    position_deviations : array (points,)
        Standard deviation of each coordinate; infinite where a point is not seen.
    orientations : array (points, 4)
        Their global rotations.
    orientation_deviations : array (points,)
        Standard deviation of each component of the rotation vector, radians; infinite where it is not seen.
    """

    positions: Floats
    position_deviations: Floats
    orientations: Floats
    orientation_deviations: Floats


class Solution(NamedTuple):
    """The most probable pose.

    Parameters
    ----------
    x : array (coordinates,)
        Its coordinates.
    likelihood, prior : float
        The two parts of its energy: half the squared errors of what is seen, and half the squared distance from what was
        expected, both in standard deviations.
    steps : int
        How many steps lowered the energy.
    """

    x: Floats
    likelihood: float
    prior: float
    steps: int


def solve(body: Body, base: Base, prior: Prior, targets: Targets, start: Floats, most: int) -> Solution:
    """Minimise the energy `‖r(x)‖²/2 + (x − μ)ᵀ C⁻¹ (x − μ)/2` by Levenberg and Marquardt's method.

    `r` are the errors of the control points in standard deviations. There are few of them and many coordinates, so each
    step is solved in the space of the errors: with their Jacobian `A`, the step that Gauss and Newton take is to

        x' = μ + C Aᵀ y,    (A C Aᵀ + 1) y = A (x − μ) − r.

    Damping by `λ` adds `λ (x' − x)ᵀ C⁻¹ (x' − x)/2`, which is a prior of the mean `(μ + λx)/(1 + λ)` and the covariance
    `C/(1 + λ)`. A step that does not lower the energy is not taken.

    Parameters
    ----------
    body, base, prior, targets
        The skeleton, the origin of the coordinates, and the two sides of the energy.
    start : array (coordinates,)
        Where to start.
    most : int
        The most steps that are tried.
    """
    x = start
    force = prior.force(x - prior.mean)
    error, rows = errors(body, base, targets, x)
    energy = (error @ error + (x - prior.mean) @ force) / 2
    damping, steps = 0.0, 0
    for _ in range(most):
        kept = damping / (1 + damping)
        mean = prior.mean + kept * (x - prior.mean)
        spread = prior.spread(rows) / (1 + damping)
        dual = np.linalg.solve(rows @ spread + np.eye(len(error)), rows @ (x - mean) - error)
        trial = mean + spread @ dual
        trial_force = kept * force + rows.T @ dual / (1 + damping)
        trial_error, trial_rows = errors(body, base, targets, trial)
        trial_energy = (trial_error @ trial_error + (trial - prior.mean) @ trial_force) / 2
        if trial_energy < energy:
            settled = energy - trial_energy <= SETTLED * energy
            x, force, error, rows, energy = trial, trial_force, trial_error, trial_rows, trial_energy
            damping = damping / DAMPING_FACTOR if damping > WEAKEST_DAMPING else 0.0
            steps += 1
            if settled:
                break
        else:
            damping = max(FIRST_DAMPING, damping * DAMPING_FACTOR)
            if damping > STRONGEST_DAMPING:
                break
    return Solution(x, float(error @ error / 2), float((x - prior.mean) @ force / 2), steps)


def energy(body: Body, base: Base, prior: Prior, targets: Targets, x: Floats) -> float:
    """Return the energy of coordinates."""
    error, _ = errors(body, base, targets, x)
    difference = x - prior.mean
    return float(error @ error + difference @ prior.force(difference)) / 2


def errors(body: Body, base: Base, targets: Targets, x: Floats) -> tuple[Floats, Floats]:
    """Errors of all that is seen of the control points, in standard deviations, and their Jacobian.

    The error of an orientation is the rotation vector `v = 2 log(o⁻¹ g)` from where it is seen to where it is; it changes
    by `J(v)⁻¹ g⁻¹ ω`.
    """
    points = control_points(body, base, x)
    values, rows = [], []
    for i in seen(targets.position_deviations):
        values.append((points.positions[i] - targets.positions[i]) / targets.position_deviations[i])
        rows.append(points.position_rows[i] / targets.position_deviations[i])
    for i in seen(targets.orientation_deviations):
        vector = 2 * log_short(between(targets.orientations[i], points.orientations[i]))
        turns = np.linalg.solve(
            right_jacobian(vector), matrix(points.orientations[i]).T @ points.orientation_rows[i]
        )
        values.append(vector / targets.orientation_deviations[i])
        rows.append(turns / targets.orientation_deviations[i])
    if not values:
        return np.zeros(0), np.zeros((0, len(x)))
    return np.concatenate(values), np.concatenate(rows)


def seen(deviations: Floats) -> NDArray[np.intp]:
    """Which points are seen."""
    finite: Mask = np.isfinite(deviations)
    return np.flatnonzero(finite)


def solve_pose(
    parents: NDArray[np.int64],
    offsets: Floats,
    points: NDArray[np.int64],
    up: int,
    centres: Floats,
    place: Floats,
    heading: float,
    mean: Floats,
    deviation: Floats,
    axes: Floats,
    positions: Floats,
    position_deviations: Floats,
    orientations: Floats,
    orientation_deviations: Floats,
    start: Floats,
    most: int,
) -> tuple[Floats, Floats, Floats, float, float, int]:
    """Find the most probable pose: `solve`, its arguments in a row.

    Returns
    -------
    x : array (coordinates,)
        Its coordinates.
    rotations : array (joints, 4)
        Rotation of each joint in its parent, the root's with its heading.
    translation : array (3,)
        Position of the root.
    likelihood, prior : float
        The parts of its energy.
    steps : int
        How many steps lowered the energy.
    """
    body, base = Body(parents, offsets, points, up), Base(centres, place, heading)
    targets = Targets(positions, position_deviations, orientations, orientation_deviations)
    found = solve(body, base, Prior(mean, deviation, axes), targets, start, most)
    rotations, translation = pose(base, found.x, up)
    return found.x, rotations, translation, found.likelihood, found.prior, found.steps
