"""The Kalman filter of a stream."""

from typing import cast

import numpy as np
from numpy.typing import ArrayLike

from quatfilt import _validation
from quatfilt._backend import streams
from quatfilt._core import PoseStream
from quatfilt._typing import Array, PerJoint
from quatfilt.filters.kalman import EXTREMES
from quatfilt.filters.stream import _stream


class KalmanStream(_stream.Stream):
    """Smooth a live source as `kalman` does a clip: one pose in, one pose out, `lookahead` frames later.

    All that comes out, put together, is ``kalman(clip, lookahead=lookahead, …)`` of all that was pushed, with the same
    noises.
    Joints that are missing at first, or that nobody trusts, are what `push` says: the clip's filter looks ahead there.

    Parameters
    ----------
    process_noise : float or array_like (joints,), rad/s^1.5
        How much the angular velocity changes by chance, at least 0. A stream has not seen its data: take what
        `kalman_noises` chooses on a sample.
    measurement_noise : float or array_like (joints,), radians
        Deviation of a sample per component of the rotation vector, above 0.
    fps : float, hertz, default 1.0
        Frame rate; without it seconds are frames.
    lookahead : int, frames, default 0
        How many later frames count, which is how long a pose waits; from 0 to 1000. 0 is the forward filter.
    scalar_first : bool, default True
        Whether quaternions are ``(w, x, y, z)``; False for SciPy's ``(x, y, z, w)``.

    Attributes
    ----------
    latency : int, frames
        How many frames after it was pushed a pose comes out: `lookahead`.

    Raises
    ------
    ValueError, TypeError
        If an argument has another type or range than stated; the message names it.

    See Also
    --------
    kalman : The filter of a whole clip, and what the options mean.
    kalman_noises : The noises of a sample.

    Notes
    -----
    Cost per push: ``joints · (1 + lookahead)`` steps of the filter.

    A joint that is missing goes on turning, as far as the filter can tell where to, and then stands still.

    A stream computes on the calling thread, in float64 whatever the dtype, with every backend.

    Examples
    --------
    >>> import numpy as np, quatfilt as qf
    >>> t = np.arange(240) / 120
    >>> swing = qf.exp(0.4 * np.sin(2 * np.pi * t)[:, None] * [0.0, 0.0, 1.0])
    >>> noisy = qf.add_gaussian_noise(swing, sigma=np.radians(2), rng=0)
    >>> process, measurement = qf.kalman_noises(noisy[:120], fps=120, lookahead=6)
    >>> options = {"process_noise": process, "measurement_noise": measurement, "fps": 120, "lookahead": 6}
    >>> stream = qf.KalmanStream(**options)
    >>> poses = [pose for pose in map(stream.push, noisy) if pose is not None]
    >>> clean = np.concatenate([poses, stream.flush()])
    >>> bool(np.allclose(clean, qf.kalman(noisy, **options), rtol=0, atol=1e-12))
    True
    """

    def __init__(
        self,
        *,
        process_noise: PerJoint,
        measurement_noise: PerJoint,
        fps: float = 1.0,
        lookahead: int = 0,
        scalar_first: bool = True,
    ) -> None:
        for value, name in [(process_noise, "process_noise"), (measurement_noise, "measurement_noise")]:
            _stream.not_automatic(value, name, "measure a sample with kalman_noises")
        self._process = _stream.strength(process_noise, "process_noise", zero=True)
        self._measurement = _stream.strength(measurement_noise, "measurement_noise")
        self._rate = _validation.number(fps, "fps", above=0)
        ahead = _validation.integer(lookahead, "lookahead", at_least=0, at_most=_stream.LONGEST_RADIUS)
        super().__init__(ahead, scalar_first=scalar_first)

    def push(self, pose: ArrayLike, confidence: float | ArrayLike | None = None) -> Array | None:
        """Take the next pose, and return the one of `latency` frames ago.

        Parameters
        ----------
        pose : array_like, shape (joints, 4) or (4,)
            Unit quaternions, of one shape and dtype in all pushes. A joint that is missing, NaN or four zeros, is no
            measurement.
        confidence : float or array_like (joints,) or None, 0…1, default None
            The variance of each sample is divided by it. 0 is no measurement; before the first that is one a joint comes
            out as it came in.

        Returns
        -------
        ndarray, shape and dtype of `pose`, or None
            Unit quaternions, continuous in sign from the hemisphere of the first sample of a joint on; NaN before it.
            None while the first `latency` poses are taken in.

        Raises
        ------
        ValueError, TypeError
            If an argument has another shape, dtype or range than stated, and after `flush`; the message names it. The
            stream then is as it was.
        RuntimeError
            If another thread is in a call of the same stream.
        """
        return self._push(pose, confidence)

    def _start(self, joints: int) -> PoseStream:
        process = _validation.per_joint(self._process, "process_noise", joints, at_least=0)
        measurement = _validation.per_joint(self._measurement, "measurement_noise", joints, above=0)
        return cast(
            "PoseStream",
            streams().kalman_stream(
                np.clip(process * self._rate**-1.5, 0, EXTREMES[1]),
                np.clip(measurement, *EXTREMES),
                self._latency,
            ),
        )


__all__ = ["KalmanStream"]
