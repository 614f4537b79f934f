"""The automatic method and the clock of the source: frames that were measured are cleaned, and lead back to all frames.

Trackers write files at other rates than they measure: frames are held, repeated, frozen, or interpolated. Filters take such frames for
measurements, and their noise for motion. Here the measured frames are found first, cleaned at their own rate, and the frames of
the clip are taken from a spline through the result.
"""

import math
import warnings
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal, TypeAlias, cast

import numpy as np
from numpy.typing import NDArray

from quatfilt import _validation, chain
from quatfilt._backend import ops
from quatfilt._typing import Array, Mask
from quatfilt.filters import _development, _spans
from quatfilt.filters._paths import straightened

Kind: TypeAlias = Literal["regular", "held", "repeated", "interpolated"]

KINDS: tuple[Kind, ...] = ("regular", "held", "repeated", "interpolated")
"""In the order of the kernels' numbers."""

UNKNOWN_RATE = 1.0
"""Default of `fps`: the frame rate is not known."""

SPLINE_CUTOFF = 7.0
"""Hertz: the spline through cleaned knots of an interpolated stream leaves half at this frequency."""

FEWEST = 4
"""Measurements of a stretch, at least, for it to be cleaned at the source's rate."""

FLIP = math.radians(90)
"""Angle between two frames of the root from which the whole body flips."""

_REFERENCE = 0.13
"""Deviation of the reference path's Gaussian in periods of the cut-off, as for `butterworth`."""


@dataclass(frozen=True)
class Source:
    """The clock of a clip's source.

    Parameters
    ----------
    kind : {"regular", "held", "repeated", "interpolated"}
        Every frame was measured; at most every second one was; single frames repeat the one before; frames lie on geodesics between
        measurements.
    times : ndarray, shape (n,), frames
        When the source measured, frozen stretches left out.
    frozen : ndarray of bool, shape (frames,)
        Stretches in which the source wrote no new frame.
    """

    kind: Kind
    times: NDArray[np.float64]
    frozen: Mask

    @property
    def spacing(self) -> float:
        """Median distance between measurements in frames; 1 for sources without any."""
        return float(np.median(np.diff(self.times))) if len(self.times) > 1 else 1.0

    @property
    def stretches(self) -> list[slice]:
        """Frames between frozen stretches."""
        edges = np.flatnonzero(np.diff(np.concatenate([[False], ~self.frozen, [False]])))
        return [slice(int(start), int(end)) for start, end in zip(edges[::2], edges[1::2], strict=True)]

    @property
    def repeated(self) -> int:
        """Frames that repeat the one before, outside of frozen stretches."""
        live = int(np.count_nonzero(~self.frozen))
        return live - len(self.times) if self.kind in ("held", "repeated") else 0

    def says(self, fps: float | None) -> str:
        """Return the source in words, with its rate where `fps` is known; empty if every frame was measured."""
        every = f"every {self.spacing:.3g} frames"
        if fps is not None:
            every += f" ({fps / self.spacing:.3g} per second)"
        notes = {
            "regular": "",
            "held": f"held source: a new frame {every}",
            "repeated": f"repeated frames: {self.repeated}",
            "interpolated": f"interpolated source: measured {every}, geodesics between",
        }
        frozen = int(np.count_nonzero(self.frozen))
        freezes = f"frozen frames: {frozen} in {self.freezes}" if frozen else ""
        return "; ".join(part for part in (notes[self.kind], freezes) if part)

    @property
    def freezes(self) -> int:
        """Number of frozen stretches."""
        return int(np.count_nonzero(np.diff(np.concatenate([[False], self.frozen]).astype(int)) > 0))


def recognised(rotations: Array, fps: float) -> Source:
    """Find the frames of a clip ``(frames, joints, 4)`` that its source measured."""
    kind, times, frozen = ops().sampling(rotations, fps)
    return Source(KINDS[kind], times, frozen)


def at_measurements(rotations: Array, source: Source) -> Array:
    """Return what a source measured of a clip ``(frames, joints, 4)``; ``(n, joints, 4)``."""
    return cast("Array", ops().knots(rotations, source.times))


def flips(rotations: Array) -> int:
    """Return how often the root of a clip ``(frames, joints, 4)`` turns by more than 90° from one frame to the next."""
    if len(rotations) < 2 or rotations.shape[1] == 0:
        return 0
    root = np.ascontiguousarray(rotations[:, :1])
    with np.errstate(invalid="ignore"):
        return int(np.count_nonzero(ops().geodesic_distance(root[:-1], root[1:]) > FLIP))


def run(
    steps: Sequence[chain.Step], rotations: Array, translation: Array | None = None, *, calmed: bool = True
) -> tuple[Array, Array | None]:
    """Run filters at the rate of the source, and then the low pass for noise that looks like motion.

    Parameters
    ----------
    steps : sequence of chain.Step
        From `chain.plan`.
    rotations : ndarray, shape (frames, joints, 4) or (frames, 4)
        Scalar first.
    translation : ndarray, shape (frames, 3), or None
        Of the root.
    calmed : bool, default True
        Whether jitter that only estimates from video have is filtered, see `tracker_noise` of the reference.

    Returns
    -------
    rotations, translation
        As `chain.run` returns them.
    """
    clip, _ = _validation.clip(rotations)
    fps = _validation.number(steps[0].settings["fps"], "fps", above=0)
    known = fps != UNKNOWN_RATE
    source = recognised(clip, fps)
    if source.kind == "interpolated" and not known:
        warnings.warn(
            "rotations: the frames are interpolated between measurements; pass fps= (frames per second) to have them cleaned",
            UserWarning,
            stacklevel=4,
        )
        source = replace(source, kind="regular")
    if source.kind == "regular" and not source.frozen.any():
        cleaned, moved = chain.run(steps, rotations, translation)
    else:
        cleaned, moved = _at_measurements(steps, clip, translation, source)
    if calmed and known:
        calm, moved = _calm(cleaned.reshape(clip.shape), moved, source.frozen, fps)
        cleaned = calm
    return cleaned.reshape(rotations.shape), moved


def _at_measurements(
    steps: Sequence[chain.Step], clip: Array, translation: Array | None, source: Source
) -> tuple[Array, Array | None]:
    """Clean each stretch between freezes at the rate of the source."""
    policy = steps[-1].settings["gaps"]
    # Options, and missing samples that are not to be there, are refused before anything is computed.
    chain.run(steps, clip[:0], None)
    if policy == "raise":
        _spans.prepare(clip, gaps=policy, max_gap=None, fps=1.0, confidence=None, scalar_first=True)
    result = clip.copy()
    lost: Mask = np.zeros(len(clip), np.bool_)
    if translation is not None:
        lost = np.asarray(np.isnan(translation).any(axis=1))
        translation = None if lost.all() else straightened(translation, ~lost)
    moved = None if translation is None else translation.copy()
    for stretch in source.stretches:
        times = source.times[(source.times >= stretch.start) & (source.times <= stretch.stop - 1)]
        if len(times) < FEWEST:
            continue
        if source.kind in ("held", "interpolated"):
            rotation, along = _resampled(steps, clip, translation, source, times, stretch)
        else:
            rotation, along = _without_repeats(steps, clip, translation, times, stretch)
        result[stretch] = rotation
        if moved is not None and along is not None:
            moved[stretch] = along
    if moved is not None and policy == "keep":
        moved[lost] = np.nan
    return result, moved


def _resampled(
    steps: Sequence[chain.Step],
    clip: Array,
    translation: Array | None,
    source: Source,
    times: NDArray[np.float64],
    stretch: slice,
) -> tuple[Array, Array | None]:
    """Clean the measurements of a stretch, and lead back to its frames."""
    fps = steps[0].settings["fps"]
    rate = fps if fps == UNKNOWN_RATE else fps / source.spacing
    frames = np.floor(times).astype(np.intp)
    slower = [_for_frames(step, frames, len(clip), fps=rate) for step in steps]
    measured = ops().knots(clip, times)
    along = None if translation is None else ops().knots(np.ascontiguousarray(translation[:, None]), times)[:, 0]
    cleaned, moved = chain.run(slower, measured, along)
    # Cycles per frame.
    cutoff = SPLINE_CUTOFF / fps if source.kind == "interpolated" else 0.0
    every = np.arange(stretch.start, stretch.stop, dtype=np.float64)
    rotations = ops().spline(np.ascontiguousarray(cleaned), times, every, cutoff)
    if moved is None:
        return rotations, None
    return rotations, ops().spline(np.ascontiguousarray(moved[:, None]), times, every, cutoff)[:, 0]


def _without_repeats(
    steps: Sequence[chain.Step],
    clip: Array,
    translation: Array | None,
    times: NDArray[np.float64],
    stretch: slice,
) -> tuple[Array, Array | None]:
    """Clean a stretch whose repeated frames count as missing, but are there in the result."""
    frames = np.arange(stretch.start, stretch.stop)
    repeated = ~np.isin(frames, times.astype(np.intp))
    own = [_for_frames(step, frames, len(clip)) for step in steps]
    policy = steps[-1].settings["gaps"]
    given = clip[stretch].copy()
    missing = ~np.isfinite(given).all(axis=-1) | (given == 0).all(axis=-1)
    if policy == "keep" or not missing.any():
        own = [replace(step, chosen={**step.chosen, "gaps": "fill"}) for step in own]
    rotations = given.copy()
    rotations[repeated] = np.nan
    along = None if translation is None else translation[stretch].copy()
    if along is not None:
        along[repeated] = np.nan
    cleaned, moved = chain.run(own, rotations, along)
    lost = ~missing & np.isnan(cleaned).any(axis=-1)
    cleaned[lost] = given[lost]
    if policy == "keep":
        cleaned[missing] = np.nan
    if moved is not None and translation is not None:
        lost_path = np.isnan(moved).any(axis=-1)
        moved[lost_path] = translation[stretch][lost_path]
    return cleaned, moved


def _for_frames(step: chain.Step, frames: NDArray[np.intp], count: int, **changes: Any) -> chain.Step:
    """Return a step for some frames of a clip: their confidence alone, and other options."""
    confidence = step.settings.get("confidence")
    if confidence is not None:
        array = np.asarray(confidence)
        if len(array) == count:
            changes["confidence"] = array[frames]
    return replace(step, chosen={**step.chosen, **changes})


def _calm(
    rotations: Array, translation: Array | None, frozen: Mask, fps: float
) -> tuple[Array, Array | None]:
    """Filter jitter that only estimates from video have, outside of freezes."""
    doubt, cutoff, *_ = ops().tracker_noise(np.ascontiguousarray(rotations), fps)
    if doubt <= 0 or cutoff >= fps / 2:
        return rotations, translation
    live = rotations.copy()
    live[frozen] = np.nan
    clip = _spans.prepare(live, gaps="keep", max_gap=0.0, fps=fps, confidence=None, scalar_first=True)
    reference = _development.reference_sigma(np.full(clip.rotations.shape[1], _REFERENCE * fps / cutoff))
    softness = (2 * math.sin(math.pi * cutoff / fps)) ** 6

    def low_pass(
        part: Array, along: Array | None, trust: Array | None, there: NDArray[np.intp]
    ) -> tuple[Array, Array | None]:
        return cast(
            "tuple[Array, Array | None]", ops().low_pass(part, along, trust, reference[there], softness)
        )

    known = translation is not None and np.isfinite(translation).all()
    calm, moved = _development.filtered(clip, translation if known else None, low_pass)
    calm[frozen] = rotations[frozen]
    if moved is not None and translation is not None:
        moved[frozen] = translation[frozen]
    return calm, moved if known else translation


__all__ = ["Kind", "Source", "at_measurements", "flips", "recognised", "run"]
