"""Orientation filters: a mask for numbers becomes a filter for rotations."""

from typing import Any, cast

from numpy.typing import ArrayLike

from quatfilt import _validation
from quatfilt._backend import ops
from quatfilt._typing import Array
from quatfilt.filters import _spans
from quatfilt.filters.boundary import BOUNDARIES, Boundary


def orientation_filter(
    q: ArrayLike,
    mask: ArrayLike,
    *,
    iterations: int = 1,
    boundary: Boundary = "mirror",
    confidence: ArrayLike | None = None,
    gaps: _spans.Gaps = "fill",
    max_gap: float | None = None,
    fps: float = 1.0,
    scalar_first: bool = True,
) -> Array:
    """Filter rotations with the mask of any filter for numbers, as Lee and Shin do.

    With the turns from frame to frame ``ω_i = log(q_i⁻¹ q_{i+1})``, and the mask ``m_{−k} … m_k`` made to have the sum 1::

        H(q_i) = q_i·exp(Σ_{r=−k}^{k−1} b_r ω_{i+r})
        b_r    = −Σ_{j=−k}^{r} m_j   (r < 0),     Σ_{j=r+1}^{k} m_j   (r ≥ 0)

    About one fixed axis this is the mask's mean of the angles, however far they turn. A constant rotation on either
    side of `q` goes through unchanged.

    Parameters
    ----------
    q : array_like, shape (frames, joints, 4) or (frames, 4)
        Unit quaternions along time. NaN or four zeros are missing samples.
    mask : array_like, shape (2k + 1,)
        Weights of the frames from `k` before to `k` after, in any scale: binomial, Gaussian, of Savitzky and Golay, …
        Their sum is not near 0.
    iterations : int, default 1
        How often the filter is applied.
    boundary : {"mirror", "linear", "nearest"}, default "mirror"
        How the clip goes on beyond its ends, anew each time: time turns round at the end frame, which is not repeated;
        the angular velocity is held; the end pose is held.
    confidence : array_like, shape (frames,) or (frames, joints), 0…1, or None, default None
        How far samples are trusted. Those of confidence 0 are filled in like missing ones, whatever they are; those of a
        confidence `c` below 1 are first moved by ``1 − c`` of the way to the mean of what is around them.
    gaps : {"fill", "keep", "raise"}, default "fill"
        What becomes of missing samples. Filled ones count like any other; with ``"keep"`` they are missing again in the
        result.
    max_gap : float or None, seconds, default None
        The longest gap that is filled; None for any. Longer ones stay missing, and their sides are filtered apart.
    fps : float, hertz, default 1.0
        Frame rate, for `max_gap`; without it `max_gap` counts frames.
    scalar_first : bool, default True
        Whether quaternions are ``(w, x, y, z)``; False for SciPy's ``(x, y, z, w)``.

    Returns
    -------
    ndarray, shape of `q`
        Unit quaternions, continuous in sign from the hemisphere of the first frame on.

    Raises
    ------
    ValueError, TypeError
        If an argument has another shape, type or range than stated; the message names it.

    Notes
    -----
    Cost: ``iterations · frames · joints · k``. Turns of more than π from one frame to the next are taken the shorter way.

    References
    ----------
    .. [1] J. Lee and S. Y. Shin, "General construction of time-domain filters for orientation data", IEEE
       Transactions on Visualization and Computer Graphics 8(2), 2002.

    Examples
    --------
    >>> import numpy as np, quatfilt as qf
    >>> t = np.arange(240) / 120
    >>> swing = qf.exp(0.4 * np.sin(2 * np.pi * t)[:, None] * [0.0, 0.0, 1.0])
    >>> noisy = qf.add_gaussian_noise(swing, sigma=np.radians(2), rng=0)
    >>> clean = qf.orientation_filter(noisy, [1, 4, 6, 4, 1], iterations=2)
    >>> error = lambda q: float(np.degrees(qf.geodesic_distance(swing, q)).mean())
    >>> error(clean) < 0.6 * error(noisy)
    True
    """
    return with_translation(
        q,
        None,
        mask=mask,
        iterations=iterations,
        boundary=boundary,
        confidence=confidence,
        gaps=gaps,
        max_gap=max_gap,
        fps=fps,
        scalar_first=scalar_first,
    )[0]


def with_translation(
    q: ArrayLike,
    translation: Array | None,
    *,
    mask: ArrayLike,
    iterations: int,
    boundary: Boundary,
    confidence: ArrayLike | None,
    **missing: Any,
) -> tuple[Array, Array | None]:
    """Filter as `orientation_filter` does, and a translation ``(frames, 3)`` with the same mask.

    The confidences are those of rotations: positions are trusted.
    """
    clip = _spans.prepare(q, confidence=confidence, **missing).pulled()
    options = (
        _validation.mask(mask, "mask"),
        _validation.integer(iterations, "iterations", at_least=1),
        _validation.choice(boundary, "boundary", BOUNDARIES),
    )
    moved = None if translation is None else translation.astype(clip.rotations.dtype)

    def run(rotations: Array, _trust: Array | None, span: _spans.Span) -> Array:
        # A translation without its root may come from anywhere.
        part = moved[span.frames] if moved is not None and 0 in span.joints else None
        result, along = ops().orientation_filter(rotations, part, *options)
        if moved is not None and along is not None:
            moved[span.frames] = along
        return cast("Array", result)

    return clip.filter(run), moved


__all__ = ["orientation_filter", "with_translation"]
