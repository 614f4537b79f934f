"""The 1€ filter of a stream."""

from typing import cast

from numpy.typing import ArrayLike

from quatfilt import _validation
from quatfilt._backend import streams
from quatfilt._core import PoseStream
from quatfilt._typing import Array, PerJoint
from quatfilt.filters.stream import _stream


class OneEuroStream(_stream.Stream):
    """Smooth a live source as `one_euro` does a clip: one pose in, one pose out, without waiting.

    All that comes out, put together, is ``one_euro(clip, …)`` of all that was pushed, with the same options.
    Joints that are missing at first, or that nobody trusts, are what `push` says: the clip's filter looks ahead there.

    Parameters
    ----------
    fps : float, hertz, default 1.0
        Frame rate; without it seconds are frames.
    min_cutoff : float or array_like (joints,), hertz, default 1.0
        Cutoff at rest, above 0: the lower, the less noise and the more delay.
    beta : float or array_like (joints,), 1/rad, default 0.0
        How fast the cutoff grows with the speed, in hertz per rad/s, at least 0.
    derivative_cutoff : float or array_like (joints,), hertz, default 1.0
        Cutoff of the angular velocity, above 0.
    scalar_first : bool, default True
        Whether quaternions are ``(w, x, y, z)``; False for SciPy's ``(x, y, z, w)``.

    Attributes
    ----------
    latency : int, frames
        How many frames after it was pushed a pose comes out: 0.

    Raises
    ------
    ValueError, TypeError
        If an argument has another type or range than stated; the message names it.

    See Also
    --------
    one_euro : The filter of a whole clip, and what the options mean.

    Notes
    -----
    A joint that is missing stands still; after it the time since its last sample counts.

    A stream computes on the calling thread, in float64 whatever the dtype, with every backend.

    Examples
    --------
    >>> import numpy as np, quatfilt as qf
    >>> t = np.arange(240) / 120
    >>> swing = qf.exp(0.4 * np.sin(2 * np.pi * t)[:, None] * [0.0, 0.0, 1.0])
    >>> noisy = qf.add_gaussian_noise(swing, sigma=np.radians(2), rng=0)
    >>> stream = qf.OneEuroStream(fps=120, min_cutoff=2.0, beta=0.5)
    >>> clean = np.array([stream.push(pose) for pose in noisy])
    >>> clip = qf.one_euro(noisy, fps=120, min_cutoff=2.0, beta=0.5)
    >>> bool(np.allclose(clean, clip, rtol=0, atol=1e-12))
    True
    """

    def __init__(
        self,
        *,
        fps: float = 1.0,
        min_cutoff: PerJoint = 1.0,
        beta: PerJoint = 0.0,
        derivative_cutoff: PerJoint = 1.0,
        scalar_first: bool = True,
    ) -> None:
        self._rate = _validation.number(fps, "fps", above=0)
        self._least = _stream.strength(min_cutoff, "min_cutoff", infinite=True)
        self._growth = _stream.strength(beta, "beta", zero=True)
        self._derivative = _stream.strength(derivative_cutoff, "derivative_cutoff", infinite=True)
        super().__init__(0, scalar_first=scalar_first)

    def push(self, pose: ArrayLike, confidence: float | ArrayLike | None = None) -> Array:
        """Take the next pose, and return it filtered.

        Parameters
        ----------
        pose : array_like, shape (joints, 4) or (4,)
            Unit quaternions, of one shape and dtype in all pushes. A joint that is missing, NaN or four zeros, stays.
        confidence : float or array_like (joints,) or None, 0…1, default None
            The share of each sample is multiplied by it. 0 is no sample; before the first that is one a joint comes out
            as it came in.

        Returns
        -------
        ndarray, shape and dtype of `pose`
            Unit quaternions, continuous in sign from the hemisphere of the first sample of a joint on; NaN before it.

        Raises
        ------
        ValueError, TypeError
            If an argument has another shape, dtype or range than stated, and after `flush`; the message names it. The
            stream then is as it was.
        RuntimeError
            If another thread is in a call of the same stream.
        """
        return cast("Array", self._push(pose, confidence))

    def _start(self, joints: int) -> PoseStream:
        least = _validation.per_joint(self._least, "min_cutoff", joints, above=0, infinite=True)
        growth = _validation.per_joint(self._growth, "beta", joints, at_least=0)
        derivative = _validation.per_joint(
            self._derivative, "derivative_cutoff", joints, above=0, infinite=True
        )
        return cast(
            "PoseStream", streams().one_euro_stream(least / self._rate, growth, derivative / self._rate)
        )


__all__ = ["OneEuroStream"]
