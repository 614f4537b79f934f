"""The bilateral orientation filter of a stream."""

from typing import cast

from numpy.typing import ArrayLike

from quatfilt import _validation
from quatfilt._backend import streams
from quatfilt._core import PoseStream
from quatfilt._typing import Array
from quatfilt.filters.bilateral import KERNELS, Kernel
from quatfilt.filters.boundary import Boundary
from quatfilt.filters.stream import _stream

_MOST_ITERATIONS = 1000
"""More passes than any pose would come through in time."""


class BilateralStream(_stream.Stream):
    """Smooth a live source as `bilateral` does a clip: one pose in, one pose out, a fixed number of frames later.

    All that comes out, put together, is ``bilateral(clip, lookahead=lookahead, boundary=boundary, …)`` of all that was
    pushed, with the same options.
    Joints that are missing at first, or that nobody trusts, are what `push` says: the clip's filter looks ahead there.

    Parameters
    ----------
    radius : int, frames, default 4
        How many earlier frames a window has, from 0 to 1000.
    sigma_time : float, frames, default 1.0
        Scale of distances in time.
    sigma_angle : float or array_like (joints,), radians of rotation, default 0.2
        Scale of distances between rotations. Infinite: they do not matter.
    kernel : {"gaussian", "printed", "classic"}, default "gaussian"
        The shape of the weights.
    iterations : int, default 1
        How often the filter is applied, from 1 to 1000; each pass waits for `lookahead` frames of its own.
    boundary : {"nearest", "linear"}, default "nearest"
        How the clip goes on before its first pose and after its last, anew in each pass: the pose is held; the angular
        velocity is held, for which the second frame must be known, so that `lookahead` is at least 1. `bilateral` has
        another default.
    lookahead : int, frames, default 0
        How many later frames a pass sees, from 0 to `radius`, where it is no limit any more.
    scalar_first : bool, default True
        Whether quaternions are ``(w, x, y, z)``; False for SciPy's ``(x, y, z, w)``.

    Attributes
    ----------
    latency : int, frames
        How many frames after it was pushed a pose comes out: ``iterations · lookahead``.

    Raises
    ------
    ValueError, TypeError
        If an argument has another type or range than stated; the message names it.

    See Also
    --------
    bilateral : The filter of a whole clip, and what the options mean.

    Notes
    -----
    Cost per push: ``iterations · joints · (radius + lookahead)`` comparisons of rotations.

    A joint that is missing stands still, and a sample that was held counts like any other.

    A stream computes on the calling thread, in float64 whatever the dtype, with every backend.

    Examples
    --------
    >>> import numpy as np, quatfilt as qf
    >>> t = np.arange(240) / 120
    >>> swing = qf.exp(0.4 * np.sin(2 * np.pi * t)[:, None] * [0.0, 0.0, 1.0])
    >>> noisy = qf.add_gaussian_noise(swing, sigma=np.radians(2), rng=0)
    >>> stream = qf.BilateralStream(iterations=2, lookahead=2)
    >>> stream.latency
    4
    >>> poses = [pose for pose in map(stream.push, noisy) if pose is not None]
    >>> clean = np.concatenate([poses, stream.flush()])
    >>> clip = qf.bilateral(noisy, iterations=2, lookahead=2, boundary="nearest")
    >>> bool(np.allclose(clean, clip, rtol=0, atol=1e-12))
    True
    """

    def __init__(
        self,
        *,
        radius: int = 4,
        sigma_time: float = 1.0,
        sigma_angle: float | ArrayLike = 0.2,
        kernel: Kernel = "gaussian",
        iterations: int = 1,
        boundary: Boundary = "nearest",
        lookahead: int = 0,
        scalar_first: bool = True,
    ) -> None:
        reach = _validation.integer(radius, "radius", at_least=0, at_most=_stream.LONGEST_RADIUS)
        self._window = (reach, _validation.number(sigma_time, "sigma_time", above=0))
        self._angles = _stream.strength(sigma_angle, "sigma_angle", infinite=True)
        passes = _validation.integer(iterations, "iterations", at_least=1, at_most=_MOST_ITERATIONS)
        ahead = _validation.integer(lookahead, "lookahead", at_least=0, at_most=reach)
        self._options = (
            _validation.choice(kernel, "kernel", KERNELS),
            passes,
            _stream.checked_boundary(boundary, ahead),
            ahead,
        )
        super().__init__(passes * ahead, scalar_first=scalar_first)

    def push(self, pose: ArrayLike) -> Array | None:
        """Take the next pose, and return the one of `latency` frames ago.

        Parameters
        ----------
        pose : array_like, shape (joints, 4) or (4,)
            Unit quaternions, of one shape and dtype in all pushes. A joint that is missing, NaN or four zeros, holds its
            last sample.

        Returns
        -------
        ndarray, shape and dtype of `pose`, or None
            Unit quaternions, continuous in sign from the hemisphere of the first sample of a joint on; NaN before it.
            None while the first `latency` poses are taken in.

        Raises
        ------
        ValueError, TypeError
            If the pose has another shape or dtype than stated, and after `flush`; the message names it. The stream then
            is as it was.
        RuntimeError
            If another thread is in a call of the same stream.
        """
        return self._push(pose)

    def _start(self, joints: int) -> PoseStream:
        angles = _validation.per_joint(self._angles, "sigma_angle", joints, above=0, infinite=True)
        return cast("PoseStream", streams().bilateral_stream(*self._window, angles, *self._options))


__all__ = ["BilateralStream"]
