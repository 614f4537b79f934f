"""The goal of the automatic method: better than the best classical filter that knows the truth.

Twenty recordings that nothing was tuned on, white noise of four levels. Against the automatic method stands, for each
recording and level, the best of all classical filters, each with the best of 17 settings on the better view of rotations.
"""

import itertools
import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from quatfilt._typing import Array
from quatfilt.denoise import denoise
from quatfilt.evaluation.clips import Clip
from quatfilt.evaluation.methods import CLASSICAL, ROWS, Clips
from quatfilt.evaluation.noises import IMPULSES, MAGNITUDE, Noise, versions
from quatfilt.evaluation.processes import computed
from quatfilt.evaluation.selection import best_of
from quatfilt.motion.metrics import angle_error, peak_velocity_kept, psnr
from quatfilt.noise.noise import add_impulse_noise

GOAL_CLIPS = {
    "02_02": "walk",
    "02_04": "jump, balance",
    "02_08": "swordplay",
    "03_01": "walk on uneven terrain",
    "05_03": "dance",
    "05_08": "dance",
    "05_14": "dance",
    "07_05": "slow walk",
    "07_09": "walk",
    "08_03": "walk",
    "08_07": "walk, long strides",
    "09_06": "run",
    "09_12": "walk to all sides",
    "13_30": "jumping jacks, squats, jog",
    "14_07": "jump up to grab, tiptoe",
    "14_10": "wash windows",
    "14_24": "direct traffic, wave, point",
    "16_11": "walk, veer left",
    "16_35": "run",
    "86_09": "walk, sit, look, stand up",
}
"""Recordings of CMU that are not used anywhere else. Named before anything was run on them; 86_02 and 86_08 were too, but
are not in our collection, and 86_09 and 02_02 are the next that are in it and not used elsewhere."""

LONGEST = 1500
"""Frames of each recording."""

MULTIPLES = (1, 5, 15, 30)
"""Levels of the noise, in units of `noises.SIGMA`."""

Method = Callable[[Array], Array]
"""Denoises rotations ``(frames, joints, 4)``; a function of a module, or a partial of one, so that processes find it."""


def automatic(name: str = "auto") -> Method:
    """Return what `denoise` runs under a name, without any option."""
    return partial(_denoised, name)


def _denoised(name: str, q: Array) -> Array:
    return denoise(q, method=name)


@dataclass(frozen=True)
class Outcome:
    """The automatic method and the classical filters on one recording with one level of noise; means over the seeds."""

    clip: str
    multiple: int
    noisy: float
    """Decibels, as the next two."""
    automatic: float
    classical: dict[str, float]
    """By row of `methods.ROWS`."""
    settings: dict[str, str]
    """What each of them chose."""
    peak_kept: float
    """By the automatic method."""
    best_peak_kept: float
    """By the best classical filter."""
    angle: float
    """Mean error of the automatic method, degrees."""
    angle_with_impulses: float
    """The same when 1 % of the noisy samples are hit by impulses besides."""

    @property
    def best(self) -> str:
        """The classical filter with the greatest PSNR."""
        return max(self.classical, key=lambda row: self.classical[row])

    @property
    def margin(self) -> float:
        """Decibels by which the automatic method is better than the best classical filter."""
        return self.automatic - self.classical[self.best]


def run(
    clips: Sequence[Clip],
    method: Method,
    *,
    seeds: int,
    multiples: Sequence[int] = MULTIPLES,
    rows: Sequence[str] = CLASSICAL,
    workers: int | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> list[Outcome]:
    """Run a method beside the classical filters.

    Parameters
    ----------
    clips : sequence of Clip
        Recordings.
    method : callable
        The automatic method.
    seeds : int
        How many noises of each level, at least 1.
    multiples : sequence of int
        Levels of the noise.
    rows : sequence of str
        The classical filters, of `methods.ROWS`.
    workers : int or None, default None
        Processes; None for one on each processor. 1 computes here.
    progress : callable or None, default None
        Is told how many of how many pieces are done.

    Returns
    -------
    list of Outcome
        By recording and level.
    """
    pieces = [
        (clip, multiple, method, seeds, tuple(rows)) for clip, multiple in itertools.product(clips, multiples)
    ]
    found: dict[int, Outcome] = {}
    for number, outcome in computed(
        _piece,
        pieces,
        workers=workers or os.cpu_count() or 1,
        sizes=[len(clip.motion) for clip, *_ in pieces],
    ):
        found[number] = outcome
        if progress is not None:
            progress(len(found), len(pieces))
    return [found[number] for number in sorted(found)]


def _piece(clip: Clip, multiple: int, method: Method, seeds: int, rows: Sequence[str]) -> Outcome:
    truth = clip.steady_rotations
    noise = Noise(f"{multiple}σ", multiple)
    noisy = versions(clip, noise, seeds)
    automatic = [method(q) for q in noisy]
    hit = [
        add_impulse_noise(
            q, probability=IMPULSES, magnitude=MAGNITUDE, rng=np.random.default_rng([seed, multiple, 1])
        )
        for seed, q in enumerate(noisy)
    ]
    beside = Clips.of(noisy, clip.motion.fps)
    classical: dict[str, float] = {}
    settings: dict[str, str] = {}
    kept: dict[str, float] = {}
    for row in rows:
        settings[row], estimates = best_of(ROWS[row].candidates(beside), truth, beside)
        classical[row] = _mean(psnr, truth, estimates)
        kept[row] = _mean(peak_velocity_kept, truth, estimates)
    return Outcome(
        clip=clip.name,
        multiple=multiple,
        noisy=_mean(psnr, truth, noisy),
        automatic=_mean(psnr, truth, automatic),
        classical=classical,
        settings=settings,
        peak_kept=_mean(peak_velocity_kept, truth, automatic),
        best_peak_kept=kept[max(classical, key=lambda row: classical[row])],
        angle=_mean(angle_error, truth, automatic),
        angle_with_impulses=_mean(angle_error, truth, [method(q) for q in hit]),
    )


def _mean(measure: Callable[..., object], truth: Array, estimates: Sequence[Array]) -> float:
    return float(np.mean([np.asarray(measure(truth, estimate)) for estimate in estimates]))


__all__ = ["GOAL_CLIPS", "LONGEST", "MULTIPLES", "Method", "Outcome", "automatic", "run"]
