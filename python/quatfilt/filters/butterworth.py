"""The Butterworth filter."""

from typing import Any, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from quatfilt import _validation
from quatfilt._backend import ops
from quatfilt._typing import Array, PerJoint
from quatfilt.filters import _development, _spans

_HIGHEST_ORDER = 20

_REFERENCE = 0.13
"""Deviation of a Gaussian in periods of the cutoff frequency: there it leaves about what this filter leaves."""


def butterworth(
    q: ArrayLike,
    *,
    cutoff: PerJoint,
    fps: float = 1.0,
    order: int = 4,
    confidence: ArrayLike | None = None,
    gaps: _spans.Gaps = "fill",
    max_gap: float | None = None,
    scalar_first: bool = True,
) -> Array:
    """Smooth rotations with a Butterworth low pass that runs forwards and backwards.

    It is ``scipy.signal.butter`` with ``scipy.signal.sosfiltfilt``, applied to rotations as vectors about a smooth reference
    path, see `gaussian`: a joint may turn as far as it likes, and about one fixed axis the unrolled angles are filtered.

    Parameters
    ----------
    q : array_like, shape (frames, joints, 4) or (frames, 4)
        Unit quaternions along time. NaN or four zeros are missing samples.
    cutoff : float or array_like (joints,), hertz
        Frequency of which one run leaves ``1/√2`` and both together one half (−6 dB); above 0 and below ``fps / 2``.
    fps : float, hertz, default 1.0
        Frame rate; without it, `cutoff` counts periods in a frame and `max_gap` frames.
    order : int, default 4
        Order of the filter that runs once in either direction; the two runs together have twice the order. From 1 to 20.
    confidence : array_like or None, shape (frames,) or (frames, joints), default None
        How far samples are believed, from 0 to 1, rather than the weighted mean of those near them; NaN counts as 0.
        Samples that were filled in have 0.
    gaps : {"fill", "keep", "raise"}, default "fill"
        What becomes of missing samples. With ``"fill"`` they are estimated from their neighbours; with ``"keep"`` they are
        missing again in the result.
    max_gap : float or None, seconds, default None
        The longest gap that is filled; None for any. Longer ones stay missing, and their sides are filtered apart.
    scalar_first : bool, default True
        Whether quaternions are ``(w, x, y, z)``; False for SciPy's ``(x, y, z, w)``.

    Returns
    -------
    ndarray, shape of `q`
        Unit quaternions, continuous in sign from the hemisphere of the first frame on. Nothing is delayed.

    Raises
    ------
    ValueError, TypeError
        If an argument has another shape, type or range than stated; the message names it.

    See Also
    --------
    gaussian : A softer edge, and no overshoot.

    Notes
    -----
    As in SciPy, the vectors go on beyond the ends of the clip turned about their end points, by three times as many frames
    as the filter has coefficients. SciPy refuses clips that are not longer than that; here the continuation is then as long
    as the clip allows. It counts frames, so that within a period of the cutoff from the ends the frame rate matters.

    The cutoff of ``sosfiltfilt`` is not that of the filter that was designed: −3 dB of one run are −6 dB of both.

    Cost: ``frames · joints · order``.

    Examples
    --------
    >>> import numpy as np, quatfilt as qf
    >>> t = np.arange(240) / 120
    >>> swing = qf.exp(0.4 * np.sin(2 * np.pi * t)[:, None] * [0.0, 0.0, 1.0])
    >>> noisy = qf.add_gaussian_noise(swing, sigma=np.radians(2), rng=0)
    >>> clean = qf.butterworth(noisy, cutoff=6, fps=120)
    >>> error = lambda q: float(np.degrees(qf.geodesic_distance(swing, q)).mean())
    >>> error(clean) < 0.4 * error(noisy)
    True
    """
    return with_translation(
        q,
        None,
        cutoff=cutoff,
        fps=fps,
        order=order,
        confidence=confidence,
        gaps=gaps,
        max_gap=max_gap,
        scalar_first=scalar_first,
    )[0]


def with_translation(
    q: ArrayLike, translation: Array | None, *, cutoff: PerJoint, fps: float, order: int, **missing: Any
) -> tuple[Array, Array | None]:
    """Filter as `butterworth` does, and a translation ``(frames, 3)`` as joint 0."""
    clip = _spans.prepare(q, fps=fps, **missing)
    rate = _validation.number(fps, "fps", above=0)
    frequency = _validation.frequencies(cutoff, "cutoff", clip.rotations.shape[1], rate)
    degree = _validation.integer(order, "order", at_least=1, at_most=_HIGHEST_ORDER)
    sections, states, padding = _design(frequency / rate, degree)
    reference = _development.reference_sigma(_REFERENCE * rate / frequency)

    def run(
        rotations: Array, along: Array | None, trust: Array | None, there: NDArray[np.intp]
    ) -> tuple[Array, Array | None]:
        result = ops().butterworth(
            rotations, along, trust, reference[there], sections[there], states[there], padding
        )
        return cast("tuple[Array, Array | None]", result)

    return _development.filtered(clip, translation, run)


def _design(cutoff: NDArray[np.float64], order: int) -> tuple[NDArray[np.float64], NDArray[np.float64], int]:
    """Design a low pass for each cutoff, in periods per frame: sections, their steady states, and SciPy's padding."""
    from scipy import signal  # noqa: PLC0415 - SciPy is loaded when it is needed

    distinct, which = np.unique(cutoff, return_inverse=True)
    sections = np.empty((len(distinct), (order + 1) // 2, 6))
    states = np.empty((*sections.shape[:2], 2))
    for i, frequency in enumerate(distinct):
        sections[i] = signal.butter(order, frequency, fs=1.0, output="sos")
        states[i] = signal.sosfilt_zi(sections[i])
    # An odd order has one section of the first order: its last coefficients are 0, and do not count.
    coefficients = order + 1
    return sections[which], states[which], 3 * coefficients
