"""Automatic smoothing."""

from typing import Any, Literal, TypeAlias, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from quatfilt import _validation
from quatfilt._backend import ops
from quatfilt._typing import Array, Mask, PerJoint
from quatfilt.filters import _development, _paths, _spans
from quatfilt.filters._gains import weights
from quatfilt.filters._measured import assumed_level, learned_share, whitened
from quatfilt.noise._measure import measure

_STRONGEST = 1e6
"""Far below it already, nothing is left but a constant or a polynomial."""

Joints: TypeAlias = Literal["apart", "together"]

_JOINTS: tuple[Joints, ...] = ("apart", "together")

Noise: TypeAlias = Literal["white", "measured"]

_NOISES: tuple[Noise, ...] = ("white", "measured")

_LONGEST_FREEZE = 0.25, 15
"""Seconds, and frames where the frame rate is not known: joints that repeat their sample for longer are frozen. What they did
meanwhile is not known, and they stay as they are."""

_PATCH_ROUNDS = 1
"""How often groups of similar patches are smoothed: a second time gains at strong noise what it loses at weak noise."""


def smooth(
    q: ArrayLike,
    *,
    strength: PerJoint = 1.0,
    joints: Joints = "apart",
    learned: bool = False,
    noise: Noise = "white",
    confidence: ArrayLike | None = None,
    gaps: _spans.Gaps = "fill",
    max_gap: float | None = None,
    fps: float = 1.0,
    scalar_first: bool = True,
) -> Array:
    """Smooth rotations by as much as their noise asks for.

    The noise of each joint is estimated from the clip. The joint's vectors about a smooth reference path, see `gaussian`, are
    turned to the principal axes of its motion, and each axis is smoothed by penalised least squares::

        Σ_t w_t (x_t − z_t)² + Σ_t (Δᵒx)_t² / s_t  →  min

    The order `o` of the differences, 1 to 3, and the softness `s`, which changes along the clip, are those that Stein's unbiased
    estimate of the risk prefers in blocks of 512 frames. A second round sees the rotations about the result of the first.

    Parameters
    ----------
    q : array_like, shape (frames, joints, 4) or (frames, 4)
        Unit quaternions along time. NaN or four zeros are missing samples.
    strength : float or array_like (joints,), default 1.0
        By how much more noise is taken for granted than the clip is estimated to have, up to 1e6; 0 changes nothing.
    joints : {"apart", "together"}, default "apart"
        With ``"together"`` three more steps follow: all joints are smoothed along the principal axes of the whole body, then
        groups of similar patches of motion, wherever they are within 256 frames, and then all joints as few movements at a
        time. What repeats itself, in time or between joints, is kept, and noise is not. Takes about six times as long.
    learned : bool, default False
        With ``joints="together"``, True adds a last step, which corrects the result in several scales of time with gains from a
        small network that was trained on recordings of other people. Where the measured noise is coloured or unsteady, a third of
        the correction counts; with measured noise that may as well be motion, nothing of it. With ``"apart"`` there is no such step.
    noise : {"white", "measured"}, default "white"
        With ``"measured"`` the noise need be neither white nor steady: its colour, its axes, its level along time and exact repeats
        are measured first, see `noise_model`. Samples that repeat the one before have confidence 0; stretches with more noise have
        less confidence; coloured noise is whitened. Where the noise turns out to be white and steady, the result is the same as
        with ``"white"``, bit for bit.
    confidence : array_like or None, shape (frames,) or (frames, joints), default None
        Weights of the samples, from 0 to 1; NaN counts as 0. Samples that were filled in have 0. What has 0 is filled in from
        its neighbours, and counts as a hundredth.
    gaps : {"fill", "keep", "raise"}, default "fill"
        What becomes of missing samples. With ``"fill"`` they are estimated with their neighbours; with ``"keep"`` they are
        missing again in the result.
    max_gap : float or None, seconds, default None
        The longest gap that is filled; None for any. Longer ones stay missing, and their sides are smoothed apart.
    fps : float, hertz, default 1.0
        Frame rate, for `max_gap`, and for freezes and evidence with ``noise="measured"``; without it `max_gap` counts frames.
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
    despike : Takes impulses away, which are no noise.
    noise_level : The estimate of the noise.

    Notes
    -----
    Cost: linear in frames and joints; together, the similarities of joints take time by the square of their number. Memory is about
    four times the input beside the result, and linear in both. Single frames that lie far off are smeared: `despike` before.

    References
    ----------
    .. [1] C. M. Stein, "Estimation of the mean of a multivariate normal distribution", Annals of Statistics 9(6), 1981.
    .. [2] C. H. Reinsch, "Smoothing by spline functions", Numerische Mathematik 10, 1967.
    .. [3] G. Leung and A. R. Barron, "Information theory and mixing least-squares regressions", IEEE Transactions on
       Information Theory 52(8), 2006.

    Examples
    --------
    >>> import numpy as np, quatfilt as qf
    >>> t = np.arange(240) / 120
    >>> swing = qf.exp(0.4 * np.sin(2 * np.pi * t)[:, None] * [0.0, 0.0, 1.0])
    >>> noisy = qf.add_gaussian_noise(swing, sigma=np.radians(2), rng=0)
    >>> clean = qf.smooth(noisy)
    >>> error = lambda q: float(np.degrees(qf.geodesic_distance(swing, q)).mean())
    >>> error(clean) < 0.3 * error(noisy)
    True
    """
    return with_translation(
        q,
        None,
        strength=strength,
        joints=joints,
        learned=learned,
        noise=noise,
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
    strength: PerJoint,
    joints: Joints,
    learned: bool,
    noise: Noise,
    fps: float,
    **missing: Any,
) -> tuple[Array, Array | None]:
    """Smooth as `smooth` does, and a translation ``(frames, 3)`` by its own noise and with the strength of joint 0."""
    together = _validation.choice(joints, "joints", _JOINTS) == "together"
    share = 1.0 if _validation.switch(learned, "learned") else 0.0
    measured = _validation.choice(noise, "noise", _NOISES) == "measured"
    clip = _spans.prepare(q, together=together, fps=fps, **missing)
    scale = _validation.per_joint(
        strength, "strength", clip.rotations.shape[1], at_least=0, at_most=_STRONGEST
    )
    model = None
    levels = np.zeros_like(scale)
    position_noise = 0.0
    if not clip.unchanged:
        if measured:
            model = measure(clip.observed, fps=fps)
            levels = scale * assumed_level(model)
            share *= learned_share(model)
        else:
            levels = scale * ops().noise_level(clip.observed).astype(np.float64)
        if translation is not None:
            path = _trusted_part(translation, clip)
            position_noise = float(scale[0] * ops().noise_level(path[:, None])[0])

    def run(
        rotations: Array, along: Array | None, trust: Array | None, span: _spans.Span
    ) -> tuple[Array, Array | None]:
        here = levels[span.joints]
        kept = rotations
        frozen = None if model is None else model.repeated[span.frames, span.joints]
        if frozen is not None and frozen.any():
            trust = np.where(frozen, 0, 1 if trust is None else trust)
            trust = np.ascontiguousarray(trust, rotations.dtype)
        if trust is not None:
            rotations = _spans.refilled(rotations, trust == 0)
            along = None if along is None else _paths.straightened(along, trust[:, 0] > 0)
        if model is None:
            return _smoothed(rotations, along, trust, here, position_noise, together=together, learned=share)
        white = whitened(rotations, trust, here, span, model)
        result, moved = _smoothed(
            white.rotations,
            along,
            white.confidence,
            white.noise,
            position_noise,
            together=together,
            learned=share,
        )
        result = white.back(result)
        if frozen is not None:
            long = _runs_of_at_least(frozen, _freeze_frames(fps))
            result[long] = kept[long]
        return result, moved

    return _development.filtered_spans(clip, translation, run)


def _smoothed(
    rotations: Array,
    along: Array | None,
    trust: Array | None,
    levels: NDArray[np.float64],
    position_noise: float,
    *,
    together: bool,
    learned: float,
) -> tuple[Array, Array | None]:
    """Smooth rotations of white noise, and a translation; `learned` is the share of the learned correction."""
    result, moved = ops().smooth(rotations, along, trust, levels, position_noise)
    if together:
        result = ops().smooth_body(rotations, result, trust, levels)
        patches = ops().smooth_patches(rotations, result, trust, levels, _PATCH_ROUNDS)
        result = ops().smooth_rank(rotations, patches, trust, levels)
        if learned > 0:
            result = ops().smooth_gains(rotations, patches, result, trust, levels, learned, *weights())
    return cast("Array", result), cast("Array | None", moved)


def _freeze_frames(fps: float) -> int:
    seconds, frames = _LONGEST_FREEZE
    return frames if fps <= 1 else max(round(seconds * fps), 2)


def _runs_of_at_least(mask: Mask, length: int) -> Mask:
    """Return where a mask ``(frames, joints)`` is set for so many frames on end."""
    result = np.zeros_like(mask)
    edges = np.diff(mask.astype(np.int8), axis=0, prepend=0, append=0)
    for joint in np.flatnonzero(mask.any(axis=0)):
        starts, ends = np.flatnonzero(edges[:, joint] > 0), np.flatnonzero(edges[:, joint] < 0)
        for start, end in zip(starts, ends, strict=True):
            result[start:end, joint] = end - start >= length
    return result


def _trusted_part(translation: Array, clip: _spans.Clip) -> Array:
    """Return a translation, NaN where nobody trusts the pose of the root."""
    if clip.confidence is None:
        return translation
    return np.where(clip.confidence[:, :1] > 0, translation, np.nan).astype(translation.dtype)


__all__ = ["Joints", "Noise", "smooth", "with_translation"]
