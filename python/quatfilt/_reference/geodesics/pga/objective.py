"""How far samples lie from a geodesic through 1, as a function of its direction.

The geodesic through 1 with the unit direction `v` is `c_v(s) = (cos s, sin s · v)`. With `p = v·u` a sample `x = (w, u)`
of S³ lies at the distance `d` from it, where

    cos d = f = √(w² + p²),    sin d = |u × v|.

Where `v` moves away from `u/|u|`, by an angle on the sphere of directions, `d` grows with the slope `p/f` and bends by
`−w² sin d / f³`: it has a cone point at `u/|u|` and is concave all along the way. Across the way it bends by `p²/(f sin d)`.
"""

from typing import NamedTuple

import numpy as np

from quatfilt._reference._arrays import Reals
from quatfilt._reference.rotations.quaternion import norm

ON_GEODESIC = 1e-14
"""Sine of a distance: samples that are nearer lie on the geodesic, and in which direction from it is lost in roundings."""


class Slope(NamedTuple):
    """An objective at a direction, and how it changes there."""

    value: float
    gradient: Reals
    """`(2,)`, along the basis; of the samples that do not lie on the geodesic."""
    hessian: Reals
    """`(2, 2)`, of the same samples."""
    cone: float
    """Slope with which the objective grows on all sides for the samples that lie on the geodesic."""
    nearest: int
    """The sample whose direction is nearest, -1 without one."""


def distances(x: Reals, v: Reals) -> Reals:
    """Distances on S³ from the samples `(n, 4)` to the geodesic with the direction `v`, in `[0, π/2]`."""
    w, u = x[:, 0], x[:, 1:]
    return np.arctan2(norm(np.cross(u, v)), np.hypot(w, u @ v))


def value(x: Reals, v: Reals, objective: str) -> float:
    """Mean over the samples of the distance, of its square, or of `1 − cos` of it: the objective of the direction."""
    d = distances(x, v)
    if objective == "squared":
        return float(np.mean(d * d))
    if objective == "chordal":
        return float(np.mean(2 * np.sin(d / 2) ** 2))
    return float(np.mean(d))


def basis(v: Reals) -> Reals:
    """Two unit vectors across the unit vector `v` and each other, `(2, 3)`."""
    axis = np.eye(3)[np.argmin(np.abs(v))]
    first = np.cross(v, axis)
    first /= norm(first)
    return np.stack([first, np.cross(v, first)])


def slope(x: Reals, v: Reals, across: Reals, objective: str) -> Slope:
    """Objective at `v`, with its gradient and Hessian on the sphere of directions along the basis `across`."""
    w, u = x[:, 0], x[:, 1:]
    p, f, sine = u @ v, np.hypot(w, u @ v), norm(np.cross(u, v))
    d = np.arctan2(sine, f)
    off = sine > ON_GEODESIC
    safe = np.where(off, sine, 1)
    # `G` is the objective as a function of `d`: its derivative, the derivative over the sine, and the second derivative.
    if objective == "squared":
        first, first_over_sine, second = 2 * d, np.where(off, 2 * d / safe, 2), np.full_like(d, 2)
    elif objective == "chordal":
        first, first_over_sine, second = sine, np.ones_like(d), f
    else:
        first, first_over_sine, second = np.where(off, 1, 0), np.where(off, 1 / safe, 0), np.zeros_like(d)
    toward = (u @ across.T) / safe[:, None] * off[:, None]
    along = second * (p / f) ** 2 - first * sine * w**2 / f**3
    over = first_over_sine * p**2 / f
    gradient = -np.mean((first * p / f)[:, None] * toward, axis=0)
    hessian = np.mean(over) * np.eye(2) + np.einsum("n,na,nb->ab", along - over, toward, toward) / len(x)
    cone = float(np.sum((np.abs(p) / f)[~off])) / len(x) if objective == "geodesic" else 0.0
    length = norm(u)
    away = np.where(length > ON_GEODESIC, sine / np.where(length > ON_GEODESIC, length, 1), np.inf)
    nearest = int(np.argmin(away)) if np.isfinite(away).any() else -1
    return Slope(value(x, v, objective), gradient, hessian, cone, nearest)
