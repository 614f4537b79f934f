"""The objective of the direction of a geodesic of poses, and its gradient."""

from typing import NamedTuple

import numpy as np

from quatfilt._reference._arrays import Reals
from quatfilt._reference.geodesics.body.distance import parts, seen
from quatfilt._reference.geodesics.body.projection import furthest, nearest_point

ON_GEODESIC = 1e-14
"""Distance on S³: poses that are nearer lie on the geodesic; in which direction from it is lost in roundings."""


class Slope(NamedTuple):
    """An objective at a direction."""

    value: float
    gradient: Reals
    """`(joints, 3)`, across the direction."""
    s: Reals
    """Parameters of the nearest points, `(poses,)`."""
    distances: Reals
    """From the poses to them, `(poses,)`."""


def slope(x: Reals, v: Reals, objective: str, guess: Reals | None = None) -> Slope:
    """Objective at the unit vector `v` with its gradient on the sphere of directions, for poses `(poses, joints, 4)`.

    Since each `s` is the nearest there is, its own change counts nothing, and the gradient is the one at fixed `s`: with
    `z = s v_j` it is `dh/dz = −2 φ sign a · (b e_j + sinc θ (u − p e_j))`. Poses whose `s` is held by its limit
    `π / (2 max n_j)` move with that limit.
    """
    part = parts(v)
    end = furthest(part)
    s = nearest_point(x, part, objective, guess)
    view = seen(x, part, s, objective)
    squares = view.squares.sum(axis=1)
    distances = np.sqrt(squares)
    weights = outer_weights(distances, objective)
    u = x[..., 1:]
    p = np.einsum("njc,jc->nj", u, part.axes)
    across = u - p[..., None] * part.axes
    sinc = np.sinc(s[:, None] * part.lengths / np.pi)
    factors = (-2 * weights * s)[:, None] * view.factors
    gradient = np.einsum("nj,nj->j", factors, view.along)[:, None] * part.axes
    gradient += np.einsum("nj,nj,njc->jc", factors, sinc, across)
    held = np.abs(s) == end
    rates = -2 * np.einsum("nj,nj,j->n", view.factors, view.along, part.lengths)
    fastest = int(np.argmax(part.lengths))
    limit = np.sum(np.where(held, weights * rates * s, 0)) / part.lengths[fastest]
    gradient[fastest] -= limit * part.axes[fastest]
    gradient -= np.sum(gradient * v) * v
    return Slope(value(distances, objective), gradient, s, distances)


def value(distances: Reals, objective: str) -> float:
    """Mean of the distances, of their squares, or of the sums of `1 − cos d`, half the squared chords."""
    if objective == "geodesic":
        return float(np.mean(distances))
    return float(np.mean(distances**2)) / (2 if objective == "chordal" else 1)


def outer_weights(distances: Reals, objective: str) -> Reals:
    """Derive the objective by the squared distance of each pose; 0 where a pose lies on the geodesic."""
    if objective == "geodesic":
        off = distances > ON_GEODESIC
        return np.where(off, 0.5 / np.where(off, distances, 1), 0) / len(distances)
    return np.full_like(distances, (0.5 if objective == "chordal" else 1) / len(distances))
