"""The 1€ filter: a low pass whose cutoff grows with the speed.

G. Casiez, N. Roussel and D. Vogel, *1€ Filter: A Simple Speed-based Low-pass Filter for Noisy Input in Interactive
Systems*, CHI 2012.
"""

import numpy as np

from quatfilt._reference._arrays import Reals
from quatfilt._reference.filters.displacements import displacement_between, moved
from quatfilt._reference.filters.nonlocal_pose_means.nonlocal_pose_means import in_hemisphere_of
from quatfilt._reference.rotations.quaternion import norm, normalize


def one_euro(
    q: Reals,
    translation: Reals | None,
    confidence: Reals | None,
    min_cutoff: Reals,
    beta: Reals,
    derivative_cutoff: Reals,
) -> tuple[Reals, Reals | None]:
    """Filter rotations forward in time.

    With the sample `y` before, `n` frames ago, its result `x`, and the share `α(f) = 1 / (1 + 1 / (2π f n))` of a cutoff
    `f`, a sample `z` of confidence `c` leads to

        `ω ← ω + c α(f_d) (2 log(y⁻¹ z) / n − ω)`
        `f = f_min + β |ω|`
        `x ← x exp(c α(f) log(x⁻¹ z))`.

    The first sample is its own result, with `ω = 0`. A sample without confidence is none: the result stays. (The paper's
    algorithm has `x⁻¹ z` in the first line: the speed then grows with the frame rate, by what the result lags behind.)

    Parameters
    ----------
    q : array (frames, joints, 4)
        Rotations without missing samples.
    translation : array (frames, 3) or None
        Positions of the root, which move by the same shares as joint 0.
    confidence : array (frames, joints) or None
        From 0 to 1. None: 1 everywhere.
    min_cutoff : array (joints,), 1 / frame
        Cutoff `f_min` at rest; may be infinite.
    beta : array (joints,), 1 / radian
        How fast the cutoff grows with the speed.
    derivative_cutoff : array (joints,), 1 / frame
        Cutoff `f_d` of the velocity; may be infinite.

    Returns
    -------
    rotations : array (frames, joints, 4)
        Unit quaternions, continuous in sign from the hemisphere of the input's first frame. Before a joint's first
        sample with confidence its pose is the one there; a joint without one comes back as it is.
    translation : array (frames, 3) or None
    """
    frames, joints = q.shape[:2]
    if frames < 2 or joints == 0:
        return normalize(q), None if translation is None else translation.copy()
    samples = normalize(q.astype(np.float64))
    trust = np.ones((frames, joints)) if confidence is None else confidence.astype(np.float64)
    result = samples.copy()
    position = None if translation is None else translation.astype(np.float64)
    for joint in range(joints):
        measured = np.flatnonzero(trust[:, joint] > 0)
        if not len(measured):
            continue
        before = measured[0]
        x, velocity = samples[before, joint], np.zeros(3)
        result[:before, joint] = x
        if joint == 0 and position is not None:
            position[:before] = position[before]
        for frame in range(before + 1, frames):
            c = trust[frame, joint]
            share = 0.0
            if c > 0:
                elapsed = frame - before
                turned = displacement_between(samples[before, joint], samples[frame, joint]) / elapsed
                velocity = velocity + c * low_pass(derivative_cutoff[joint], elapsed) * (turned - velocity)
                share = c * low_pass(min_cutoff[joint] + beta[joint] * norm(velocity), elapsed)
                x = moved(x, share * displacement_between(x, samples[frame, joint]))
                before = frame
            result[frame, joint] = x
            if joint == 0 and position is not None:
                position[frame] = position[frame - 1] + share * (position[frame] - position[frame - 1])
    rotations = in_hemisphere_of(normalize(result), q).astype(q.dtype)
    return rotations, None if translation is None or position is None else position.astype(translation.dtype)


def low_pass(cutoff: float, elapsed: float) -> float:
    """Return the share of a sample in a low pass of first order, `elapsed` frames after the one before."""
    return 1 / (1 + 1 / (2 * np.pi * cutoff * elapsed))
