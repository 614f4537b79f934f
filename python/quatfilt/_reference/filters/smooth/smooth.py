"""Automatic smoothing of rotations: principal axes of each joint, and penalised least squares along each of them."""

import numpy as np

from quatfilt._reference._arrays import Reals
from quatfilt._reference.filters.columns import gaussian_mask, weighted_mean
from quatfilt._reference.filters.development import (
    aligned,
    clarity,
    developed_about,
    reference_path,
    undevelop,
)
from quatfilt._reference.filters.smooth.penalised import penalised_column
from quatfilt._reference.rotations.quaternion import exp, multiply, normalize

REFERENCE_SIGMA = 10.0
"""Frames: deviation of the Gaussian mask that makes the first reference path, without noise; heavy noise asks for more."""

ROUNDS = 2
"""How often the clip is smoothed about a reference path. The second is the result of the first: nearer to the truth, it bends
the noise less and shows the axes better."""

LEAST_NOISE = 1e-100
"""Whatever is measured in less noise has squares that may be infinite; such noise counts as none."""

LEAST_WEIGHT = 0.01
"""Weight of a sample without confidence. The line between its neighbours that stands for it keeps the smoother from swinging
far out in a long gap, and beyond the end of the clip."""


def smooth(
    q: Reals, translation: Reals | None, confidence: Reals | None, noise: Reals, translation_noise: float
) -> tuple[Reals, Reals | None]:
    """Smooth each joint along its principal axes by as much as its noise asks for.

    Parameters
    ----------
    q : array (frames, joints, 4)
        Rotations without missing samples.
    translation : array (frames, 3) or None
        Positions of the root, smoothed along their own principal axes.
    confidence : array (frames, joints) or None
        Weights of the samples, from 0 to 1; those of joint 0 are the translation's too.
    noise : array (joints,), radians
        Deviation of the noise per component of the rotation vector. A joint with 0 stays as it is.
    translation_noise : float
        Deviation of the noise per coordinate of the translation; with 0 it stays as it is.

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
    clear = clarity(noise)
    path = aligned(normalize(q.astype(np.float64)), confidence, clear)
    reference = reference_path(path, confidence, REFERENCE_SIGMA / clear)
    for _ in range(ROUNDS):
        reference, development, vectors = developed_about(reference, path)
        moved = np.stack(
            [
                smoothed(vectors[:, j], development[:, j], weights[:, j], float(noise[j]))
                for j in range(joints)
            ],
            axis=1,
        )
        reference = normalize(multiply(reference, exp((moved - development) / 2)))
    rotations = undevelop(q, reference, np.zeros_like(moved), np.zeros_like(moved))
    if translation is None:
        return rotations, None
    positions = translation.astype(np.float64)
    mean = weighted_mean(
        positions,
        None if confidence is None else weights[:, 0],
        gaussian_mask(REFERENCE_SIGMA),
        "mirror",
    )
    for _ in range(ROUNDS):
        mean = smoothed(positions, mean, weights[:, 0], translation_noise)
    return rotations, mean.astype(translation.dtype)


def smoothed(vectors: Reals, mean: Reals, weights: Reals, noise: float) -> Reals:
    """Smooth vectors `(frames, 3)` along the principal axes of the steps of their local mean."""
    if noise < LEAST_NOISE:
        return vectors
    axes = principal_axes(np.diff(mean, axis=0))
    columns = vectors @ axes / noise
    trust = np.maximum(weights, LEAST_WEIGHT)
    result = np.stack([penalised_column(column, trust) for column in columns.T], axis=1)
    return np.asarray(result @ axes.T * noise)


def principal_axes(steps: Reals) -> Reals:
    """Orthonormal axes of steps `(n, k)`, as columns: the eigenvectors of `Σ s sᵀ`."""
    return np.asarray(np.linalg.eigh(steps.T @ steps)[1])
