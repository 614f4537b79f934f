"""Angular velocity and its changes: what is left of the noise, and what is left of the motion."""

import numpy as np
from numpy.typing import ArrayLike

from quatfilt import _validation
from quatfilt.motion.metrics import _samples
from quatfilt.motion.metrics._samples import PER, Per, Values

_AT_REST = 1e-6
"""Radians per frame: a joint that never turns faster is fixed, and moves by the rounding of its file alone."""

_PEAK = 95.0
"""Percentile of the angular speed that counts as its peak."""


def jerk(q: ArrayLike, *, fps: float = 1.0, per: Per = "clip", scalar_first: bool = True) -> float | Values:
    """Mean length of the rotational jerk, the third derivative of the motion: how rough it is.

    From frame to frame ``ω_t = 2 log(q_t⁻¹ q_{t+1})`` is the angular velocity in the frame of the joint, and the jerk is
    its second difference in time. A smoother that flattens a motion lowers it below the truth's.

    Parameters
    ----------
    q : array_like, shape (frames, joints, 4) or (frames, 4)
        Unit quaternions; signs do not matter. Differences that touch missing samples are left out.
    fps : float, hertz, default 1.0
        Frame rate; without it the unit of time is the frame.
    per : {"clip", "joint"}
        One value, or one for each joint.
    scalar_first : bool, default True
        Whether quaternions are ``(w, x, y, z)``; False for SciPy's ``(x, y, z, w)``.

    Returns
    -------
    float or ndarray, shape (joints,), degrees per second cubed
        NaN where there are no four frames in a row.

    Raises
    ------
    ValueError
        If `q` has another shape or holds samples that are neither missing nor near unit length, or if `fps` is not
        above 0.

    Examples
    --------
    >>> import numpy as np, quatfilt as qf
    >>> seconds = np.arange(50) / 10
    >>> angle = np.radians(seconds**3)  # its third derivative is 6 degrees per second cubed
    >>> q = qf.exp(np.stack([angle / 2, 0 * angle, 0 * angle], axis=-1))
    >>> round(qf.metrics.jerk(q, fps=10), 6)
    6.0
    """
    how = _validation.choice(per, "per", PER)
    rate = _validation.number(fps, "fps", above=0)
    rotations, shape = _samples.clip(q, "q", scalar_first=scalar_first)
    return _samples.reduced(jerks(steps(rotations), rate), how, shape)


def peak_velocity_kept(
    reference: ArrayLike, estimate: ArrayLike, *, per: Per = "clip", scalar_first: bool = True
) -> float | Values:
    """Share of the peak angular speed that an estimate keeps.

    For each joint the 95th percentile of the angular speed, estimate divided by reference. Good is 1; below, fast motion
    is flattened; above, noise is left.

    Parameters
    ----------
    reference, estimate : array_like, shape (frames, joints, 4) or (frames, 4)
        Unit quaternions; signs do not matter. Steps that touch a sample that is missing in either are left out.
    per : {"clip", "joint"}
        The mean over the joints, or the value of each joint.
    scalar_first : bool, default True
        Whether quaternions are ``(w, x, y, z)``; False for SciPy's ``(x, y, z, w)``.

    Returns
    -------
    float or ndarray, shape (joints,)
        Joints that do not move in the reference are NaN and left out of the mean.

    Raises
    ------
    ValueError
        If the shapes differ, or samples are neither missing nor near unit length.

    Examples
    --------
    >>> import numpy as np, quatfilt as qf
    >>> wave = np.sin(np.linspace(0, 20, 400))[:, None] * [0.4, 0.0, 0.0]
    >>> flattened = 0.8 * wave
    >>> round(qf.metrics.peak_velocity_kept(qf.exp(wave), qf.exp(flattened)), 6)
    0.8
    """
    how = _validation.choice(per, "per", PER)
    truth, other, shape = _samples.pair(reference, estimate, scalar_first=scalar_first)
    kept = peaks_kept(steps(truth), steps(other))
    return float(_samples.mean(kept)) if how == "clip" else kept.reshape(shape[1:-1])


def steps(rotations: Values) -> Values:
    """Rotation vectors from each frame to the next, ``(frames − 1, joints, 3)``, in radians."""
    return _samples.turns(rotations[:-1], rotations[1:])


def jerks(turns: Values, fps: float) -> Values:
    """Lengths of the rotational jerk, ``(frames − 3, joints)``, in degrees per second cubed, of `steps`."""
    return np.asarray(np.degrees(np.linalg.norm(np.diff(turns, n=2, axis=0), axis=-1)) * fps**3)


def peaks_kept(reference: Values, estimate: Values) -> Values:
    """Share of the peak angular speed of each joint that is kept, ``(joints,)``, from the `steps` of both."""
    speed, found = (np.linalg.norm(turns, axis=-1) for turns in (reference, estimate))
    missing = np.isnan(speed) | np.isnan(found)
    peak = _samples.percentile(np.where(missing, np.nan, speed), _PEAK)
    peak[peak <= _AT_REST] = np.nan
    return np.asarray(_samples.percentile(np.where(missing, np.nan, found), _PEAK) / peak)


__all__ = ["jerk", "jerks", "peak_velocity_kept", "peaks_kept", "steps"]
