"""Jitter of estimates from video: where it is, and the low pass that takes it away."""

import math
from collections.abc import Sequence
from typing import cast

import numpy as np
from numpy.typing import NDArray

from quatfilt import chain
from quatfilt._backend import ops
from quatfilt._typing import Array, Mask
from quatfilt.filters import _development, _spans
from quatfilt.filters._paths import straightened

_REFERENCE = 0.13
"""Deviation of the reference path's Gaussian in periods of the cut-off, as for `butterworth`."""

SECONDS = 4.2
"""Length of the stretches that are judged for themselves: three windows of `tracker_noise`."""

EXCESSES = (0.25, 0.35)
"""Power of the angular velocity at 7 to 9 Hz over that at 0.4 to 3 Hz: 95 % of the stretches of clean motion have less than 0.2."""

SHAPES = (0.4, 0.6)
"""Power at 7 to 9 Hz over that at 3 to 5 Hz: what swings quickly and regularly is below."""

WHITES = (1.3, 1.4)
"""Power at 11 to 15 Hz over that at 7 to 9 Hz: above, noise is white, and the chain's smoother has taken what it could."""

CUTOFFS = (4.0, 7.5)
"""Hertz: lowest and highest cut-off where jitter is expected."""


def measured(rotations: Array, fps: float) -> NDArray[np.float64]:
    """Return what the kernel `tracker_noise` says of a clip whose gaps are filled."""
    whole, _ = ops().fill_gaps(rotations, -1, "slerp")
    return cast("NDArray[np.float64]", ops().tracker_noise(whole, fps))


def low_passed(
    cutoff: float, steps: Sequence[chain.Step], rotations: Array, translation: Array | None
) -> tuple[Array, Array | None]:
    """Filter with the cut-off for jitter of video, with the options that all steps share."""
    shared = {name: steps[-1].settings[name] for name in ("confidence", "gaps", "max_gap", "fps")}
    lost: Mask = np.zeros(len(rotations), np.bool_)
    path = translation
    if translation is not None:
        lost = np.asarray(np.isnan(translation).any(axis=1))
        path = None if lost.all() else straightened(translation, ~lost)
    clip = _spans.prepare(rotations, scalar_first=True, **shared)
    fps = float(shared["fps"])
    if clip.unchanged or cutoff >= fps / 2:
        return clip.finish(clip.rotations.copy()), translation
    reference = _development.reference_sigma(np.full(clip.rotations.shape[1], _REFERENCE * fps / cutoff))
    softness = (2 * math.sin(math.pi * cutoff / fps)) ** 6

    def low_pass(
        part: Array, along: Array | None, trust: Array | None, there: NDArray[np.intp]
    ) -> tuple[Array, Array | None]:
        # A filled sample counts as the straight line that it lies on, unless confidences were given.
        trust = trust if clip.weighed else None
        return cast(
            "tuple[Array, Array | None]", ops().low_pass(part, along, trust, reference[there], softness)
        )

    result, moved = _development.filtered(clip, path, low_pass)
    if moved is None:
        return result, translation
    if shared["gaps"] == "keep":
        moved[lost] = np.nan
    return result, moved


def filtered_along_time(
    steps: Sequence[chain.Step], rotations: Array, translation: Array | None = None
) -> tuple[Array, Array | None]:
    """Run a chain, and then the low pass where the recording jitters.

    The cut-off is one for the clip, that of the stretches that jitter; the share of the low pass goes from stretch to stretch along
    straight lines, and is 0 where a stretch is clean.

    Parameters
    ----------
    steps : sequence of chain.Step
        From `chain.plan`, with `fps` known.
    rotations : ndarray, shape (frames, joints, 4) or (frames, 4)
        Scalar first.
    translation : ndarray, shape (frames, 3), or None
        Of the root.

    Returns
    -------
    rotations, translation
        As `chain.run` returns them.
    """
    cleaned, moved = chain.run(steps, rotations, translation)
    fps = float(steps[-1].settings["fps"])
    shape = cleaned.shape
    clip = cleaned.reshape(len(cleaned), -1, 4)
    share, cutoff = _shares(rotations.reshape(clip.shape), fps)
    if not share.any() or cutoff >= fps / 2:
        return cleaned, moved
    shared = {"confidence": None, "gaps": "keep", "max_gap": 0.0, "fps": fps}
    calm, along = low_passed(cutoff, [chain.Step("smooth", shared)], clip, moved)
    clip = ops().drawn_towards(clip, calm, 1 - share)
    if moved is not None and along is not None:
        moved = (moved + share[:, None] * (along - moved)).astype(moved.dtype)
    return clip.reshape(shape), moved


def _shares(rotations: Array, fps: float) -> tuple[NDArray[np.float64], float]:
    """Return the low pass's share of each frame, and its cut-off in hertz."""
    frames = len(rotations)
    length = min(round(SECONDS * fps) + 1, frames)
    # Stretches overlap by half, and the last one ends with the clip.
    starts = np.unique(np.append(np.arange(0, frames - length + 1, max(length // 2, 1)), frames - length))
    found = np.array([_judged(measured(rotations[start : start + length], fps)) for start in starts])
    shares, cutoffs = found.T
    if not shares.any():
        return np.zeros(frames), math.inf
    share = np.interp(np.arange(frames), starts + (length - 1) / 2, shares)
    return share, float(np.average(cutoffs, weights=shares))


def _judged(measures: NDArray[np.float64]) -> tuple[float, float]:
    """Return the share of the low pass and its cut-off in hertz for what `tracker_noise` says of a stretch."""
    _, _, _, excess, shape, white = (float(measure) for measure in measures)
    share = _ramp(excess, *EXCESSES) * _ramp(shape, *SHAPES) * (1 - _ramp(white, *WHITES))
    # Clean motion falls as f^-1.45, white excess grows as f^2: they cross here.
    crossing = (123 / max(excess - 0.096, 1e-9)) ** (1 / 3.45)
    return share, min(max(crossing, CUTOFFS[0]), CUTOFFS[1])


def _ramp(x: float, low: float, high: float) -> float:
    return min(max((x - low) / (high - low), 0.0), 1.0)


__all__ = ["filtered_along_time", "low_passed", "measured"]
