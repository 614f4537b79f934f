"""Interpolation of rotations in time."""

import numpy as np

from quatfilt._reference._arrays import Reals
from quatfilt._reference.rotations.quaternion import between, continuous, exp, log_short, multiply, normalize


def slerp(q: Reals, times: Reals, new_times: Reals) -> Reals:
    """Rotations at new times, each on the geodesic between its two neighbours.

    `q(t) = q_i · exp(u log(q_i⁻¹ q_{i+1}))` with `u = (t − t_i) / (t_{i+1} − t_i)`, the shorter way. At the time of a
    sample it is that sample; next to a missing sample it is NaN.

    Parameters
    ----------
    q : array (frames, joints, 4)
        Rotations.
    times : array (frames,)
        Their times, strictly increasing.
    new_times : array (n,)
        Times within the range of `times`.

    Returns
    -------
    array (n, joints, 4)
        Unit quaternions, continuous in sign.
    """
    path = continuous(normalize(q.astype(np.float64)))
    if len(times) < 2:
        return path[np.zeros(len(new_times), int)].astype(q.dtype)
    left = np.clip(np.searchsorted(times, new_times, side="right") - 1, 0, len(times) - 2)
    part = ((new_times - times[left]) / (times[left + 1] - times[left]))[:, None, None]
    between_them = geodesic(path[left], path[left + 1], part)
    at_a_sample = np.where(part == 0, path[left], path[left + 1])
    result = np.where((part == 0) | (part == 1), at_a_sample, between_them)
    return continuous(result).astype(q.dtype)


def geodesic(a: Reals, b: Reals, part: Reals) -> Reals:
    """Rotation at the fraction `part` (0 … 1) of the shorter geodesic from `a` to `b`."""
    return multiply(a, exp(part * log_short(between(a, b))))
