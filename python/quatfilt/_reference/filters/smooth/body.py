"""Smoothing along the principal axes of the whole body: joints that move together steady each other."""

import numpy as np

from quatfilt._reference._arrays import Reals
from quatfilt._reference.filters.development import developed_about, undevelop
from quatfilt._reference.filters.smooth.penalised import penalised_column
from quatfilt._reference.filters.smooth.smooth import principal_axes
from quatfilt._reference.rotations.quaternion import normalize

SHARE = 0.5
"""Share of the body's estimate beside the pilot. The one errs where joints are alike by chance, the other where they are not seen
together; their mean errs less than either."""


def smooth_body(q: Reals, pilot: Reals, confidence: Reals | None, noise: Reals) -> Reals:
    """Smooth all joints together along the principal axes of the body, and take the mean with the pilot.

    The vectors of all joints about the pilot, in units of their noise, make one vector of a pose; its axes are those of the pilot's
    steps from frame to frame. Each axis is smoothed as :func:`.smooth.smooth` smooths that of a joint.

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
    noisy = np.flatnonzero(noise > 0)
    if frames < 2 or len(noisy) == 0:
        return normalize(pilot)
    path, about = (normalize(x.astype(np.float64)) for x in (q, pilot))
    reference, development, vectors = developed_about(about, path)
    if confidence is not None:
        vectors = development + confidence[..., None] * (vectors - development)
    scale = noise[noisy, None]
    poses = (vectors[:, noisy] / scale).reshape(frames, -1)
    mean = (development[:, noisy] / scale).reshape(frames, -1)
    axes = principal_axes(np.diff(mean, axis=0))
    columns = poses @ axes
    smoothed = np.stack([penalised_column(column, np.ones(frames)) for column in columns.T], axis=1)
    moved = (smoothed @ axes.T).reshape(frames, len(noisy), 3) * scale
    result = development.copy()
    result[:, noisy] += SHARE * (moved - development[:, noisy])
    return undevelop(q, reference, development, result)
