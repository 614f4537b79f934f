"""The filter of Savitzky and Golay."""

from typing import Any, cast

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import ArrayLike, NDArray

from quatfilt import _validation
from quatfilt._backend import ops
from quatfilt._typing import Array
from quatfilt.filters import _development, _spans

_HIGHEST_ORDER = 20

_REFERENCE = 1 / 8
"""Deviation of the reference path's mask in windows."""


def savgol(
    q: ArrayLike,
    *,
    window_length: int,
    polyorder: int = 3,
    deriv: int = 0,
    fps: float = 1.0,
    confidence: ArrayLike | None = None,
    gaps: _spans.Gaps = "fill",
    max_gap: float | None = None,
    scalar_first: bool = True,
) -> Array:
    """Smooth rotations by fitted polynomials, or differentiate them.

    It is ``scipy.signal.savgol_filter`` with ``mode="interp"``, applied to rotations as vectors about a smooth reference
    path, see `gaussian`: to the window around each frame a polynomial is fitted, and its value, or its derivative, at the
    frame is the result. Towards the ends, the first window and the last one serve all of their frames.

    Parameters
    ----------
    q : array_like, shape (frames, joints, 4) or (frames, 4)
        Unit quaternions along time. NaN or four zeros are missing samples.
    window_length : int, frames
        An odd number, and not more than the clip has frames.
    polyorder : int, default 3
        Degree of the polynomials, below `window_length`; at least `deriv`, and at most 20.
    deriv : {0, 1, 2}, default 0
        0 for rotations; 1 for the angular velocity and 2 for the angular acceleration, in the frame of the body.
    fps : float, hertz, default 1.0
        Frame rate; without it, derivatives are per frame and `max_gap` counts frames.
    confidence : array_like or None, shape (frames,) or (frames, joints), default None
        How far samples are believed, from 0 to 1, rather than the weighted mean of those near them; NaN counts as 0.
        Samples that were filled in have 0.
    gaps : {"fill", "keep", "raise"}, default "fill"
        What becomes of missing samples. With ``"fill"`` they are estimated from their neighbours; with ``"keep"`` they are
        missing again in the result.
    max_gap : float or None, seconds, default None
        The longest gap that is filled; None for any. Longer ones stay missing, and their sides are filtered apart, with a
        shorter window where need be; derivatives of sides that are too short for any are NaN.
    scalar_first : bool, default True
        Whether quaternions are ``(w, x, y, z)``; False for SciPy's ``(x, y, z, w)``.

    Returns
    -------
    ndarray, shape of `q`, or (frames, joints, 3) or (frames, 3) for derivatives
        Unit quaternions, continuous in sign from the hemisphere of the first frame on; or rad/s, or rad/s².

    Raises
    ------
    ValueError, TypeError
        If an argument has another shape, type or range than stated; the message names it.

    See Also
    --------
    gaussian, butterworth : Low passes whose width is a time or a frequency.

    Notes
    -----
    The angular velocity is that of a path in the frame that it carries along, ``2·log(q_t⁻¹ q_{t+1})·fps`` in the limit. It
    is taken of the smoothed rotations. A steady turn about a fixed axis has it exactly; where the axis turns, the velocity lacks
    what falls with the fourth power of `fps`, and the acceleration what falls with its square.

    Cost: ``frames · joints · window_length``.

    References
    ----------
    .. [1] A. Savitzky and M. J. E. Golay, "Smoothing and differentiation of data by simplified least squares procedures",
       Analytical Chemistry 36, 1964.

    Examples
    --------
    >>> import numpy as np, quatfilt as qf
    >>> t = np.arange(240) / 120
    >>> turn = qf.exp(t[:, None] * [0.0, 0.0, 1.0])
    >>> noisy = qf.add_gaussian_noise(turn, sigma=0.001, rng=0)
    >>> velocity = qf.savgol(noisy, window_length=31, polyorder=2, deriv=1, fps=120)
    >>> bool(np.abs(velocity - [0, 0, 2]).max() < 0.05)
    True
    """
    options: dict[str, Any] = {
        "window_length": window_length,
        "polyorder": polyorder,
        "fps": fps,
        "confidence": confidence,
        "gaps": gaps,
        "max_gap": max_gap,
        "scalar_first": scalar_first,
    }
    order = _validation.integer(deriv, "deriv", at_least=0, at_most=2)
    return _derivative(q, order, **options) if order else with_translation(q, None, deriv=0, **options)[0]


def with_translation(
    q: ArrayLike,
    translation: Array | None,
    *,
    window_length: int,
    polyorder: int,
    deriv: int,
    fps: float,
    **missing: Any,
) -> tuple[Array, Array | None]:
    """Filter as `savgol` does, and a translation ``(frames, 3)`` alike; not for derivatives."""
    clip = _spans.prepare(q, fps=fps, **missing)
    _validation.integer(deriv, "deriv", at_least=0, at_most=0)
    window, degree = _options(clip, window_length, polyorder, 0)

    def run(
        rotations: Array, along: Array | None, trust: Array | None, there: NDArray[np.intp]
    ) -> tuple[Array, Array | None]:
        short = _odd_at_most(window, len(rotations))
        fit, values = _polynomials(short, degree, 0, 1.0)
        result = ops().savgol(rotations, along, trust, _reference(short, len(there)), fit, values)
        return cast("tuple[Array, Array | None]", result)

    return _development.filtered(clip, translation, run)


def _derivative(
    q: ArrayLike, order: int, *, window_length: int, polyorder: int, fps: float, **missing: Any
) -> Array:
    """Angular velocity or acceleration, as `savgol` returns it."""
    clip = _spans.prepare(q, fps=fps, **missing)
    rate = _validation.number(fps, "fps", above=0)
    window, degree = _options(clip, window_length, polyorder, order)
    frames, joints = clip.rotations.shape[:2]
    result = np.full((frames, joints, 3), np.nan, clip.rotations.dtype)
    for span in clip.spans if frames else ():
        part, trust = clip.part(span)
        short = _odd_at_most(window, len(part))
        if short > order:
            fit, values = _polynomials(short, degree, 0, rate)
            derivatives = _polynomials(short, degree, order, rate)[1]
            result[span.frames, span.joints] = ops().savgol_derivative(
                part,
                None if trust is None else np.ascontiguousarray(trust),
                _reference(short, len(span.joints)),
                fit,
                values,
                derivatives,
            )
    if clip.gaps == "keep":
        result[clip.missing] = np.nan
    return result.reshape(*clip.shape[:-1], 3)


def _options(clip: _spans.Clip, window_length: int, polyorder: int, order: int) -> tuple[int, int]:
    """Check what a clip is filtered with."""
    window = _validation.odd(window_length, "window_length")
    highest = min(window - 1, _HIGHEST_ORDER)
    degree = _validation.integer(polyorder, "polyorder", at_least=order, at_most=highest)
    frames = len(clip.rotations)
    if window > frames and not (clip.unchanged and order == 0) and frames:
        raise ValueError(
            f"window_length: expected at most as many as the clip's {frames} frames, got {window}"
        )
    return window, degree


def _odd_at_most(window: int, frames: int) -> int:
    return min(window, frames - 1 + frames % 2)


def _reference(window: int, joints: int) -> NDArray[np.float64]:
    return _development.reference_sigma(np.full(joints, _REFERENCE * window))


def _polynomials(
    window: int, degree: int, order: int, fps: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the coefficients of fitted polynomials from numbers in a window, and a derivative's values from them.

    The polynomials are sums of Legendre's, on a window from −1 to 1.
    """
    degree = min(degree, window - 1)
    radius = max(window // 2, 1)
    place = np.arange(-(window // 2), window // 2 + 1) / radius
    terms = legendre.legvander(place, degree)
    derivatives = legendre.legval(place, legendre.legder(np.eye(degree + 1), order)).T
    values = np.zeros((window, degree + 1)) + derivatives * (fps / radius) ** order
    fit = np.asarray(np.linalg.pinv(terms), np.float64)
    return fit, np.ascontiguousarray(values)


__all__ = ["savgol", "with_translation"]
