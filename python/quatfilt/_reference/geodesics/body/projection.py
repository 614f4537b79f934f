"""The nearest point of a geodesic to a pose, exactly.

`g(s) = Σ_j h_j(n_j s)` is a sum over the joints, each convex up to a kink, where that joint stands half a turn from its
sample. With `w ≥ 0` and `|n_j s| ≤ π/2` a joint has one kink at most, at `θ = θ* ∓ π/2`, where `θ* = atan2(p, w)`.
Between two kinks `g` is convex, and Newton's method finds the minimum there. Nearly always the piece about `s = 0` has the
lowest one: beyond its kink a joint cannot come nearer than `arccos |p|`.
"""

import numpy as np

from quatfilt._reference._arrays import Reals
from quatfilt._reference.geodesics.body.distance import Parts, seen

STEPS = 60
"""Newton steps at most; three to five are enough, and each one at least moves an end of the bracket."""

SHORTEST = 4 * np.finfo(np.float64).eps
"""Relative to the bracket's greatest parameter: steps that are shorter are roundings."""

LOWER = 1e-12
"""Relative: a piece that is not lower than the one about 0 by more is as good, and does not count."""


def furthest(v: Parts) -> float:
    """Largest parameter: the fastest joint has rotated by 180°, `π/2` on S³, and would rotate back beyond it."""
    return float(np.pi / 2 / v.lengths.max(initial=np.finfo(np.float64).tiny))


def nearest_point(x: Reals, v: Parts, objective: str, guess: Reals | None = None) -> Reals:
    """Parameters `s` of the points `c_v(s)` that are nearest to poses, `(poses, joints, 4)` → `(poses,)`.

    Nearest in `Σ d²`, or in `Σ 2 (1 − cos d)` for the chordal objective. The samples have `w ≥ 0`.
    """
    end = furthest(v)
    w, p = x[..., 0], np.einsum("njc,jc->nj", x[..., 1:], v.axes)
    theta = np.arctan2(p, w)
    kinks = (theta - np.copysign(np.pi / 2, theta)) / np.where(v.lengths > 0, v.lengths, np.finfo(float).tiny)
    has_kink = (np.abs(kinks) < end) & ((w != 0) | (p != 0))
    low = np.max(np.where(has_kink & (kinks < 0), kinks, -end), axis=1, initial=-end)
    high = np.min(np.where(has_kink & (kinks >= 0), kinks, end), axis=1, initial=end)
    if guess is None:
        guess = np.einsum("nj,j->n", theta, v.lengths)
    s, squares = lowest(x, v, low, high, guess, np.ones_like(w), objective)
    reach = np.max(np.abs(p) * has_kink, axis=1, initial=0)
    floor = 2 * (1 - reach) if objective == "chordal" else np.arccos(np.minimum(reach, 1)) ** 2
    for i in np.flatnonzero((squares > floor) & has_kink.any(axis=1)):
        borders = np.concatenate([[-end], np.sort(kinks[i, has_kink[i]]), [end]])
        middles = (borders[:-1] + borders[1:]) / 2
        one = np.broadcast_to(x[i], (len(middles), *x[i].shape))
        angles = middles[:, None] * v.lengths
        signs = np.copysign(1, w[i] * np.cos(angles) + p[i] * np.sin(angles))
        others, there = lowest(one, v, borders[:-1], borders[1:], middles, signs, objective)
        best = int(np.argmin(there))
        if there[best] < squares[i] * (1 - LOWER):
            s[i] = others[best]
    return s


def lowest(
    x: Reals, v: Parts, low: Reals, high: Reals, guess: Reals, signs: Reals, objective: str
) -> tuple[Reals, Reals]:
    """Parameters of the minima in `[low, high]`, between which `g` is convex, and the sums there, `(poses,)` each.

    A step of Newton's that would leave the bracket goes to its end, or to the middle if that end has been tried.
    """
    low, high = low.copy(), high.copy()
    tried_low, tried_high = np.zeros(len(x), dtype=np.bool_), np.zeros(len(x), dtype=np.bool_)
    shortest = SHORTEST * np.maximum(np.abs(low), np.abs(high))
    s = np.clip(guess, low, high)
    for _ in range(STEPS):
        view = seen(x, v, s, objective, signs)
        slope = -np.einsum("nj,nj,j->n", view.factors, view.along, v.lengths)
        bend = np.einsum("nj,j->n", view.bends, v.lengths**2)
        low, tried_low = np.where(slope <= 0, s, low), tried_low | (slope <= 0)
        high, tried_high = np.where(slope >= 0, s, high), tried_high | (slope >= 0)
        with np.errstate(divide="ignore", invalid="ignore"):
            step = np.where(slope == 0, 0, -slope / bend)
        middle = (low + high) / 2
        following = np.where(
            s + step < low,
            np.where(tried_low, middle, low),
            np.where(s + step > high, np.where(tried_high, middle, high), s + step),
        )
        moved = np.abs(following - s)
        s = following
        if np.all(moved <= shortest):
            break
    return s, seen(x, v, s, objective, signs).squares.sum(axis=1)
