"""What all streams share: shapes and dtypes of poses, one call at a time, and the end of the clip."""

import threading
from abc import ABC, abstractmethod
from typing import Any, NoReturn

import numpy as np
from numpy.typing import ArrayLike

from quatfilt import _validation
from quatfilt._core import PoseStream
from quatfilt._typing import Array
from quatfilt.filters.boundary import Boundary

_BOUNDARIES: tuple[Boundary, ...] = ("nearest", "linear")

LONGEST_RADIUS = 1000
"""Frames: no pose would come in time out of a window beyond it."""


def checked_boundary(boundary: Boundary, latency: int) -> Boundary:
    """Return `boundary` if the first pose that comes out can know what lies before the first frame."""
    reason = "it shows later frames before the first"
    chosen = _validation.choice(boundary, "boundary", _BOUNDARIES, elsewhere={"mirror": reason})
    if chosen == "linear" and latency == 0:
        raise ValueError(
            "boundary: expected 'nearest' with lookahead=0, got 'linear'; the velocity at the start needs the second frame"
        )
    return chosen


def strength(
    value: float | ArrayLike | None, name: str, *, zero: bool = False, infinite: bool = False
) -> float | Array:
    """Return a checked number above or from `zero`, or a copy of one per joint; the first pose tells whether it fits."""
    bounds = {"at_least": 0.0} if zero else {"above": 0.0}
    if np.isscalar(value):
        return _validation.number(value, name, **bounds, infinite=infinite)
    array = None if value is None else _validation.floats(value, name).copy()
    joints = 0 if array is None else array.size
    return _validation.per_joint(array, name, joints, **bounds, infinite=infinite)


def not_automatic(value: Any, name: str, instead: str) -> None:
    """Refuse "auto", which the filter of the whole clip takes."""
    if isinstance(value, str):
        raise ValueError(  # noqa: TRY004 - "auto" is a value of the filter of the whole clip
            f"{name}: expected a number or one per joint, got {value!r}; a stream has not seen its data, {instead}",
        )


class Stream(ABC):
    """A filter that takes a clip pose by pose.

    The first pose settles the number of joints and the dtype; the core's stream is made then.
    """

    def __init__(self, latency: int, *, scalar_first: bool) -> None:
        self._latency = latency
        self._scalar_first = scalar_first
        self._busy = threading.Lock()
        self._ended = False
        self._first: Array | None = None
        self._core: PoseStream | None = None

    @abstractmethod
    def _start(self, joints: int) -> PoseStream:
        """Make the core's stream, and see that options per joint fit."""

    @property
    def latency(self) -> int:
        """How many frames after it was pushed a pose comes out."""
        return self._latency

    def flush(self) -> Array:
        """End the clip, and return the poses that are still to come.

        Returns
        -------
        ndarray, shape (n, joints, 4) or (n, 4)
            The last poses, at most `latency` of them; ``(0, 0, 4)`` if none was pushed. What lies beyond the end of the clip is made up as `boundary` says.

        Raises
        ------
        ValueError
            If the stream was flushed before: a new clip needs a new stream.
        """
        self._enter()
        try:
            self._ended = True
            if self._core is None or self._first is None:
                return np.empty((0, 0, 4))
            return self._returned(self._core.flush(), (-1, *self._first.shape))
        finally:
            self._busy.release()

    def _push(self, pose: ArrayLike, confidence: Any = None) -> Array | None:
        self._enter()
        try:
            array = _validation.pose(pose, self._first, scalar_first=self._scalar_first)
            joints = array.size // 4
            trust = _validation.pose_confidence(confidence, joints)
            if self._core is None:
                self._core = self._start(joints)
                self._first = array[...].copy()
            came = self._core.push(array.astype(np.float64, copy=False).reshape(-1, 4), trust)
            return None if came is None else self._returned(came, array.shape)
        finally:
            self._busy.release()

    def _enter(self) -> None:
        if not self._busy.acquire(blocking=False):
            raise RuntimeError("stream: expected one call at a time, got one during another")
        if self._ended:
            self._busy.release()
            raise ValueError("stream: expected no call after flush(); a new clip needs a new stream")

    def _returned(self, poses: Array, shape: tuple[int, ...]) -> Array:
        """Return what came out of the core in the dtype and order of what came in."""
        if self._first is not None:
            poses = poses.astype(self._first.dtype, copy=False)
        if shape[0] < 0:
            shape = (len(poses), *shape[1:])
        return _validation.scalar_order(poses.reshape(shape), scalar_first=self._scalar_first)

    def __reduce__(self) -> NoReturn:
        raise TypeError(
            f"{type(self).__name__}: a stream can neither be pickled nor copied; make a new one of the same options"
        )


__all__ = ["LONGEST_RADIUS", "Stream", "checked_boundary", "not_automatic", "strength"]
