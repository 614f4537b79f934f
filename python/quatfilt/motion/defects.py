"""What is wrong with a clip before any filter: missing samples, spikes, flips, frozen frames."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from quatfilt import _validation
from quatfilt._typing import Mask
from quatfilt.rotations.quaternion import geodesic_distance

STEADY = 15.0 * 120.0
"""Degrees per second: no joint of a body turns faster, and what does is a defect or a gimbal lock of the capture.
Steady joints stay below everywhere: 15 degrees in a frame at 120 frames per second."""


@dataclass(frozen=True)
class Defects:
    """What is wrong with a clip, per joint.

    Parameters
    ----------
    missing : ndarray of int, shape (joints,)
        Samples that are NaN or four zeros.
    fastest : ndarray, shape (joints,), degrees
        Largest turn within one frame.
    spikes : ndarray of bool, shape (frames, joints)
        Samples that leave their neighbours by more than the steady step and return at once.
    jumps : ndarray of bool, shape (frames, joints)
        Samples that leave the one before by more than the steady step, and are no spike nor the return from one.
    frozen : int
        Frames in which no joint moves at all, although all are there.
    """

    missing: NDArray[np.intp]
    fastest: NDArray[np.float64]
    spikes: Mask
    jumps: Mask
    frozen: int

    @property
    def steady(self) -> Mask:
        """Whether a joint never jumps, ``(joints,)``."""
        return np.asarray(~(self.spikes | self.jumps).any(axis=0))


def find_defects(q: ArrayLike, *, fps: float = 120.0) -> Defects:
    """Look for defects in rotations.

    Parameters
    ----------
    q : array_like, shape (frames, joints, 4)
        Unit quaternions; NaN and four zeros are missing samples.
    fps : float, hertz, default 120.0
        Frame rate: the steady step is 15° at 120.

    Returns
    -------
    Defects
        What was found.
    """
    clip, _ = _validation.clip(q, "q")
    largest = STEADY / _validation.number(fps, "fps", above=0)
    missing: Mask = np.asarray(~(np.isfinite(clip).all(axis=-1) & (clip != 0).any(axis=-1)))
    known = np.where(missing[..., None], np.nan, clip)
    steps = np.degrees(geodesic_distance(known[:-1], known[1:]))
    far: Mask = np.zeros(missing.shape, np.bool_)
    far[1:] = steps > largest
    spikes: Mask = np.zeros_like(far)
    if len(clip) > 2:
        around = np.degrees(geodesic_distance(known[:-2], known[2:]))
        shorter = np.minimum(steps[:-1], steps[1:])
        spikes[1:-1] = (shorter > largest) & (around < shorter / 2)
    returns = np.zeros_like(far)
    returns[1:] = spikes[:-1]
    still = (steps == 0).all(axis=1) if steps.size else np.zeros(0, np.bool_)
    return Defects(
        missing=np.sum(missing, axis=0),
        fastest=np.max(np.nan_to_num(steps), axis=0, initial=0.0),
        spikes=spikes,
        jumps=np.asarray(far & ~spikes & ~returns),
        frozen=int(np.count_nonzero(still)),
    )


__all__ = ["Defects", "find_defects"]
