"""The heading of a body: how far its root is turned about the vertical."""

import numpy as np

from quatfilt._reference._arrays import Reals
from quatfilt._reference.rotations.quaternion import is_missing, multiply


def split_heading(roots: Reals, up: int) -> tuple[Reals, Reals]:
    """Split rotations of a root into headings `h` and rests `r`: `q = (cos h/2, sin h/2 · e) · r`.

    The heading is the twist of `q = (w, v)` about the vertical `e` (swing and twist): `h = 2·atan2(v·e, w)`, which leaves a
    rest without a component along `e`, the shortest turn that brings the vertical where `q` brings it. It is not defined
    where that is upside down, `w = v·e = 0`; it is 0 there.

    Parameters
    ----------
    roots : array (frames, 4)
        Rotations, unit quaternions.
    up : int
        The axis of the vertical `e`: 0, 1 or 2.

    Returns
    -------
    heading : array (frames,)
        Radians, without jumps from frame to frame: between `−π` and `π` at the first valid sample, and within half a turn of the
        valid sample before it afterwards. NaN at missing samples.
    rest : array (frames, 4)
        The remaining rotation, computed with the rounded heading, so that both together give `q`; NaN at missing samples.
    """
    valid = ~is_missing(roots)
    q = roots[valid].astype(np.float64)
    turned = 2 * np.arctan2(q[:, 1 + up] * np.copysign(1, q[:, 0]), np.abs(q[:, 0]))
    whole_turns = np.cumsum(np.round(np.diff(turned, prepend=turned[:1]) / (2 * np.pi)))
    heading = np.full(len(roots), np.nan, roots.dtype)
    heading[valid] = turned - 2 * np.pi * whole_turns
    half = heading[valid].astype(np.float64) / 2
    back = np.zeros_like(q)
    back[:, 0] = np.cos(half)
    back[:, 1 + up] = -np.sin(half)
    rest = np.full_like(roots, np.nan)
    rest[valid] = multiply(back, q)
    return heading, rest
