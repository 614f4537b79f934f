"""The automatic method and the clock of the source: frames that were measured are cleaned, and lead back to all frames.

Trackers write files at other rates than they measure: frames are held, repeated, frozen, or interpolated. Filters take such frames for
measurements, and their noise for motion. Here the measured frames are found first, cleaned at their own rate, and the frames of
the clip are taken from a spline through the result.
"""

import functools
import math
import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal, TypeAlias, cast

import numpy as np
from numpy.typing import NDArray

from quatfilt import _validation, chain, jitter
from quatfilt._backend import ops
from quatfilt._typing import Array, Mask
from quatfilt.filters import _spans
from quatfilt.filters._paths import straightened
from quatfilt.presets import Jitter

Kind: TypeAlias = Literal["regular", "held", "repeated", "interpolated"]

KINDS: tuple[Kind, ...] = ("regular", "held", "repeated", "interpolated")
"""In the order of the kernels' numbers."""

UNKNOWN_RATE = 1.0
"""Default of `fps`: the frame rate is not known."""

SPLINE_CUTOFF = 7.0
"""Hertz: the spline through cleaned knots of an interpolated stream leaves half at this frequency."""

FEWEST = 4
"""Measurements of a stretch, at least, for it to be cleaned at the source's rate."""

MOST_EXCESS = 0.8
"""Power of the angular velocity at 7 to 9 Hz over that at 0.4 to 3 Hz above which the filters' own estimate of the noise is better
than a low pass."""

PAUSE = 2 / 3
"""Seconds: for so long an estimator of poses that lost a body repeats the last one; longer, and the source is frozen."""

FLIP = math.radians(90)
"""Angle between two frames of the root from which the whole body flips."""


Clean: TypeAlias = Callable[[Sequence[chain.Step], Array, Array | None], tuple[Array, Array | None]]
"""Cleans rotations and a translation with the options of steps."""


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
    steps: Sequence[chain.Step],
    rotations: Array,
    translation: Array | None = None,
    *,
    prior: Jitter = "doubted",
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
    prior : {"never", "doubted", "expected"}, default "doubted"
        Whether jitter that only estimates from video have is filtered, see `tracker_noise` of the reference. "doubted": where no person
        moves like that, decided for the clip; "expected": where it is likely, decided along time.

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
    if prior == "expected" and source.kind in ("regular", "repeated"):
        source = _without_pauses(source, PAUSE * fps)
    plain = source.kind == "regular" and not source.frozen.any()
    clean: Clean = chain.run
    if prior == "expected" and known:
        clean = jitter.filtered_along_time
    if prior == "doubted" and known:
        measured = clip if plain else at_measurements(clip, source)
        doubt, cutoff, _, excess, *_ = jitter.measured(measured, fps / source.spacing)
        if doubt > 0 and excess < MOST_EXCESS:
            clean = functools.partial(jitter.low_passed, cutoff)
    if plain:
        cleaned, moved = clean(steps, clip, translation)
    else:
        cleaned, moved = _at_measurements(clean, steps, clip, translation, source)
    if prior == "doubted" and known and clean is chain.run:
        cleaned, moved = _calm(cleaned, moved, source.frozen, fps)
    return cleaned.reshape(rotations.shape), moved


def _without_pauses(source: Source, longest: float) -> Source:
    """Take short freezes, in frames, for noise of the estimates: such frames are filtered with the rest."""
    frozen = source.frozen.copy()
    edges = np.flatnonzero(np.diff(np.concatenate([[False], frozen, [False]])))
    for start, end in zip(edges[::2], edges[1::2], strict=True):
        frozen[start:end] = end - start > longest
    return Source("regular", np.flatnonzero(~frozen).astype(np.float64), frozen)


def _at_measurements(
    clean: Clean, steps: Sequence[chain.Step], clip: Array, translation: Array | None, source: Source
) -> tuple[Array, Array | None]:
    """Clean each stretch between freezes at the rate of the source."""
    policy = steps[-1].settings["gaps"]
    # Options, and missing samples that are not to be there, are refused before anything is computed.
    chain.refuse_early(steps, clip)
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
        rotation, along = _resampled(_Cleaning(clean, steps, source), clip, translation, times, stretch)
        result[stretch] = rotation
        if moved is not None and along is not None:
            moved[stretch] = along
    if moved is not None and policy == "keep":
        moved[lost] = np.nan
    return result, moved


@dataclass(frozen=True)
class _Cleaning:
    """How a clip is cleaned: by what, with which options, and at which times."""

    clean: Clean
    steps: Sequence[chain.Step]
    source: Source


def _resampled(
    cleaning: _Cleaning,
    clip: Array,
    translation: Array | None,
    times: NDArray[np.float64],
    stretch: slice,
) -> tuple[Array, Array | None]:
    """Clean the measurements of a stretch, and lead back to its frames."""
    steps, source = cleaning.steps, cleaning.source
    fps = steps[0].settings["fps"]
    rate = fps if fps == UNKNOWN_RATE else fps / source.spacing
    frames = np.floor(times).astype(np.intp)
    # A cut-off above the Nyquist frequency of the source's rate leaves everything: such a step has nothing to do.
    below = [
        step for step in steps if "cutoff" not in step.chosen or np.max(step.chosen["cutoff"]) < rate / 2
    ]
    slower = [_for_frames(step, frames, len(clip), fps=rate) for step in below or steps[:1]]
    measured = ops().knots(clip, times)
    along = (
        None if translation is None else ops().knots(np.ascontiguousarray(translation[:, None]), times)[:, 0]
    )
    cleaned, moved = cleaning.clean(slower, measured, along)
    if len(times) == stretch.stop - stretch.start:
        return cleaned, moved
    # Cycles per frame.
    cutoff = SPLINE_CUTOFF / fps if source.kind == "interpolated" else 0.0
    every = np.arange(stretch.start, stretch.stop, dtype=np.float64)
    rotations = ops().spline(np.ascontiguousarray(cleaned), times, every, cutoff)
    if moved is None:
        return rotations, None
    return rotations, ops().spline(np.ascontiguousarray(moved[:, None]), times, every, cutoff)[:, 0]


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
    doubt, cutoff, *_ = jitter.measured(rotations, fps)
    if doubt <= 0:
        return rotations, translation
    live = rotations.copy()
    live[frozen] = np.nan
    shared = {"confidence": None, "gaps": "keep", "max_gap": 0.0, "fps": fps}
    calm, moved = jitter.low_passed(cutoff, [chain.Step("smooth", shared)], live, translation)
    calm[frozen] = rotations[frozen]
    if moved is not None and translation is not None:
        moved[frozen] = translation[frozen]
    return calm, moved


__all__ = ["Kind", "Source", "at_measurements", "flips", "recognised", "run"]
