"""Interpolation of rotations in time."""

import math

import numpy as np
from numpy.typing import ArrayLike

from quatfilt import _validation
from quatfilt._backend import ops
from quatfilt._typing import Array

_SAME_TIME = 1e-9
"""Frames by which a new time may miss a sample through rounding alone."""


def slerp(q: ArrayLike, times: ArrayLike, new_times: ArrayLike, *, scalar_first: bool = True) -> Array:
    """Rotations at new times, on the geodesics between neighbouring samples.

    ``q(t) = q_i · exp(u log(q_i⁻¹ q_{i+1}))`` with ``u = (t − t_i) / (t_{i+1} − t_i)``: constant angular velocity from
    each sample to the next, the shorter way. At the time of a sample it is that sample.

    Parameters
    ----------
    q : array_like, shape (frames, joints, 4) or (frames, 4)
        Unit quaternions; signs do not matter. Samples that are NaN or four zeros are missing.
    times : array_like, shape (frames,)
        Times of the frames, in any unit, strictly increasing.
    new_times : array_like, shape (n,)
        Times within the range of `times`, in any order.
    scalar_first : bool, default True
        Whether quaternions are ``(w, x, y, z)``; False for SciPy's ``(x, y, z, w)``.

    Returns
    -------
    ndarray, shape (n, joints, 4) or (n, 4)
        Unit quaternions, continuous in sign. NaN beside a missing sample, unless at the very time of a valid one.

    Raises
    ------
    ValueError
        If shapes do not fit, times do not increase, or new times lie outside of their range.

    Notes
    -----
    About 15 ns per new sample and thread.

    References
    ----------
    K. Shoemake, "Animating rotation with quaternion curves", SIGGRAPH 1985.

    Examples
    --------
    >>> import numpy as np, quatfilt as qf
    >>> quarter = qf.exp([[0.0, 0.0, 0.0], [0.0, 0.0, np.pi / 4]])  # 0 and 90 degrees about z
    >>> np.degrees(2 * qf.log(qf.slerp(quarter, [0.0, 1.0], [0.5]))).round(6)
    array([[ 0.,  0., 45.]])
    """
    array = _validation.quaternions(q, "q", scalar_first=scalar_first)
    clip, _ = _validation.clip(array, "q")
    old = _validation.times(times, "times", len(clip))
    new = _validation.times_within(new_times, "new_times", old)
    result = ops().slerp(clip, old, new).reshape(len(new), *array.shape[1:])
    return _validation.scalar_order(result, scalar_first=scalar_first)


def resample(q: ArrayLike, *, fps: float, new_fps: float, scalar_first: bool = True) -> Array:
    """Rotations at another frame rate, by `slerp`.

    New frames lie at ``0, 1/new_fps, 2/new_fps, …`` seconds, as far as the last sample.

    Parameters
    ----------
    q : array_like, shape (frames, joints, 4) or (frames, 4)
        Unit quaternions; signs do not matter. Samples that are NaN or four zeros are missing.
    fps : float, hertz
        Frame rate of `q`.
    new_fps : float, hertz
        Frame rate of the result.
    scalar_first : bool, default True
        Whether quaternions are ``(w, x, y, z)``; False for SciPy's ``(x, y, z, w)``.

    Returns
    -------
    ndarray, shape (n, joints, 4) or (n, 4)
        Unit quaternions, continuous in sign, ``n = ⌊(frames − 1) new_fps / fps⌋ + 1``. NaN beside a missing sample,
        unless at the very time of a valid one. Clips of fewer than two frames come back unchanged.

    Raises
    ------
    ValueError
        If `q` has another shape, or a frame rate is not above 0.

    Notes
    -----
    About 15 ns per new sample and thread. Going down, nothing is averaged: what is faster than half of the new rate
    folds back, so filter first.

    Examples
    --------
    >>> import numpy as np, quatfilt as qf
    >>> path = qf.exp(np.linspace([0.0, 0.0, 0.0], [0.0, 0.0, 0.6], 7))
    >>> np.round(2 * qf.log(qf.resample(path, fps=60, new_fps=20))[:, 2], 6)
    array([0. , 0.6, 1.2])
    """
    array = _validation.quaternions(q, "q", scalar_first=scalar_first)
    clip, _ = _validation.clip(array, "q")
    old_rate = _validation.number(fps, "fps", above=0)
    new_rate = _validation.number(new_fps, "new_fps", above=0)
    last = len(clip) - 1
    if last < 1:
        return _validation.scalar_order(array.copy(), scalar_first=scalar_first)
    count = math.floor(last * new_rate / old_rate + _SAME_TIME) + 1
    new = np.arange(count) * old_rate / new_rate
    nearest = np.rint(new)
    new = np.where(np.abs(new - nearest) < _SAME_TIME, nearest, new)
    result = ops().slerp(clip, np.arange(len(clip), dtype=np.float64), new).reshape(count, *array.shape[1:])
    return _validation.scalar_order(result, scalar_first=scalar_first)


__all__ = ["resample", "slerp"]
