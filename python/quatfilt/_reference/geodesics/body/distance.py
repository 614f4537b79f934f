"""How far poses lie from points of a geodesic of the product of all joints.

The geodesic through 1 with the unit direction `v` of `R^{3J}` is `c_v(s) = (exp(s v_1), …, exp(s v_J))`. A joint whose
part `v_j = n_j e_j` has the length `n_j` turns by `θ = n_j s` about `e_j`. Seen from there, its sample `x = (w, u)` is

    exp(−s v_j) x = (a, …),    a = w cos θ + p sin θ,    p = e_j·u,

with the part `b = p cos θ − w sin θ` along `e_j` and the rest `r = |u − p e_j|` across it. Its distance, of rotations, is
`d = atan2(√(b² + r²), |a|)`. With `φ = d / sin d` the square `h = d²` has

    dh/dθ = −2 φ b sign a,    d²h/dθ² / 2 = D + (1 − D) φ |a|,    D = b² / sin² d,

so that it is convex but for its kink at `a = 0`. The squared chord `h = 2 (1 − |a|)` has `φ = 1` and `d²h/dθ² / 2 = |a|`.
A missing sample is four zeros, which make all of this 0.
"""

from typing import NamedTuple

import numpy as np

from quatfilt._reference._arrays import Reals
from quatfilt._reference.rotations.quaternion import log, norm


class Parts(NamedTuple):
    """A direction as axes and lengths."""

    axes: Reals
    """`(joints, 3)`, unit vectors; 0 for a joint that rests."""
    lengths: Reals
    """`(joints,)`."""


class Seen(NamedTuple):
    """Samples as seen from a point of a geodesic, `(poses, joints)` each."""

    squares: Reals
    """`h`: squared distances, or squared chords."""
    factors: Reals
    """`φ sign a`."""
    along: Reals
    """`b`."""
    bends: Reals
    """`d²h/dθ² / 2`."""


def parts(v: Reals) -> Parts:
    """Axes and lengths of a direction `(joints, 3)`."""
    lengths = norm(v)
    return Parts(v / np.where(lengths > 0, lengths, 1)[:, None], lengths)


def seen(x: Reals, v: Parts, s: Reals, objective: str, signs: Reals | None = None) -> Seen:
    """See samples `(poses, joints, 4)` from the points `c_v(s)`, `s` `(poses,)`.

    With `signs`, `(poses, joints)`, as if those were the signs of `a`: then nothing has a kink.
    """
    w, u = x[..., 0], x[..., 1:]
    theta = s[:, None] * v.lengths
    cos, sin = np.cos(theta), np.sin(theta)
    p = np.einsum("njc,jc->nj", u, v.axes)
    across = u - p[..., None] * v.axes
    a, b = w * cos + p * sin, p * cos - w * sin
    sign = np.copysign(1, a) if signs is None else signs
    a = a * sign
    square = np.einsum("njc,njc->nj", across, across) + b * b
    sine = np.sqrt(square)
    if objective == "chordal":
        phi = np.ones_like(a)
        squares = 2 * square / (1 + a)
        bends = a
    else:
        d = np.arctan2(sine, a)
        phi = np.where(sine > 0, d / np.where(sine > 0, sine, 1), 1)
        squares = d * d
        share = b * b / np.where(sine > 0, square, 1)
        bends = share + (1 - share) * phi * a
    return Seen(squares, phi * sign, b, bends)


def logarithms(x: Reals) -> Reals:
    """Logarithms of samples; 0 where they are missing."""
    y = np.zeros((*x.shape[:-1], 3))
    there = np.any(x != 0, axis=-1)
    y[there] = log(x[there])
    return y
