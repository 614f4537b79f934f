"""Savitzky and Golay's filter: polynomials fitted to windows, on rotations about their reference path."""

import numpy as np

from quatfilt._reference._arrays import Reals
from quatfilt._reference.filters.development import (
    Columns,
    aligned,
    carried_about,
    filtered,
    reference_path_of_spins,
    undevelop,
)
from quatfilt._reference.motion.skeleton import rotate
from quatfilt._reference.rotations.quaternion import conjugate, normalize


def savgol(
    q: Reals,
    translation: Reals | None,
    confidence: Reals | None,
    reference_sigma: Reals,
    fit: Reals,
    values: Reals,
) -> tuple[Reals, Reals | None]:
    """Replace the vectors of :mod:`.development` by values of the polynomials that are fitted to the windows around them.

    Parameters
    ----------
    q : array (frames, joints, 4)
        Rotations without missing samples; at least as many frames as the window has, or less than two.
    translation : array (frames, 3) or None
        Positions of the root, filtered alike.
    confidence : array (frames, joints) or None
        From 0 to 1: how far samples are believed rather than their local mean.
    reference_sigma : array (joints,), frames
        Deviation of the mask that makes the reference path.
    fit : array (terms, window)
        Coefficients of the polynomial from the numbers in a window of an odd number of frames.
    values : array (window, terms)
        Values of the polynomial at the frames of the window, from its coefficients.

    Returns
    -------
    rotations : array (frames, joints, 4)
        Unit quaternions, continuous in sign from the hemisphere of the input's first frame.
    translation : array (frames, 3) or None
    """

    def smooth(columns: Columns, _joint: int) -> Reals:
        return fitted(columns.pulled(), fit, values)

    return filtered(q, translation, confidence, reference_sigma, smooth)


def savgol_derivative(
    q: Reals, confidence: Reals | None, reference_sigma: Reals, fit: Reals, values: Reals, derivatives: Reals
) -> Reals:
    """Differentiate rotations: angular velocity or acceleration in the frame of the body.

    Where a path runs beside its reference, the derivative of its vector is seen from the reference, and not from the path. So
    the rotations are smoothed first, as by :func:`savgol`, and developed again about the result.

    Parameters
    ----------
    q, confidence, reference_sigma, fit, values
        As for :func:`savgol`; at least as many frames as the window has.
    derivatives : array (window, terms), 1/s or 1/s²
        A derivative of the polynomial at the frames of the window, from its coefficients.

    Returns
    -------
    array (frames, joints, 3), rad/s or rad/s²
    """
    path = aligned(normalize(q.astype(np.float64)), confidence, np.ones(q.shape[1]))
    reference = reference_path_of_spins(path, confidence, reference_sigma)
    frame, development, vectors = carried_about(reference, path)
    moved = fitted_joints(development, vectors, confidence, fit, values)
    beside = rotate(conjugate(frame), moved - development)
    smooth = undevelop(path, reference, np.zeros_like(beside), beside)
    frame, development, vectors = carried_about(smooth, path)
    derivative = fitted_joints(development, vectors, confidence, fit, derivatives)
    return rotate(conjugate(frame), derivative).astype(q.dtype)


def fitted_joints(
    development: Reals, vectors: Reals, confidence: Reals | None, fit: Reals, values: Reals
) -> Reals:
    """Evaluate the polynomials of the windows around each frame, for vectors `(frames, joints, 3)`."""
    result = np.empty_like(vectors)
    for joint in range(vectors.shape[1]):
        trust = None if confidence is None else confidence[:, joint].astype(np.float64)
        columns = Columns(vectors[:, joint], development[:, joint], trust)
        result[:, joint] = fitted(columns.pulled(), fit, values)
    return result


def fitted(x: Reals, fit: Reals, values: Reals) -> Reals:
    """Evaluate the polynomials of the windows around each frame, for columns `(frames, 3)`.

    The first frames and the last, which have no window around them, take what the first and the last polynomial have there.
    """
    window = fit.shape[1]
    radius = window // 2
    mask = values[radius] @ fit
    result = np.zeros_like(x)
    inner = len(x) - 2 * radius
    for j in range(window):
        result[radius : radius + inner] += mask[j] * x[j : j + inner]
    result[:radius] = values[:radius] @ (fit @ x[:window])
    result[radius + inner :] = values[radius + 1 :] @ (fit @ x[-window:])
    return result
