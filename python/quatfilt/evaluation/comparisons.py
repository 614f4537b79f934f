"""Three ways to filter orientations that Courty's section 3.2 sets aside, each with what is wrong with it.

Plain NumPy, for comparison with `orientation_filter`: the same mask, the same mirrored ends. N. Courty, "Bilateral human
motion filtering", EUSIPCO 2008.
"""

import numpy as np

from quatfilt._typing import Array
from quatfilt.evaluation.channels import Values
from quatfilt.filters.orientation_filter import orientation_filter
from quatfilt.rotations.continuity import continuous
from quatfilt.rotations.quaternion import conjugate, exp, log, multiply


def renormalised_average(q: Array, mask: Values, *, iterations: int = 1) -> Array:
    """Average the four components and make the result unit: the embedding space R⁴.

    It is a mean of chords and not of arcs. Where samples lie densely the two agree to third order of the angle from one to
    the next; where they do not, the average leans to the side where samples lie closer together.

    Parameters
    ----------
    q : ndarray, shape (frames, joints, 4)
        Unit quaternions.
    mask : ndarray, shape (2k + 1,)
        Weights, in any scale.
    iterations : int, default 1
        How often the filter is applied.

    Returns
    -------
    ndarray, shape of `q`
        Unit quaternions.
    """
    for _ in range(iterations):
        mean = _masked(continuous(q), mask)
        q = mean / np.linalg.norm(mean, axis=-1, keepdims=True)
    return q


def global_chart(q: Array, mask: Values, *, iterations: int = 1) -> Array:
    """Average in one chart for the whole signal, the logarithm at the identity (Johnstone and Williams).

    The path of continuous signs starts in the hemisphere of the identity. At its antipode −1, one whole turn, the logarithm
    has no value, and near it neighbouring rotations have logarithms far apart: their average is anywhere. A rotation of the
    coordinate frame moves a motion there.

    Parameters
    ----------
    q : ndarray, shape (frames, joints, 4)
        Unit quaternions.
    mask : ndarray, shape (2k + 1,)
        Weights, in any scale.
    iterations : int, default 1
        How often the filter is applied.

    Returns
    -------
    ndarray, shape of `q`
        Unit quaternions.
    """
    for _ in range(iterations):
        start = np.where(q[0, :, :1] < 0, -1.0, 1.0)
        q = exp(_masked(log(continuous(start * q)), mask))
    return q


def integrated_displacements(q: Array, mask: Values, *, iterations: int = 1) -> Array:
    """Filter the displacements from frame to frame and integrate them from the first frame on (Fang et al.).

    About one fixed axis that is the mean of the angles. Otherwise every displacement is a vector in a frame of its own, the
    mean of such vectors is not the displacement of any mean, and the integration adds up what is wrong: the result drifts.

    Parameters
    ----------
    q : ndarray, shape (frames, joints, 4)
        Unit quaternions.
    mask : ndarray, shape (2k + 1,)
        Weights, in any scale.
    iterations : int, default 1
        How often the filter is applied.

    Returns
    -------
    ndarray, shape of `q`
        Unit quaternions.
    """
    for _ in range(iterations):
        around = continuous(_mirrored(q, len(mask) // 2))
        turns = log(multiply(conjugate(around[:-1]), around[1:]))
        # Started where the filter without drift starts, so that the noise of the first frame does not count.
        path = [orientation_filter(q, mask)[:1]]
        for step in exp(_mean_of(turns, mask)):
            path.append(multiply(path[-1], step[None]))
        q = np.concatenate(path)
    return q


def _masked(x: Array, mask: Values) -> Array:
    """Weighted means along time; time turns round at the end frames."""
    return _mean_of(_mirrored(x, len(mask) // 2), mask)


def _mirrored(x: Array, padding: int) -> Array:
    return x[np.pad(np.arange(len(x)), padding, mode="reflect")]


def _mean_of(x: Array, mask: Values) -> Array:
    """Weighted means of as many frames as the mask has, wherever it fits."""
    frames = len(x) - len(mask) + 1
    result = np.zeros((frames, *x.shape[1:]))
    for offset, weight in enumerate(mask / np.sum(mask)):
        result += weight * x[offset : offset + frames]
    return result


__all__ = ["global_chart", "integrated_displacements", "renormalised_average"]
