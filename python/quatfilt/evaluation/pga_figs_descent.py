"""The gradient descent of the paper, from a random start: its Figures 1 and 2.

Eq. (13) is the gradient of the mean of ``1 − cos d``. That of the mean distance, eq. (9), has the factor ``1/sin d`` in
addition. Both are tried here with the paper's update, eq. (12).
"""

import numpy as np

from quatfilt._typing import Array
from quatfilt.evaluation.channels import Values
from quatfilt.rotations.quaternion import conjugate, exp, multiply

STEPS = 30

STEP = 1.0
"""The paper's λ, which it does not state, in units of the inverse mean of sin² of the samples' angles."""

_HALVINGS = 40

_FLOOR = 1e-12
"""Below it ``sin d`` says nothing about a direction."""


def distances(q: Array, v: Values) -> Values:
    """Distances on S³ from samples to the geodesic of a direction, radians."""
    w, u = _parts(q)
    along = u @ v
    across = np.linalg.norm(u - along[:, None] * v, axis=1)
    return np.asarray(np.arctan2(across, np.hypot(w, along)), np.float64)


def start(q: Array) -> Values:
    """Return eq. (14) with each sample's axis in the half space of the widest spread instead of the paper's `k`."""
    w, u = _parts(q)
    spread = np.linalg.eigh(u.T @ u)[1][:, -1]
    angle = np.arctan2(np.linalg.norm(u, axis=1), w)
    total = (np.sin(angle) * np.sign(u @ spread)) @ u
    return np.asarray(total / np.linalg.norm(total), np.float64)


def residual(q: Array, v: Values) -> Array:
    """Return what the geodesic of a direction leaves of the samples, eq. (15)."""
    w, u = _parts(q)
    s = np.arctan2(u @ v, w)
    return multiply(conjugate(exp(s[:, None] * v)), q)


def descend(q: Array, v: Values, *, printed: bool) -> tuple[Values, Values]:
    """Follow eq. (12) from a direction.

    Parameters
    ----------
    q : array (samples, 4)
        Centred at the identity.
    v : array (3,)
        Where it starts.
    printed : bool
        With the printed gradient, eq. (13), and steps as they come; or with that of eq. (9), and steps that are halved until
        the mean distance falls.

    Returns
    -------
    array (3,)
        Where it ends.
    array (steps + 1,)
        The mean distance, eq. (9), on the way.
    """
    w, u = _parts(q)
    rate = STEP / float(np.mean(np.sum(u**2, axis=1)))
    values = [float(distances(q, v).mean())]
    for _ in range(STEPS):
        along = u @ v
        near = np.hypot(w, along)
        weights = along / near
        if not printed:
            weights /= np.maximum(np.sin(distances(q, v)), _FLOOR)
        gradient = -(weights @ u) / len(u)
        gradient -= (gradient @ v) * v
        v, value = _updated(q, v, rate * gradient, values[-1], halving=not printed)
        values.append(value)
    return v, np.array(values)


def _updated(q: Array, v: Values, step: Values, before: float, *, halving: bool) -> tuple[Values, float]:
    """Take a step; where the mean distance has a kink, one that is too long has to be halved."""
    for _ in range(_HALVINGS):
        moved = np.asarray((v - step) / np.linalg.norm(v - step), np.float64)
        value = float(distances(q, moved).mean())
        if not halving or value < before:
            return moved, value
        step = step / 2
    return v, before


def _parts(q: Array) -> tuple[Values, Values]:
    folded = np.where(q[:, :1] < 0, -q, q).astype(np.float64)
    return folded[:, 0], folded[:, 1:]


__all__ = ["STEPS", "descend", "distances", "residual", "start"]
