"""Reconstruction of a live source."""

import threading
from typing import Any, NamedTuple, NoReturn

import numpy as np
from numpy.typing import ArrayLike

from quatfilt._typing import Array
from quatfilt.reconstruction.reconstructor import trajectories


class ReconstructedPose(NamedTuple):
    """A pose of a stream.

    Parameters
    ----------
    rotations : ndarray, shape (joints, 4)
        Rotation of each joint in its parent.
    translation : ndarray, shape (3,), skeleton units
        Position of the root.
    energies : ndarray, shape (2,)
        As `MotionReconstructor.energies_`.

    Examples
    --------
    >>> import numpy as np, quatfilt as qf
    >>> qf.ReconstructedPose(np.zeros((2, 4)), np.zeros(3), np.zeros(2)).translation
    array([0., 0., 0.])
    """

    rotations: Array
    translation: Array
    energies: Array


class ReconstructionStream:
    """Reconstruct the motion of a live source: control points in, a pose out.

    `MotionReconstructor.stream` makes one. All that comes out, put together, is what `MotionReconstructor.reconstruct`
    makes of all that was pushed.

    Parameters
    ----------
    tracker : object
        What takes control points in, and gives poses.
    points : int
        How many control points there are.
    noise : tuple of 2 floats, skeleton units and radians
        Standard deviations of places and of turns.

    Raises
    ------
    RuntimeError
        If another thread is in a call of the same stream.

    Notes
    -----
    A stream computes with the Rust core, with every backend; that of the model ``"gplvm"`` with the backend in use.

    Examples
    --------
    >>> import numpy as np, quatfilt as qf
    >>> from quatfilt.evaluation.synthetic import walk
    >>> motion = walk(seconds=4)
    >>> db = qf.MotionDatabase.from_motions([motion], fps=motion.fps)
    >>> stream = qf.MotionReconstructor(db, control_points=["LeftWrist", "LeftAnkle"]).stream()
    >>> isinstance(stream, qf.ReconstructionStream)
    True
    >>> seen = motion.positions()[:, [motion.skeleton.index(name) for name in ("LeftWrist", "LeftAnkle")]]
    >>> stream.push(seen[100]).rotations.shape == motion.rotations.shape[1:]
    True
    """

    def __init__(self, tracker: Any, points: int, noise: tuple[float, float]) -> None:
        self._tracker = tracker
        self._points = points
        self._noise = noise
        self._busy = threading.Lock()
        self._last: Array | None = None

    def push(
        self,
        positions: ArrayLike,
        *,
        orientations: ArrayLike | None = None,
        confidence: float | ArrayLike | None = None,
    ) -> ReconstructedPose:
        """Take the control points of the next frame, and return its pose.

        Parameters
        ----------
        positions : array_like, shape (points, 3), skeleton units
            Where they are; NaN where one is not seen, and at most 1e9. A first frame without any starts anywhere in the database.
        orientations : array_like or None, shape (points, 4), default None
            Their global rotations, NaN or zeros where they are not known.
        confidence : float or array_like (points,) or None, 0…1, default None
            The variance is divided by it; 0: not seen.

        Returns
        -------
        ReconstructedPose
            In the dtype of `positions`, continuous in sign.

        Raises
        ------
        ValueError, TypeError
            If an argument has another shape, type or range than stated; the stream then is as it was.
        """
        if not self._busy.acquire(blocking=False):
            raise RuntimeError("stream: expected one call at a time, got one during another")
        try:
            seen, dtype = trajectories.checked(positions, orientations, confidence, self._points, one=True)
            targets = (array[0] for array in seen.targets(*self._noise))
            rotations, translation, energies = self._tracker.push(*map(np.ascontiguousarray, targets))
            if self._last is not None:
                turned = np.sum(self._last * rotations, axis=1) < 0
                rotations[turned] *= -1
            self._last = rotations
            return ReconstructedPose(rotations.astype(dtype), translation.astype(dtype), energies)
        finally:
            self._busy.release()

    def __reduce__(self) -> NoReturn:
        raise TypeError(
            "ReconstructionStream: a stream can neither be pickled nor copied; make a new one of the same options"
        )


__all__ = ["ReconstructedPose", "ReconstructionStream"]
