"""A low pass for motion whose noise is temporally correlated: third differences are penalised."""

import numpy as np

from quatfilt._reference._arrays import Reals
from quatfilt._reference.filters.development import (
    aligned,
    carried_about,
    reference_path_of_spins,
    undevelop,
)
from quatfilt._reference.filters.smooth.penalised import penalised
from quatfilt._reference.motion.skeleton import rotate
from quatfilt._reference.rotations.quaternion import conjugate, exp, multiply, normalize

ORDER = 3
"""Of the differences. The gain is 1/(1 + r⁶), r = sin(π f/fps) / sin(π f_c/fps); parabolas stay as they are."""

ROUNDS = 2
"""How often the clip is filtered about a reference path; the second is the result of the first."""

LEAST_WEIGHT = 0.01
"""Weight of a sample without confidence."""


def low_pass(
    q: Reals, translation: Reals | None, confidence: Reals | None, reference_sigma: Reals, softness: float
) -> tuple[Reals, Reals | None]:
    """Filter rotations, and a translation, by penalised least squares of third differences.

    Parameters
    ----------
    q : array (frames, joints, 4)
        Rotations without missing samples.
    translation : array (frames, 3) or None
        Positions of the root.
    confidence : array (frames, joints) or None
        Weights of the samples, from 0 to 1; those of joint 0 are the translation's too.
    reference_sigma : array (joints,), frames
        Deviation of the Gaussian mask that makes the first reference path.
    softness : float
        `(2 sin(π f_c / fps))⁶` for the cut-off `f_c`.

    Returns
    -------
    rotations : array (frames, joints, 4)
        Unit quaternions, continuous in sign from the hemisphere of the input's first frame.
    translation : array (frames, 3) or None
    """
    frames, joints = q.shape[:2]
    if frames < 2 or joints == 0:
        return normalize(q), None if translation is None else translation.copy()
    weights = np.ones((frames, joints)) if confidence is None else confidence.astype(np.float64)
    path = aligned(normalize(q.astype(np.float64)), confidence, np.ones(joints))
    reference = reference_path_of_spins(path, confidence, reference_sigma)
    for _ in range(ROUNDS):
        frame, development, vectors = carried_about(reference, path)
        moved = np.stack([smoothed(vectors[:, j], weights[:, j], softness) for j in range(joints)], axis=1)
        reference = normalize(multiply(reference, exp(rotate(conjugate(frame), moved - development) / 2)))
    still = np.zeros((frames, joints, 3))
    rotations = undevelop(q, reference, still, still)
    if translation is None:
        return rotations, None
    return rotations, smoothed(translation.astype(np.float64), weights[:, 0], softness).astype(
        translation.dtype
    )


def smoothed(vectors: Reals, weights: Reals, softness: float) -> Reals:
    """Smooth the columns of vectors `(frames, 3)`."""
    rows = len(vectors) - ORDER
    if rows < 1:
        return vectors
    trust = np.maximum(weights, LEAST_WEIGHT)
    soft = np.full(rows, softness)
    return np.stack([penalised(column, trust, soft, ORDER) for column in vectors.T], axis=1)
