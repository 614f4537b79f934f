"""The automatic method on the noise of real trackers, and on clean motion.

Kinds of noise, levels and frame rates; `denoise`, its presets, two methods that people run today, and the best of the classical filters
with settings chosen by the truth. Whole motions are cleaned, so that feet count too; errors are those of the steady joints.
"""

import itertools
import os
import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from quatfilt._typing import Array
from quatfilt.denoise import denoise
from quatfilt.evaluation.clips import Clip, thinned
from quatfilt.evaluation.methods import ROWS, Clips
from quatfilt.evaluation.noise_kinds import KINDS, LEVELS, Body
from quatfilt.evaluation.processes import computed
from quatfilt.evaluation.selection import best_of
from quatfilt.motion.metrics import angle_error, foot_slide, peak_velocity_kept, psnr
from quatfilt.motion.motion import Motion
from quatfilt.presets import PRESETS

ROBUST_CLIPS = {
    "02_06": "bend over, scoop up, rise",
    "05_20": "dance, arabesque, jete",
    "07_03": "walk",
    "13_31": "jumping jacks, twists, jog",
    "14_12": "wash windows",
    "14_21": "climb three steps",
    "16_13": "walk, veer right",
    "16_57": "run, sudden stop",
}
"""Recordings of CMU that no constant was tuned on. Named before anything was run on them."""

LONGEST = 720
"""Frames of each recording at 120 frames per second: with all kinds and five seeds the table takes about 25 minutes on two processors."""

EVERY = (1, 2, 4)
"""One frame of so many: 120, 60 and 30 frames per second."""

CLASSICAL = tuple(
    f"{name}, oracle"
    for name in ("Gaussian", "Kalman (smoother)", "wavelet", "Butterworth", "Savitzky-Golay")
)
"""Rows of `methods.ROWS` whose best counts as the best classical filter."""

CLASSICAL_SEEDS = 2
"""Number of seeds that the classical filters see: each of them runs with 17 settings on two views of the rotations."""

AUTOMATIC, KALMAN, BUTTERWORTH = "denoise", "kalman", "bw6"

METHODS: Final[dict[str, dict[str, Any]]] = {
    AUTOMATIC: {},
    **{name: {"preset": name} for name in PRESETS},
    KALMAN: {"method": "kalman"},
    BUTTERWORTH: {"method": "butterworth", "cutoff": 6.0},
}
"""Columns: options of `denoise`."""

RIVALS = (KALMAN, BUTTERWORTH)
"""Columns that the automatic method is to be no worse than."""


@dataclass(frozen=True)
class Outcome:
    """One recording at one frame rate with one kind of noise of one level; means over the seeds."""

    clip: str
    fps: float
    kind: str
    level: float | None
    """Radians; None for a kind without levels."""
    noisy: float
    """PSNR of the input, decibels."""
    psnr: dict[str, float]
    """By column, decibels."""
    best: str
    """The classical filter with the greatest PSNR."""
    best_psnr: float
    peak_kept: float
    """Share of the peak angular speed in the automatic method's result."""
    slide: float
    """Foot slide of the automatic method's result, centimetres; NaN without feet."""
    slide_noisy: float
    slide_truth: float

    @property
    def margin(self) -> float:
        """Decibels of the automatic method over the better rival."""
        return self.psnr[AUTOMATIC] - max(self.psnr[name] for name in RIVALS)


@dataclass(frozen=True)
class Unchanged:
    """What a column makes of a clean recording."""

    clip: str
    fps: float
    method: str
    change: float
    """Mean change of the steady joints, degrees."""
    change_p95: float
    peak_kept: float
    slide: float
    """Centimetres; NaN without feet."""
    slide_truth: float


def run(
    clips: Sequence[Clip],
    *,
    seeds: int,
    kinds: Sequence[str] = tuple(KINDS),
    levels: Sequence[float] = LEVELS,
    every: Sequence[int] = EVERY,
    rows: Sequence[str] = CLASSICAL,
    workers: int | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> tuple[list[Outcome], list[Unchanged]]:
    """Clean noisy and clean recordings with every column.

    Parameters
    ----------
    clips : sequence of Clip
        Recordings at their full frame rate.
    seeds : int
        Number of noises of each kind and level, at least 1.
    kinds : sequence of str
        Names in `KINDS`.
    levels : sequence of float, radians
        Levels of the noise.
    every : sequence of int
        Frame rates, as the number of recorded frames per frame.
    rows : sequence of str
        The classical filters, of `methods.ROWS`.
    workers : int or None, default None
        Processes; None for one per processor. 1 computes in this process.
    progress : callable or None, default None
        Is called with the number of finished pieces and of all.

    Returns
    -------
    list of Outcome
        By recording, frame rate, kind and level.
    list of Unchanged
        By recording, frame rate and column.
    """
    slower = [thinned(clip, step) for clip, step in itertools.product(clips, every)]
    pieces: list[tuple[Any, ...]] = [
        (clip, kind, tuple(levels), seeds, tuple(rows)) for clip, kind in itertools.product(slower, kinds)
    ]
    pieces += [(clip, None, (), 0, ()) for clip in slower]
    found: dict[int, list[Outcome] | list[Unchanged]] = {}
    for number, results in computed(
        _piece,
        pieces,
        workers=workers or os.cpu_count() or 1,
        sizes=[len(clip.motion) * (1 if kind is None else seeds * len(levels)) for clip, kind, *_ in pieces],
    ):
        found[number] = results
        if progress is not None:
            progress(len(found), len(pieces))
    every_one = [one for number in sorted(found) for one in found[number]]
    return (
        [one for one in every_one if isinstance(one, Outcome)],
        [one for one in every_one if isinstance(one, Unchanged)],
    )


def _piece(
    clip: Clip, kind: str | None, levels: Sequence[float], seeds: int, rows: Sequence[str]
) -> list[Outcome] | list[Unchanged]:
    with warnings.catch_warnings():
        # Presets say what they need; the table says what it gave them.
        warnings.simplefilter("ignore", UserWarning)
        if kind is None:
            return [_unchanged(clip, name) for name in METHODS]
        chosen = levels if KINDS[kind].levelled else (None,)
        return [_outcome(clip, kind, level, seeds, rows) for level in chosen]


def versions(clip: Clip, kind: str, level: float | None, seeds: int) -> list[Motion]:
    """Return a clip with noises that the seed and the names of clip and kind choose."""
    body = Body.of(clip.motion.rotations.astype(np.float64), clip.motion.skeleton.names)
    return [
        clip.motion.replace(
            rotations=KINDS[kind].add(
                body, level or 0.0, np.random.default_rng([seed, *clip.name.encode(), *kind.encode()])
            )
        )
        for seed in range(seeds)
    ]


def _outcome(clip: Clip, kind: str, level: float | None, seeds: int, rows: Sequence[str]) -> Outcome:
    counted = KINDS[kind].counts(len(clip.motion))
    truth = clip.steady_rotations[counted]
    noisy = versions(clip, kind, level, seeds)

    def steady(motion: Motion) -> Array:
        return np.ascontiguousarray(motion.rotations[:, clip.steady])

    def mean(measure: Callable[[Array, Array], Any], estimates: Sequence[Array]) -> float:
        return float(np.mean([np.asarray(measure(truth, estimate[counted])) for estimate in estimates]))

    cleaned = {name: [denoise(motion, **options) for motion in noisy] for name, options in METHODS.items()}
    beside = Clips.of([steady(motion) for motion in noisy[:CLASSICAL_SEEDS]], clip.motion.fps)
    classical: dict[str, float] = {}
    for row in rows:
        # Settings are chosen on all frames; those that count are measured.
        _, estimates = best_of(ROWS[row].candidates(beside), clip.steady_rotations, beside)
        classical[row.removesuffix(", oracle")] = mean(psnr, estimates)
    best = max(classical, key=lambda row: classical[row])
    automatic = [steady(motion) for motion in cleaned[AUTOMATIC]]
    return Outcome(
        clip=clip.name,
        fps=clip.motion.fps,
        kind=kind,
        level=level,
        noisy=mean(psnr, [steady(motion) for motion in noisy]),
        psnr={name: mean(psnr, [steady(motion) for motion in motions]) for name, motions in cleaned.items()},
        best=best,
        best_psnr=classical[best],
        peak_kept=mean(peak_velocity_kept, automatic),
        slide=float(np.mean([_slide(motion, clip.motion) for motion in cleaned[AUTOMATIC]])),
        slide_noisy=float(np.mean([_slide(motion, clip.motion) for motion in noisy])),
        slide_truth=_slide(clip.motion, clip.motion),
    )


def _unchanged(clip: Clip, name: str) -> Unchanged:
    cleaned = denoise(clip.motion, **METHODS[name])
    before, after = clip.motion.rotations[:, clip.steady], cleaned.rotations[:, clip.steady]
    change = np.asarray(angle_error(before, after, per="sample"))
    return Unchanged(
        clip=clip.name,
        fps=clip.motion.fps,
        method=name,
        change=float(np.nanmean(change)),
        change_p95=float(np.nanpercentile(change, 95)),
        peak_kept=float(peak_velocity_kept(before, after)),
        slide=_slide(cleaned, clip.motion),
        slide_truth=_slide(clip.motion, clip.motion),
    )


def _slide(motion: Motion, reference: Motion) -> float:
    try:
        return float(foot_slide(motion, reference=reference))
    except ValueError:  # no joint is called a foot
        return float("nan")


__all__ = [
    "CLASSICAL_SEEDS",
    "EVERY",
    "LONGEST",
    "METHODS",
    "ROBUST_CLIPS",
    "Outcome",
    "Unchanged",
    "run",
    "versions",
]
