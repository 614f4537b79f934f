"""Smoothing along the principal axes of the whole body: joints that move together steady each other."""

import numpy as np

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


def smooth_body(q: Reals, pilot: Reals, confidence: Reals | None, noise: Reals) -> Reals:
    """Smooth all joints together along the principal axes of the body, and take the mean with the pilot.

    The vectors of all joints about the pilot, in units of their noise, make one vector of a pose; its axes are those of the pilot's
    steps from frame to frame. Each axis along which the pilot moves is smoothed as :func:`.smooth.smooth` smooths that of a joint.
    In clips of fewer than `FEWEST` frames per axis the pilot stays as it is.

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
    frames = len(q)
    noisy = np.flatnonzero(noise >= LEAST_NOISE)
    if len(noisy) == 0 or frames < FEWEST * 3 * len(noisy):
        still = np.zeros((*q.shape[:2], 3))
        return undevelop(q, normalize(pilot.astype(np.float64)), still, still)
    path, about = (normalize(x.astype(np.float64)) for x in (q, pilot))
    reference, development, vectors = developed_about(about, path)
    if confidence is not None:
        vectors = development + confidence[..., None] * (vectors - development)
    scale = noise[noisy, None]
    poses = (vectors[:, noisy] / scale).reshape(frames, -1)
    mean = (development[:, noisy] / scale).reshape(frames, -1)
    axes = moving_axes(np.diff(mean, axis=0))
    change = np.zeros_like(poses)
    for axis in axes.T:
        smoothed = penalised_column(poses @ axis, np.ones(frames))
        change += np.outer(smoothed - mean @ axis, axis)
    result = development.copy()
    result[:, noisy] += SHARE * change.reshape(frames, len(noisy), 3) * scale
    return undevelop(q, reference, development, result)


def moving_axes(steps: Reals) -> Reals:
    """Principal axes of steps `(n, k)` along which there are more than still ones, as columns."""
    squares, axes = np.linalg.eigh(steps.T @ steps)
    return np.asarray(axes[:, squares > STILL])
