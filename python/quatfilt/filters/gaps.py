"""Gaps: runs of missing samples."""

import math
from typing import Literal

from numpy.typing import ArrayLike

from quatfilt import _validation
from quatfilt._backend import ops
from quatfilt._typing import Array, Mask

Method = Literal["slerp", "squad"]

_METHODS: tuple[Method, ...] = ("slerp", "squad")

_ROUNDING = 1e-9
"""Frames by which a gap of exactly `max_gap` may seem longer."""

_ANY_LENGTH = -1


def gap_frames(max_gap: float | None, fps: float, frames: int, name: str = "max_gap") -> int:
    """Return the longest gap in frames, at most `frames`; −1 for any length. `name` is the argument's in messages."""
    rate = _validation.number(fps, "fps", above=0)
    if max_gap is None:
        return _ANY_LENGTH
    return math.floor(min(_validation.number(max_gap, name, at_least=0) * rate, frames) + _ROUNDING)


def fill_gaps(
    q: ArrayLike,
    *,
    max_gap: float | None = None,
    method: Method = "slerp",
    fps: float = 1.0,
    scalar_first: bool = True,
) -> tuple[Array, Mask]:
    """Fill runs of missing samples.

    A run between two valid samples of a joint is filled along the geodesic that joins them, the shorter way, at
    constant angular velocity; with ``method="squad"`` on a curve that takes up the motion before and after it. A run at
    an end of the clip is held at the nearest valid sample.

    Parameters
    ----------
    q : array_like, shape (frames, joints, 4) or (frames, 4)
        Unit quaternions. Samples that are NaN, infinite or four zeros are missing.
    max_gap : float or None, seconds, default None
        The longest run that is filled; None for any length. Longer runs, and joints without any valid sample, become
        NaN.
    method : {"slerp", "squad"}, default "slerp"
        The way through a gap. ``"squad"`` is Shoemake's spherical cubic: at either end it has the angular velocity of
        the parabola through the sample there, the valid one before it and the valid one after it; where there is none
        beyond the gap, that of the geodesic.
    fps : float, hertz, default 1.0
        Frame rate; without it `max_gap` counts frames.
    scalar_first : bool, default True
        Whether quaternions are ``(w, x, y, z)``; False for SciPy's ``(x, y, z, w)``.

    Returns
    -------
    rotations : ndarray, shape of `q`
        Continuous in sign from the first valid sample on. Valid samples are otherwise as they were.
    filled : ndarray of bool, shape (frames, joints) or (frames,)
        Where samples were filled in.

    Raises
    ------
    ValueError
        If `q` has another shape or holds samples that are neither missing nor near unit length, if `max_gap` is
        negative, or if `fps` is not above 0.

    Notes
    -----
    Linear in the number of samples: about 15 ns each and per thread.

    Over long gaps ``"squad"`` extrapolates: noise of the velocities at the ends is multiplied by up to 0.15 times the
    length of the gap in frames.

    References
    ----------
    .. [1] K. Shoemake, "Quaternion calculus and fast animation", SIGGRAPH 1987 course notes.

    Examples
    --------
    >>> import numpy as np, quatfilt as qf
    >>> path = qf.exp([[0.0, 0.0, 0.0], [np.nan] * 3, [0.0, 0.0, 0.2]])
    >>> rotations, filled = qf.fill_gaps(path)
    >>> filled
    array([False,  True, False])
    >>> qf.log(rotations).round(6)
    array([[0. , 0. , 0. ],
           [0. , 0. , 0.1],
           [0. , 0. , 0.2]])
    """
    array = _validation.quaternions(q, "q", scalar_first=scalar_first)
    clip, _ = _validation.clip(array, "q")
    way = _validation.choice(method, "method", _METHODS)
    rotations, filled = ops().fill_gaps(clip, gap_frames(max_gap, fps, len(clip)), way)
    return (
        _validation.scalar_order(rotations.reshape(array.shape), scalar_first=scalar_first),
        filled.reshape(array.shape[:-1]),
    )


__all__ = ["fill_gaps"]
