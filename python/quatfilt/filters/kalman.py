"""The Kalman filter of constant angular velocity, and its smoother."""

from typing import Any, Literal, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from quatfilt import _validation
from quatfilt._backend import ops
from quatfilt._typing import Array
from quatfilt.filters import _paths, _spans
from quatfilt.noise._measure import measure

Noise = float | ArrayLike | Literal["auto"]

_WHOLE_CLIP = -1

_LONGEST_LOOKAHEAD = 1_000_000_000
"""Frames: longer than any clip."""

_BLOCKS, _BLOCK_FRAMES = 16, 256
"""The process noise of longer clips is chosen on so many blocks of so many frames."""

_LEAST_NOISE = 1e-6
"""Radians: the automatic measurement noise of a joint without noise, about the rounding of float32."""

EXTREMES = 1e-12, 1e9
"""Radians: noises beyond have the same effect, and squares that overflow."""


def kalman(
    q: ArrayLike,
    *,
    fps: float = 1.0,
    process_noise: Noise = "auto",
    measurement_noise: Noise = "auto",
    smooth: bool = True,
    lookahead: int | None = None,
    confidence: ArrayLike | None = None,
    gaps: _spans.Gaps = "fill",
    max_gap: float | None = None,
    scalar_first: bool = True,
) -> Array:
    """Follow rotations that turn at an angular velocity which changes by chance, and smooth them.

    What is known of a joint is its pose and its angular velocity. From frame to frame the pose goes on turning, and each
    sample corrects both by a share of what it differs by from what was expected::

        q⁻ = q·exp(ω/(2·fps))          ν = 2·log(q⁻⁻¹·z)          q ← q⁻·exp(K₁ν/2)          ω ← ω + K₂ν

    The shares follow from the two noises. The smoother then goes back from the end of the clip, so that each frame knows
    of all others. About one fixed axis both are the linear Kalman filter, and the smoother of Rauch, Tung and Striebel, of
    the angle.

    Parameters
    ----------
    q : array_like, shape (frames, joints, 4) or (frames, 4)
        Unit quaternions along time. NaN or four zeros are missing samples.
    fps : float, hertz, default 1.0
        Frame rate; without it seconds are frames.
    process_noise : float or array_like (joints,), rad/s^1.5, or "auto", default "auto"
        How much the angular velocity changes by chance: by a deviation of ``process_noise·√t`` in `t` seconds. 0: it is
        constant. "auto" chooses it for each joint from the clip; see Notes.
    measurement_noise : float or array_like (joints,), radians, or "auto", default "auto"
        Deviation of a sample per component of the rotation vector, above 0. "auto" is the level of `noise_model`. With
        ``process_noise="auto"`` it hardly matters: what matters is the ratio of the two.
    smooth : bool, default True
        Whether later frames count. False is the forward filter.
    lookahead : int or None, frames, default None
        How many later frames count, with ``smooth=True``: 0 is the forward filter, None the whole clip.
    confidence : array_like or None, shape (frames,) or (frames, joints), 0…1, default None
        The variance of a sample is divided by it. 0 is a missing sample.
    gaps : {"fill", "keep", "raise"}, default "fill"
        What becomes of missing samples. Where they are filled, the filter goes on turning, as far as it can tell where to,
        and the smoother finds a smooth way to what follows.
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
    one_euro : A simpler filter without a view ahead.

    Notes
    -----
    "auto": of 24 ratios of the noises the forward filter takes the one whose forecasts are best, the smoother a minimum of
    the generalised cross-validation near by. Clips of more than 4096 frames are judged by 16 blocks of 256.

    A gap in which a forecast becomes uncertain by more than 0.2 rad is crossed as if the pose had stayed there. Before a
    joint's first sample its pose stays.

    At twice the frame rate and ``√2`` times the `measurement_noise`, a second tells as much as before, and so the result is
    the same up to what happens between the frames.

    Cost: about 50 ns per sample, and 20 ns more for each frame of a `lookahead`; "auto" another 1 µs per sample of at most
    4096 frames. Memory: 832 bytes per frame for each thread.

    References
    ----------
    .. [1] R. E. Kalman, "A new approach to linear filtering and prediction problems", 1960.
    .. [2] H. E. Rauch, F. Tung and C. T. Striebel, "Maximum likelihood estimates of linear dynamic systems", 1965.
    .. [3] P. Craven and G. Wahba, "Smoothing noisy data with spline functions", 1979.

    Examples
    --------
    >>> import numpy as np, quatfilt as qf
    >>> t = np.arange(240) / 120
    >>> swing = qf.exp(0.4 * np.sin(2 * np.pi * t)[:, None] * [0.0, 0.0, 1.0])
    >>> noisy = qf.add_gaussian_noise(swing, sigma=np.radians(2), rng=0)
    >>> error = lambda q: float(np.degrees(qf.geodesic_distance(swing, q)).mean())
    >>> error(qf.kalman(noisy, smooth=False)) < 0.6 * error(noisy)
    True
    >>> error(qf.kalman(noisy)) < 0.3 * error(noisy)
    True
    """
    return with_translation(
        q,
        None,
        fps=fps,
        process_noise=process_noise,
        measurement_noise=measurement_noise,
        smooth=smooth,
        lookahead=lookahead,
        confidence=confidence,
        gaps=gaps,
        max_gap=max_gap,
        scalar_first=scalar_first,
    )[0]


def kalman_noises(
    q: ArrayLike,
    *,
    fps: float = 1.0,
    process_noise: Noise = "auto",
    measurement_noise: Noise = "auto",
    smooth: bool = True,
    lookahead: int | None = None,
    confidence: ArrayLike | None = None,
    scalar_first: bool = True,
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the noises that `kalman` takes for a clip: to look at, to change, or for a `KalmanStream`.

    Parameters
    ----------
    q : array_like, shape (frames, joints, 4) or (frames, 4)
        Unit quaternions along time. NaN or four zeros are missing samples.
    fps, process_noise, measurement_noise, smooth, lookahead, confidence, scalar_first : as in `kalman`
        With a `lookahead` of 0, or ``smooth=False``, the process noise is that of the forward filter.

    Returns
    -------
    process_noise : ndarray, shape (joints,), rad/s^1.5
        What ``"auto"`` chooses for each joint, or what was given.
    measurement_noise : ndarray, shape (joints,), radians
        The same.

    Raises
    ------
    ValueError, TypeError
        If an argument has another shape, type or range than stated; the message names it.

    Examples
    --------
    >>> import numpy as np, quatfilt as qf
    >>> t = np.arange(240) / 120
    >>> swing = qf.exp(0.4 * np.sin(2 * np.pi * t)[:, None] * [0.0, 0.0, 1.0])
    >>> noisy = qf.add_gaussian_noise(swing, sigma=0.03, rng=0)
    >>> process, measurement = qf.kalman_noises(noisy, fps=120)
    >>> bool(0.02 < measurement[0] < 0.04)
    True
    >>> clean = qf.kalman(noisy, fps=120, process_noise=process, measurement_noise=measurement)
    >>> bool(np.allclose(clean, qf.kalman(noisy, fps=120), rtol=0, atol=1e-9))
    True
    """
    clip = _spans.prepare(
        q, fps=fps, gaps="fill", max_gap=None, confidence=confidence, scalar_first=scalar_first
    )
    reach = _reach(smooth=smooth, lookahead=lookahead)
    process, measurement = _noises(clip, process_noise, measurement_noise, reach, float(fps))
    return process * float(fps) ** 1.5, measurement


def with_translation(
    q: ArrayLike,
    translation: Array | None,
    *,
    fps: float,
    process_noise: Noise,
    measurement_noise: Noise,
    smooth: bool,
    lookahead: int | None,
    **missing: Any,
) -> tuple[Array, Array | None]:
    """Filter as `kalman` does, and each axis of a translation ``(frames, 3)`` with a ratio of noises of its own."""
    clip = _spans.prepare(q, fps=fps, **missing)
    reach = _reach(smooth=smooth, lookahead=lookahead)
    process, measurement = _noises(clip, process_noise, measurement_noise, reach, float(fps))

    def run(rotations: Array, trust: Array | None, span: _spans.Span) -> Array:
        joints = span.joints
        return cast("Array", ops().kalman(rotations, trust, process[joints], measurement[joints], reach))

    result = clip.filter(run)
    if translation is None:
        return result, None
    moved = translation.astype(clip.rotations.dtype)
    if clip.confidence is not None and clip.confidence.size:
        moved = _paths.straightened(moved, np.asarray(clip.confidence[:, 0] > 0))
    sample, block = _sample(moved)
    ratio = ops().kalman_vectors_ratio(sample, block, reach)
    return result, cast("Array", ops().kalman_vectors(moved, ratio, reach))


def _reach(*, smooth: bool, lookahead: int | None) -> int:
    """Return how many later frames count; −1 for all."""
    _validation.switch(smooth, "smooth")
    if lookahead is None:
        return _WHOLE_CLIP if smooth else 0
    frames = _validation.integer(lookahead, "lookahead", at_least=0, at_most=_LONGEST_LOOKAHEAD)
    if not smooth:
        raise ValueError(f"lookahead: expected None with smooth=False, got {frames}")
    return frames


def _noises(
    clip: _spans.Clip, process_noise: Noise, measurement_noise: Noise, reach: int, fps: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the noises of each joint: in radians / frame^1.5 and in radians."""
    joints = clip.rotations.shape[1]
    if isinstance(measurement_noise, str):
        _validation.known(
            measurement_noise, "measurement_noise", ("auto",), "'auto', a number or one per joint"
        )
        measurement = np.full(joints, _LEAST_NOISE)
        if not clip.unchanged:
            measurement = np.maximum(measure(clip.observed, fps=fps).level, _LEAST_NOISE)
    else:
        measurement = _validation.per_joint(measurement_noise, "measurement_noise", joints, above=0)
    measurement = np.clip(measurement, *EXTREMES)
    if not isinstance(process_noise, str):
        process = _validation.per_joint(process_noise, "process_noise", joints, at_least=0)
        return np.clip(process * fps**-1.5, 0, EXTREMES[1]), measurement
    _validation.known(process_noise, "process_noise", ("auto",), "'auto', a number or one per joint")
    if clip.unchanged:
        return measurement, measurement
    rotations, block = _sample(clip.rotations)
    trust = None if clip.confidence is None else _sample(clip.confidence)[0]
    gone = np.isnan(rotations[..., 0])
    if gone.any():
        # Gaps that stay have no confidence, and any rotation.
        rotations = np.where(gone[..., None], np.array([1, 0, 0, 0], rotations.dtype), rotations)
    return ops().kalman_process_noise(rotations, trust, measurement, block, reach), measurement


def _sample(frames: Array) -> tuple[Array, int]:
    """Return all frames of a short clip, evenly spaced blocks of a long one, and the length of a block."""
    if len(frames) <= _BLOCKS * _BLOCK_FRAMES:
        return frames, max(len(frames), 1)
    starts = np.linspace(0, len(frames) - _BLOCK_FRAMES, _BLOCKS).astype(np.intp)
    return frames[(starts[:, None] + np.arange(_BLOCK_FRAMES)).ravel()], _BLOCK_FRAMES


__all__ = ["EXTREMES", "Noise", "kalman", "kalman_noises", "with_translation"]
