"""Smoothing along the principal axes of the whole body: joints that move together steady each other."""

import math

import numpy as np
from numpy.typing import NDArray

from quatfilt._reference._arrays import Reals
from quatfilt._reference.filters.development import developed_about, undevelop
from quatfilt._reference.filters.smooth.penalised import penalised_column
from quatfilt._reference.filters.smooth.smooth import LEAST_NOISE
from quatfilt._reference.rotations.quaternion import normalize

SHARE = 0.5
"""Share of the body's estimate beside the pilot. The one errs where joints are alike by chance, the other where they are not seen
together; their mean errs less than either."""

FEWEST = 3
"""Frames per axis, at least. In shorter clips the axes follow what the pilot has left of the noise, which then looks like motion:
with as many frames as axes the step loses up to 2 dB, with three times as many it gains."""

STILL = 0.03
"""Sum of squares of the pilot's steps along an axis, in units of the noise, below which the axis is left to the pilot: such steps
are noise themselves, and the directions of axes without steps are chance."""

JOINTS = 64
"""Joints of a body, at most. More are as many bodies as there must be, of nearly one size and in the order of the joints: cost
does not grow with the square of their number."""


def smooth_body(q: Reals, pilot: Reals, confidence: Reals | None, noise: Reals) -> Reals:
    """Smooth all joints together along the principal axes of the body, and take the mean with the pilot.

    The vectors of all joints about the pilot, in units of their noise, make one vector of a pose; its axes are those of the pilot's
    steps from frame to frame. Each axis along which the pilot moves is smoothed as :func:`.smooth.smooth` smooths that of a joint.
    In clips of fewer than `FEWEST` frames per axis the pilot stays as it is. More than `JOINTS` joints with noise are several bodies.

    Parameters
    ----------
    q : array (frames, joints, 4)
        Rotations without missing samples.
    pilot : array (frames, joints, 4)
        An estimate of them.
    confidence : array (frames, joints) or None
        From 0 to 1: by as much as it lacks a sample is pulled to the pilot.
    noise : array (joints,), radians
        Deviation of the noise per component of the rotation vector. Joints with 0 stay as the pilot has them.

    Returns
    -------
    array (frames, joints, 4)
        Unit quaternions, continuous in sign from the hemisphere of the first frame of `q`.
    """
    path, about = (normalize(x.astype(np.float64)) for x in (q, pilot))
    reference, development, vectors = developed_about(about, path)
    if confidence is not None:
        vectors = development + confidence[..., None] * (vectors - development)
    result = development.copy()
    for body in bodies(np.flatnonzero(noise >= LEAST_NOISE)):
        scale = noise[body, None]
        change = moves(development[:, body] / scale, vectors[:, body] / scale)
        result[:, body] += SHARE * change * scale
    return undevelop(q, reference, development, result)


def bodies(noisy: NDArray[np.intp]) -> list[NDArray[np.intp]]:
    """Cut joints into bodies of nearly one size, each of them as large as the first or smaller."""
    if len(noisy) == 0:
        return []
    size = math.ceil(len(noisy) / math.ceil(len(noisy) / JOINTS))
    return [noisy[first : first + size] for first in range(0, len(noisy), size)]


def moves(development: Reals, vectors: Reals) -> Reals:
    """Return how far the smooth poses of one body lie from its pilot, `(frames, joints, 3)`, in units of the noise."""
    frames, joints = development.shape[:2]
    if frames < FEWEST * 3 * joints:
        return np.zeros_like(development)
    mean, poses = (x.reshape(frames, -1) for x in (development, vectors))
    change = np.zeros_like(poses)
    for axis in moving_axes(np.diff(mean, axis=0)).T:
        smoothed = penalised_column(poses @ axis, np.ones(frames))
        change += np.outer(smoothed - mean @ axis, axis)
    return change.reshape(frames, joints, 3)


def moving_axes(steps: Reals) -> Reals:
    """Principal axes of steps `(n, k)` along which there are more than still ones, as columns."""
    squares, axes = np.linalg.eigh(steps.T @ steps)
    return np.asarray(axes[:, squares > STILL])
