"""The Gaussian filter."""

from typing import Any, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from quatfilt import _validation
from quatfilt._backend import ops
from quatfilt._typing import Array, PerJoint
from quatfilt.filters import _development, _spans
from quatfilt.filters.boundary import BOUNDARIES, Boundary

_WIDEST = 25_000.0
"""Frames: a mask of 100 000 frames to either side."""


def gaussian(
    q: ArrayLike,
    *,
    sigma: PerJoint,
    fps: float = 1.0,
    boundary: Boundary = "mirror",
    confidence: ArrayLike | None = None,
    gaps: _spans.Gaps = "fill",
    max_gap: float | None = None,
    scalar_first: bool = True,
) -> Array:
    """Smooth rotations with a Gaussian mask.

    The mask is that of ``scipy.ndimage.gaussian_filter1d``, applied to rotations as vectors about a smooth reference path
    ``r_t``, the average of the frames near `t`::

        R_0 = 0,    R_{t+1} = R_t + 2·log(r_t⁻¹ r_{t+1}),    y_t = R_t + 2·log(r_t⁻¹ q_t)
        F(q)_t = r_t·exp((Σ_j m_j y_{t+j} − R_t) / 2)

    so that a joint may turn as far as it likes, and about one fixed axis the unrolled angles are averaged. The vectors are seen from
    a frame that is carried along the path by parallel transport: small rotations are averaged as their rotation vectors.

    Parameters
    ----------
    q : array_like, shape (frames, joints, 4) or (frames, 4)
        Unit quaternions along time. NaN or four zeros are missing samples.
    sigma : float or array_like (joints,), seconds
        Standard deviation of the mask, which is cut off at four of them; above 0, and at most 25 000 frames.
    fps : float, hertz, default 1.0
        Frame rate; without it, `sigma` and `max_gap` count frames.
    boundary : {"mirror", "linear", "nearest"}, default "mirror"
        How the vectors go on beyond the ends of the clip: they turn round at the end frame, which is not repeated; the
        velocity of the end is held; the end is held.
    confidence : array_like or None, shape (frames,) or (frames, joints), default None
        Weights of the samples in the mean, from 0 to 1; NaN counts as 0. Samples that were filled in have 0. Where all
        samples under the mask have 0, they stay as they are.
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
        Unit quaternions, continuous in sign from the hemisphere of the first frame on.

    Raises
    ------
    ValueError, TypeError
        If an argument has another shape, type or range than stated; the message names it.

    See Also
    --------
    butterworth : A low pass with a steeper edge.
    savgol : Keeps peaks better.
    bilateral : Keeps sudden changes.

    Notes
    -----
    A Gaussian of deviation `sigma` halves sines of the frequency ``0.187 / sigma``.

    Cost: ``frames · joints · (σ + min(σ, 12))`` with σ in frames.

    Examples
    --------
    >>> import numpy as np, quatfilt as qf
    >>> t = np.arange(240) / 120
    >>> swing = qf.exp(0.4 * np.sin(2 * np.pi * t)[:, None] * [0.0, 0.0, 1.0])
    >>> noisy = qf.add_gaussian_noise(swing, sigma=np.radians(2), rng=0)
    >>> clean = qf.gaussian(noisy, sigma=0.03, fps=120)
    >>> error = lambda q: float(np.degrees(qf.geodesic_distance(swing, q)).mean())
    >>> error(clean) < 0.4 * error(noisy)
    True
    """
    return with_translation(
        q,
        None,
        sigma=sigma,
        fps=fps,
        boundary=boundary,
        confidence=confidence,
        gaps=gaps,
        max_gap=max_gap,
        scalar_first=scalar_first,
    )[0]


def with_translation(
    q: ArrayLike,
    translation: Array | None,
    *,
    sigma: PerJoint,
    fps: float,
    boundary: Boundary,
    **missing: Any,
) -> tuple[Array, Array | None]:
    """Filter as `gaussian` does, and a translation ``(frames, 3)`` as joint 0."""
    clip = _spans.prepare(q, fps=fps, **missing)
    rate = _validation.number(fps, "fps", above=0)
    joints = clip.rotations.shape[1]
    scale = rate * _validation.per_joint(sigma, "sigma", joints, above=0, at_most=_WIDEST / rate)
    reference = _development.reference_sigma(scale)
    limit = _validation.choice(boundary, "boundary", BOUNDARIES)

    def run(
        rotations: Array, along: Array | None, trust: Array | None, there: NDArray[np.intp]
    ) -> tuple[Array, Array | None]:
        result = ops().gaussian(rotations, along, trust, reference[there], scale[there], limit)
        return cast("tuple[Array, Array | None]", result)

    return _development.filtered(clip, translation, run)


__all__ = ["gaussian", "with_translation"]
