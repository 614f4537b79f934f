"""Non-local pose means of a stream."""

from typing import Literal, cast

from numpy.typing import ArrayLike

from quatfilt import _validation
from quatfilt._backend import streams
from quatfilt._core import PoseStream
from quatfilt._typing import Array
from quatfilt.filters.boundary import Boundary
from quatfilt.filters.nonlocal_pose_means import ALL, DISTANCES, MOST, WEIGHTS, Distance, Weights
from quatfilt.filters.stream import _stream

StreamChart = Literal["local", "identity"]

_CHARTS: tuple[StreamChart, ...] = ("local", "identity")


class NonlocalPoseMeansStream(_stream.Stream):
    """Denoise a live source as `nonlocal_pose_means` does a clip: one pose in, one pose out, `lookahead` frames later.

    All that comes out, put together, is ``nonlocal_pose_means(clip, lookahead=lookahead, …)`` of all that was pushed, with
    the same options. Nothing later than the pose that was pushed is needed, so options that look at the whole clip are
    refused: an automatic bandwidth, an unlimited search radius, the chart "mean", the boundary "mirror".
    Joints that are missing, or that nobody trusts, are what `push` says: the clip's filter looks ahead there.

    Parameters
    ----------
    bandwidth : float or array_like (joints,), radians of rotation per coordinate
        How unlike patches may be. A stream has not seen its data: take the noise that `noise_level` estimates on a sample.
    search_radius : int, frames, default 10
        Radius of the learning window, from 1 to 1000.
    patch_radius : int, frames, default 5
        Radius of a patch, from 0 to 1000.
    distance : {"mean", "sum"}, default "mean"
        Whether squares are averaged over a patch, or summed.
    weights : {"pose", "joint"}, default "pose"
        One weight per pose, or per joint.
    neighbors : int or None, default None
        Only so many most similar patches of the window count; None for all.
    chart : {"local", "identity"}, default "local"
        Where rotations become vectors; `nonlocal_pose_means` has another default.
    boundary : {"nearest", "linear"}, default "nearest"
        How the clip goes on before its first pose and after its last: the pose is held; the angular velocity is held,
        for which the second frame must be known, so that `lookahead` is at least 1.
    lookahead : int, frames, default 0
        How many later frames count, which is how long a pose waits; from 0 to `search_radius` + `patch_radius`, where it
        is no limit any more. The patch ends so many frames after its pose, but at most `patch_radius`; what is left is for
        later candidates.
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
    nonlocal_pose_means : The filter of a whole clip, and what the options mean.

    Notes
    -----
    Cost per push: ``joints · (3·search_radius + lookahead)`` comparisons of rotations. The first push costs as much as
    ``search_radius + patch_radius`` more, for the frames before it.

    A stream computes on the calling thread, in float64 whatever the dtype, with every backend.

    Examples
    --------
    >>> import numpy as np, quatfilt as qf
    >>> t = np.arange(240) / 120
    >>> swing = qf.exp(0.4 * np.sin(2 * np.pi * t)[:, None] * [0.0, 0.0, 1.0])
    >>> noisy = qf.add_gaussian_noise(swing, sigma=np.radians(2), rng=0)
    >>> stream = qf.NonlocalPoseMeansStream(bandwidth=np.radians(2), lookahead=4)
    >>> poses = [pose for pose in map(stream.push, noisy) if pose is not None]
    >>> clean = np.concatenate([poses, stream.flush()])
    >>> clip = qf.nonlocal_pose_means(noisy, bandwidth=np.radians(2), lookahead=4, chart="local")
    >>> bool(np.allclose(clean, clip, rtol=0, atol=1e-12))
    True
    """

    def __init__(
        self,
        *,
        bandwidth: float | ArrayLike,
        search_radius: int = 10,
        patch_radius: int = 5,
        distance: Distance = "mean",
        weights: Weights = "pose",
        neighbors: int | None = None,
        chart: StreamChart = "local",
        boundary: Boundary = "nearest",
        lookahead: int = 0,
        scalar_first: bool = True,
    ) -> None:
        _stream.not_automatic(bandwidth, "bandwidth", "measure a sample with noise_level")
        if search_radius is None:
            raise ValueError(
                "search_radius: expected a number of frames, got None; a stream has no whole clip"
            )
        self._bandwidth = _stream.strength(bandwidth, "bandwidth")
        radius = _validation.integer(
            search_radius, "search_radius", at_least=1, at_most=_stream.LONGEST_RADIUS
        )
        patch = _validation.integer(patch_radius, "patch_radius", at_least=0, at_most=_stream.LONGEST_RADIUS)
        ahead = _validation.integer(lookahead, "lookahead", at_least=0, at_most=radius + patch)
        self._options = (
            radius,
            patch,
            _validation.choice(distance, "distance", DISTANCES),
            _validation.choice(weights, "weights", WEIGHTS),
            ALL
            if neighbors is None
            else _validation.integer(neighbors, "neighbors", at_least=1, at_most=MOST),
            _validation.choice(
                chart, "chart", _CHARTS, elsewhere={"mean": "the mean rotation needs the whole clip"}
            ),
            _stream.checked_boundary(boundary, ahead),
            ahead,
        )
        super().__init__(ahead, scalar_first=scalar_first)

    def push(self, pose: ArrayLike, confidence: float | ArrayLike | None = None) -> Array | None:
        """Take the next pose, and return the one of `latency` frames ago.

        Parameters
        ----------
        pose : array_like, shape (joints, 4) or (4,)
            Unit quaternions, of one shape and dtype in all pushes. A joint that is missing, NaN or four zeros, holds its
            last sample, and counts as nothing.
        confidence : float or array_like (joints,) or None, 0…1, default None
            How far each sample counts, in patch distances and in means.

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
        bandwidth = _validation.per_joint(self._bandwidth, "bandwidth", joints, above=0)
        return cast("PoseStream", streams().nonlocal_pose_means_stream(bandwidth, *self._options))


__all__ = ["NonlocalPoseMeansStream", "StreamChart"]
