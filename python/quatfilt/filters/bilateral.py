"""The bilateral orientation filter."""

from typing import Any, Literal, cast

from numpy.typing import ArrayLike

from quatfilt import _validation
from quatfilt._backend import ops
from quatfilt._typing import Array
from quatfilt.filters import _spans
from quatfilt.filters.boundary import BOUNDARIES, Boundary
from quatfilt.filters.nonlocal_pose_means import MOST, NO_LIMIT

Kernel = Literal["gaussian", "printed", "classic"]

KERNELS: tuple[Kernel, ...] = ("gaussian", "printed", "classic")

_LONGEST_RADIUS = 5000
"""Frames: no weights in time reach so far, and the sums of turns stay where sine and cosine are exact in float32."""


def bilateral(
    q: ArrayLike,
    *,
    radius: int = 4,
    sigma_time: float = 1.0,
    sigma_angle: float | ArrayLike = 0.2,
    kernel: Kernel = "gaussian",
    iterations: int = 1,
    boundary: Boundary = "mirror",
    lookahead: int | None = None,
    confidence: ArrayLike | None = None,
    gaps: _spans.Gaps = "fill",
    max_gap: float | None = None,
    fps: float = 1.0,
    scalar_first: bool = True,
) -> Array:
    """Smooth rotations, and keep sudden changes: near frames count the more, the nearer their rotations are.

    With the turns ``ω_i = log(q_i⁻¹ q_{i+1})`` and the rotation angle ``θ_r`` from frame `i` to frame ``i + r``::

        W_r    = exp(−|r| / (2·sigma_time²))·exp(−θ_r² / (2·sigma_angle²))        |r| ≤ radius
        F(q_i) = q_i·exp(Σ_r W_r·(sum of the ω from i to i + r) / Σ_r W_r)

    for each joint by itself. It is `orientation_filter` with a mask of its own for each frame.

    Parameters
    ----------
    q : array_like, shape (frames, joints, 4) or (frames, 4)
        Unit quaternions along time. NaN or four zeros are missing samples.
    radius : int, frames, default 4
        The window has ``2·radius + 1`` frames; from 0 to 5000.
    sigma_time : float, frames, default 1.0
        Scale of distances in time, without regard to `fps`.
    sigma_angle : float or array_like (joints,), radians of rotation, default 0.2
        Scale of distances between rotations: twice the paper's σ_g. Infinite: they do not matter.
    kernel : {"gaussian", "printed", "classic"}, default "gaussian"
        ``"classic"`` squares the distance in time too. ``"printed"`` does not square the angle either,
        ``exp(−θ / sigma_angle²)``, as section 4.2 of the paper has it; it hardly filters.
    iterations : int, default 1
        How often the filter is applied, each time with weights of the result before; the paper applies it five times.
    boundary : {"mirror", "linear", "nearest"}, default "mirror"
        How the clip goes on beyond its ends, anew each time: time turns round at the end frame, which is not repeated;
        the angular velocity is held; the end pose is held.
    lookahead : int or None, frames, default None
        If given, each pass sees at most so many later frames; all of them together `iterations` times as many.
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

    See Also
    --------
    orientation_filter : The same mask for all frames.
    BilateralStream : The same for a live source.

    Notes
    -----
    Cost: ``iterations · frames · joints · radius``.

    Rule of thumb: `sigma_angle` at two to three times the noise of a rotation. Far below it nothing is averaged; far
    above it the filter is a plain mean over the window.

    References
    ----------
    .. [1] N. Courty, "Bilateral human motion filtering", EUSIPCO 2008.
    .. [2] C. Tomasi and R. Manduchi, "Bilateral filtering for gray and color images", ICCV 1998.

    Examples
    --------
    >>> import numpy as np, quatfilt as qf
    >>> t = np.arange(240) / 120
    >>> swing = qf.exp(0.4 * np.sin(2 * np.pi * t)[:, None] * [0.0, 0.0, 1.0])
    >>> noisy = qf.add_gaussian_noise(swing, sigma=np.radians(2), rng=0)
    >>> clean = qf.bilateral(noisy, iterations=5)
    >>> error = lambda q: float(np.degrees(qf.geodesic_distance(swing, q)).mean())
    >>> error(clean) < 0.5 * error(noisy)
    True
    """
    return with_translation(
        q,
        None,
        radius=radius,
        sigma_time=sigma_time,
        sigma_angle=sigma_angle,
        kernel=kernel,
        iterations=iterations,
        boundary=boundary,
        lookahead=lookahead,
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
    radius: int,
    sigma_time: float,
    sigma_angle: float | ArrayLike,
    kernel: Kernel,
    iterations: int,
    boundary: Boundary,
    lookahead: int | None,
    confidence: ArrayLike | None,
    **missing: Any,
) -> tuple[Array, Array | None]:
    """Filter as `bilateral` does, and a translation ``(frames, 3)`` with the root's weights.

    The confidences are those of rotations: positions are trusted.
    """
    clip = _spans.prepare(q, confidence=confidence, **missing).pulled()
    reach = _validation.integer(radius, "radius", at_least=0, at_most=_LONGEST_RADIUS)
    time = _validation.number(sigma_time, "sigma_time", above=0)
    angles = _validation.per_joint(
        sigma_angle, "sigma_angle", clip.rotations.shape[1], above=0, infinite=True
    )
    options = (
        _validation.choice(kernel, "kernel", KERNELS),
        _validation.integer(iterations, "iterations", at_least=1),
        _validation.choice(boundary, "boundary", BOUNDARIES),
        NO_LIMIT
        if lookahead is None
        else _validation.integer(lookahead, "lookahead", at_least=0, at_most=MOST),
    )
    moved = None if translation is None else translation.astype(clip.rotations.dtype)

    def run(rotations: Array, _trust: Array | None, span: _spans.Span) -> Array:
        # Without the root there are no weights for its translation.
        part = moved[span.frames] if moved is not None and 0 in span.joints else None
        result, along = ops().bilateral(rotations, part, reach, time, angles[span.joints], *options)
        if moved is not None and along is not None:
            moved[span.frames] = along
        return cast("Array", result)

    return clip.filter(run), moved


__all__ = ["KERNELS", "Kernel", "bilateral", "with_translation"]
