"""Wavelet shrinkage."""

from types import ModuleType
from typing import Any, Literal, TypeAlias, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from quatfilt import _validation
from quatfilt._backend import ops
from quatfilt._extras import pywavelets
from quatfilt._typing import Array, PerJoint
from quatfilt.filters import _development, _spans

Rule: TypeAlias = Literal["auto", "bayes", "universal"]

_RULES: tuple[Rule, ...] = ("auto", "bayes", "universal")

_REFERENCE = 4.0
"""Frames: deviation of the reference path's mask. With less, the noise that is left in the path adds up."""

_MEDIAN_OF_NORMAL = 0.6744897501960817
"""Median of the absolute value of a normal number with deviation 1."""


def wavelet(
    q: ArrayLike,
    *,
    wavelet: str = "sym8",
    threshold: Rule | PerJoint = "auto",
    confidence: ArrayLike | None = None,
    gaps: _spans.Gaps = "fill",
    max_gap: float | None = None,
    fps: float = 1.0,
    scalar_first: bool = True,
) -> Array:
    """Remove noise from rotations by shrinking their wavelet coefficients.

    Each joint's vectors about a smooth reference path, see `gaussian`, but in the frame of the body, are turned to their principal
    axes and decomposed by PyWavelets; every detail moves towards 0 by a threshold ``t``, ``sign(d)·max(|d| − t, 0)``, and the rest is put together
    again. PyWavelets is an extra: ``pip install 'quatfilt[wavelet]'``.

    Parameters
    ----------
    q : array_like, shape (frames, joints, 4) or (frames, 4)
        Unit quaternions along time. NaN or four zeros are missing samples.
    wavelet : str, default "sym8"
        A discrete wavelet of PyWavelets. The thresholds are made for orthogonal ones.
    threshold : {"auto", "bayes", "universal"}, float or array_like (joints,), radians, default "auto"
        How far details shrink. ``"bayes"``, which ``"auto"`` stands for: ``σ²/σ_d`` for each level and axis, where ``σ_d`` is
        what the details deviate without the noise; ``"universal"``: ``σ·√(2·log(frames))``. The noise ``σ`` of a joint is that
        of `noise_level`, seen along these axes. A number is the threshold of all levels.
    confidence : array_like or None, shape (frames,) or (frames, joints), default None
        How far samples are believed, from 0 to 1, rather than the weighted mean of those near them; NaN counts as 0.
        Samples that were filled in have 0.
    gaps : {"fill", "keep", "raise"}, default "fill"
        What becomes of missing samples. With ``"fill"`` they are estimated from their neighbours; with ``"keep"`` they are
        missing again in the result.
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
    ImportError
        Without PyWavelets.
    ValueError, TypeError
        If an argument has another shape, type or range than stated; the message names it.

    See Also
    --------
    noise_level : The noise that the thresholds come from.

    Notes
    -----
    There are as many levels as PyWavelets' ``dwt_max_level`` allows for a clip twice as long: with "sym8", of 16
    coefficients, 5 for 300 frames and 7 for 1500. Clips shorter than the wavelet's filter have none, and come back as they
    are.

    The decomposition halves the frame rate level by level, so that a clip that starts a frame later gives slightly other
    results.

    Cost: ``frames · joints``; most of the time is PyWavelets'.

    References
    ----------
    .. [1] D. L. Donoho, "De-noising by soft-thresholding", IEEE Transactions on Information Theory 41, 1995.
    .. [2] S. G. Chang, B. Yu, M. Vetterli, "Adaptive wavelet thresholding for image denoising and compression", IEEE
       Transactions on Image Processing 9, 2000.

    Examples
    --------
    >>> import numpy as np, quatfilt as qf
    >>> t = np.arange(240) / 120
    >>> swing = qf.exp(0.4 * np.sin(2 * np.pi * t)[:, None] * [0.0, 0.0, 1.0])
    >>> noisy = qf.add_gaussian_noise(swing, sigma=np.radians(2), rng=0)
    >>> clean = qf.wavelet(noisy)
    >>> error = lambda q: float(np.degrees(qf.geodesic_distance(swing, q)).mean())
    >>> error(clean) < 0.5 * error(noisy)
    True
    """
    return with_translation(
        q,
        None,
        wavelet=wavelet,
        threshold=threshold,
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
    wavelet: str,
    threshold: Rule | PerJoint,
    **missing: Any,
) -> tuple[Array, Array | None]:
    """Filter as `wavelet` does, and a translation ``(frames, 3)`` by a rule of its own noise: "bayes" for a number."""
    clip = _spans.prepare(q, **missing)
    pywt = pywavelets()
    name = _validation.known(
        wavelet, "wavelet", pywt.wavelist(kind="discrete"), "a discrete wavelet of PyWavelets such as 'sym8'"
    )
    joints = clip.rotations.shape[1]
    rule: Rule | None = None
    given = np.empty(0)
    if isinstance(threshold, str):
        expected = f"one of {', '.join(map(repr, _RULES))}, a number or one per joint"
        rule = cast("Rule", _validation.known(threshold, "threshold", _RULES, expected))
    else:
        given = _validation.per_joint(threshold, "threshold", joints, at_least=0)
    moved = None if translation is None else translation.astype(clip.rotations.dtype)

    def run(rotations: Array, trust: Array | None, span: _spans.Span) -> Array:
        there = span.joints
        scale = _development.reference_sigma(np.full(len(there), _REFERENCE))
        reference, development, vectors = ops().develop(rotations, trust, scale)
        believed = rotations
        if trust is not None:
            vectors = development + trust[..., None] * (vectors - development)
            believed = np.where(trust[..., None] == 0, np.nan, rotations).astype(rotations.dtype)
        axes = _principal_axes(vectors)
        limits = given[there] if rule is None else _noise(believed, axes)
        shrunk = _shrunk(vectors, axes, pywt, name, rule=rule, scale=limits)
        if moved is not None and 0 in there:
            path = moved[span.frames]
            if trust is not None:
                root = np.ascontiguousarray(rotations[:, :1]), path, np.ascontiguousarray(trust[:, :1])
                mean = ops().gaussian(*root, scale[:1], scale[:1], "mirror")[1]
                path = mean + trust[:, :1] * (path - mean)
            wide = path.astype(np.float64)[:, None]
            smooth = _shrunk(wide, _principal_axes(wide), pywt, name, rule=rule or "bayes", scale=None)
            moved[span.frames] = smooth[:, 0]
        return cast("Array", ops().undevelop(rotations, reference, development, shrunk))

    return clip.filter(run), moved


def _principal_axes(vectors: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the principal axes of ``(frames, joints, 3)``, as the columns of rotation matrices ``(joints, 3, 3)``."""
    centred = vectors - vectors.mean(axis=0)
    _, axes = np.linalg.eigh(np.einsum("tji,tjk->jik", centred, centred))
    return np.asarray(axes * np.where(np.linalg.det(axes) < 0, -1, 1)[:, None, None], np.float64)


def _noise(rotations: Array, axes: NDArray[np.float64]) -> NDArray[np.float64]:
    """Estimate the noise of rotations along axes: then it does not depend on how the frame of a joint was chosen."""
    from scipy.spatial.transform import Rotation  # noqa: PLC0415 - SciPy is loaded when it is needed

    turn = np.roll(Rotation.from_matrix(axes).as_quat(), 1, axis=-1).astype(rotations.dtype)
    turns = np.ascontiguousarray(np.broadcast_to(turn, rotations.shape))
    turned = ops().multiply(rotations.reshape(-1, 4), turns.reshape(-1, 4))
    return np.asarray(ops().noise_level(turned.reshape(rotations.shape)), np.float64)


def _shrunk(
    vectors: NDArray[np.float64],
    axes: NDArray[np.float64],
    pywt: ModuleType,
    name: str,
    *,
    rule: Rule | None,
    scale: NDArray[np.float64] | None,
) -> NDArray[np.float64]:
    """Shrink the wavelet coefficients of ``(frames, joints, 3)`` along axes.

    `scale` has the joints' noise, or without a `rule` their thresholds; None: the noise is that of the finest details.
    """
    frames = len(vectors)
    columns = np.einsum("tji,jik->jkt", vectors, axes)
    coarse: NDArray[np.float64] = columns
    details: list[NDArray[np.float64]] = []
    # One level more than PyWavelets recommends: on clips of a few seconds that is worth what the ends suffer.
    for _ in range(pywt.dwt_max_level(2 * frames, pywt.Wavelet(name).dec_len)):
        coarse, detail = pywt.dwt(coarse, name, mode="symmetric")
        details.insert(0, detail)
    sigma = scale[:, None] if scale is not None else _finest(details)
    for i, detail in enumerate(details):
        limit = _thresholds(detail, rule, sigma, frames)[..., None]
        details[i] = np.sign(detail) * np.maximum(np.abs(detail) - limit, 0)
    # One frame more comes back where their number is odd.
    smooth = pywt.waverec([coarse, *details], name, mode="symmetric")[..., :frames]
    return np.ascontiguousarray(np.einsum("jkt,jik->tji", smooth, axes))


def _finest(details: list[NDArray[np.float64]]) -> NDArray[np.float64]:
    """Return the deviation of noise per column, from the details that hold least of the motion."""
    if not details:
        return np.zeros((1, 1))
    return np.asarray(np.median(np.abs(details[-1]), axis=-1) / _MEDIAN_OF_NORMAL)


def _thresholds(
    detail: NDArray[np.float64], rule: Rule | None, sigma: NDArray[np.float64], frames: int
) -> NDArray[np.float64]:
    """Return thresholds ``(joints, 3)`` for the details of a level, from the noise, or without a rule from themselves."""
    if rule is None:
        return np.broadcast_to(sigma, detail.shape[:-1])
    if rule == "universal":
        return np.broadcast_to(sigma * np.sqrt(2 * np.log(frames)), detail.shape[:-1])
    signal = np.mean(detail**2, axis=-1) - sigma**2
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(signal > 0, sigma**2 / np.sqrt(signal), np.inf)


__all__ = ["Rule", "wavelet", "with_translation"]
