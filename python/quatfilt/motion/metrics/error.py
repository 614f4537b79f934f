"""Errors against a reference."""

import math
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from quatfilt import _validation
from quatfilt.motion.metrics import _samples
from quatfilt.motion.metrics._samples import PER, PER_SAMPLE, Per, PerSample, Values

if TYPE_CHECKING:
    from quatfilt.motion.motion import Motion


def psnr(
    reference: ArrayLike, estimate: ArrayLike, *, per: Per = "clip", scalar_first: bool = True
) -> float | Values:
    """Peak signal-to-noise ratio of rotations.

    ``20 log10 π − 10 log10 (mean of the squared components of 2 log(a⁻¹b))``: the peak is half a turn, and the mean is
    over frames, joints and the three components of the rotation vector of the error.

    Parameters
    ----------
    reference, estimate : array_like, shape (frames, joints, 4) or (frames, 4)
        Unit quaternions; signs do not matter. Samples that are missing in either are left out.
    per : {"clip", "joint"}
        One value, or one for each joint.
    scalar_first : bool, default True
        Whether quaternions are ``(w, x, y, z)``; False for SciPy's ``(x, y, z, w)``.

    Returns
    -------
    float or ndarray, shape (joints,), decibels
        Infinite if nothing differs, NaN if there is nothing to compare.

    Raises
    ------
    ValueError
        If the shapes differ, or samples are neither missing nor near unit length.

    References
    ----------
    C. J. Dean and J. P. Lewis, *Non-local Pose Means for Denoising Motion Capture Data*, 2017, Table I.

    Examples
    --------
    >>> import numpy as np, quatfilt as qf
    >>> still = np.tile([1.0, 0.0, 0.0, 0.0], (100, 1))
    >>> turned = qf.exp(np.full((100, 3), np.radians(1.8) / 2))  # each component: a hundredth of the peak
    >>> round(qf.metrics.psnr(still, turned), 6)
    40.0
    """
    how = _validation.choice(per, "per", PER)
    truth, other, shape = _samples.pair(reference, estimate, scalar_first=scalar_first)
    squares = _samples.turns(truth, other) ** 2
    error = _samples.reduced(np.mean(squares, axis=-1), how, shape)
    with np.errstate(divide="ignore"):
        result = 20 * math.log10(math.pi) - 10 * np.log10(error)
    return float(result) if how == "clip" else np.asarray(result)


def mse(
    reference: ArrayLike, estimate: ArrayLike, *, per: PerSample = "clip", scalar_first: bool = True
) -> float | Values:
    """Mean squared error on the sphere of unit quaternions.

    The mean of ``‖log(a⁻¹b)‖²``: the squared half of the rotation angle, as in Courty's bilateral filter (who divides
    by the number of samples less one).

    Parameters
    ----------
    reference, estimate : array_like, shape (frames, joints, 4) or (frames, 4)
        Unit quaternions; signs do not matter. Samples that are missing in either are left out.
    per : {"clip", "joint", "sample"}
        One value, one for each joint, or the square of every sample, NaN where it is missing.
    scalar_first : bool, default True
        Whether quaternions are ``(w, x, y, z)``; False for SciPy's ``(x, y, z, w)``.

    Returns
    -------
    float or ndarray, radians squared
        NaN if there is nothing to compare.

    Raises
    ------
    ValueError
        If the shapes differ, or samples are neither missing nor near unit length.

    References
    ----------
    N. Courty, *Bilateral human motion filtering*, 2008.

    Examples
    --------
    >>> import quatfilt as qf
    >>> round(qf.metrics.mse([[1.0, 0.0, 0.0, 0.0]], qf.exp([[0.0, 0.2, 0.0]])), 6)
    0.04
    """
    how = _validation.choice(per, "per", PER_SAMPLE)
    truth, other, shape = _samples.pair(reference, estimate, scalar_first=scalar_first)
    squares = np.sum((_samples.turns(truth, other) / 2) ** 2, axis=-1)
    return _samples.reduced(squares, how, shape)


def angle_error(
    reference: ArrayLike, estimate: ArrayLike, *, per: PerSample = "clip", scalar_first: bool = True
) -> float | Values:
    """Rotation angle between reference and estimate.

    Parameters
    ----------
    reference, estimate : array_like, shape (frames, joints, 4) or (frames, 4)
        Unit quaternions; signs do not matter. Samples that are missing in either are left out.
    per : {"clip", "joint", "sample"}
        The mean of all samples, the mean for each joint, or the angle of every sample, NaN where it is missing.
    scalar_first : bool, default True
        Whether quaternions are ``(w, x, y, z)``; False for SciPy's ``(x, y, z, w)``.

    Returns
    -------
    float or ndarray, degrees
        NaN if there is nothing to compare.

    Raises
    ------
    ValueError
        If the shapes differ, or samples are neither missing nor near unit length.

    Examples
    --------
    >>> import numpy as np, quatfilt as qf
    >>> still = np.tile([1.0, 0.0, 0.0, 0.0], (2, 1))
    >>> turned = qf.exp([[0.0, 0.0, 0.0], [0.0, np.radians(15), 0.0]])
    >>> round(qf.metrics.angle_error(still, turned), 6)
    15.0
    >>> qf.metrics.angle_error(still, turned, per="sample").round(6)
    array([ 0., 30.])
    """
    how = _validation.choice(per, "per", PER_SAMPLE)
    truth, other, shape = _samples.pair(reference, estimate, scalar_first=scalar_first)
    angles = np.degrees(np.linalg.norm(_samples.turns(truth, other), axis=-1))
    return _samples.reduced(angles, how, shape)


def position_error(reference: "Motion", motion: "Motion", *, per: PerSample = "clip") -> float | Values:
    """Distance between the positions of the joints.

    Parameters
    ----------
    reference, motion : Motion
        Motions of the same joints and frames, each with its own skeleton. Where a sample is missing, that joint's
        descendants have no position either; they are left out.
    per : {"clip", "joint", "sample"}
        The mean of all samples, the mean for each joint, or the distance of every sample, NaN where it is missing.

    Returns
    -------
    float or ndarray, centimetres
        NaN if there is nothing to compare. A skeleton whose unit is not known counts as centimetres.

    Raises
    ------
    ValueError
        If the motions have other joints or frames.

    Examples
    --------
    >>> import quatfilt as qf
    >>> from quatfilt.evaluation.synthetic import walk
    >>> truth = walk(seconds=1)
    >>> lifted = truth.replace(translation=truth.translation + [0.0, 2.0, 0.0])
    >>> round(qf.metrics.position_error(truth, lifted), 6)
    2.0
    """
    how = _validation.choice(per, "per", PER_SAMPLE)
    names, found = tuple(reference.skeleton.names), tuple(motion.skeleton.names)
    if names != found:
        raise ValueError(
            f"motion: expected the reference's {len(names)} joints, got {_difference(names, found)}"
        )
    a = np.asarray(reference.positions(), np.float64) * reference.skeleton.centimetres_per_unit
    b = np.asarray(motion.positions(), np.float64) * motion.skeleton.centimetres_per_unit
    if a.shape != b.shape:
        raise ValueError(f"motion: expected the reference's {len(a)} frames, got {len(b)}")
    return _samples.reduced(np.linalg.norm(a - b, axis=-1), how, a.shape)


def _difference(names: tuple[str, ...], found: tuple[str, ...]) -> str:
    if len(names) != len(found):
        return f"{len(found)}"
    name, other = next(pair for pair in zip(names, found, strict=True) if pair[0] != pair[1])
    return f"{other!r} where {name!r} is"


__all__ = ["angle_error", "mse", "position_error", "psnr"]
