"""Table I of Dean and Lewis: what non-local pose means leave of noise that was added to clean clips.

The clips, the noise, the settings and the grid were fixed before the first run; only the rows called oracle choose by the
result.
"""

import itertools
import math
import os
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import dataclass
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np
from scipy.stats import chi

from quatfilt._backend import set_num_threads
from quatfilt._typing import Array, Mask
from quatfilt.errors import FileAccessError
from quatfilt.evaluation.measures import Measures, measure
from quatfilt.evaluation.synthetic import walk
from quatfilt.filters.nonlocal_pose_means import nonlocal_pose_means
from quatfilt.formats.files import read_motion
from quatfilt.motion.defects import find_defects
from quatfilt.motion.metrics import psnr
from quatfilt.motion.motion import Motion
from quatfilt.noise.noise import add_gaussian_noise, add_impulse_noise

CLIPS = {
    "07_01": "walk",
    "09_01": "run",
    "16_01": "jump",
    "14_02": "boxing",
    "86_01": "jumps, kicks and punches (long, mixed)",
}
"""Recordings of the CMU Graphics Lab Motion Capture Database, and what happens in them."""

SYNTHETIC = "synthetic"
"""Name of the built-in walk, for those who have no data."""

SIGMA = 0.016
"""Radians: the paper's σ = 0.008 of log-quaternions, as a rotation."""

MULTIPLES = (1, 5, 15, 30, 50, 75, 100)

IMPULSES = 0.01
MAGNITUDE = (math.radians(10), math.radians(60))

PAPER = {"search_radius": 10, "patch_radius": 5, "bandwidth": SIGMA}
"""Window of 21 poses, patch of 11, σ = 0.008."""

METHODS: dict[str, dict[str, Any]] = {
    "paper, mean": {**PAPER, "distance": "mean"},
    "paper, sum": {**PAPER, "distance": "sum"},
    "auto": {},
    "auto, per joint": {"weights": "joint"},
}
"""Rows with fixed settings; all else is the default of `nonlocal_pose_means`."""

GRID = tuple(SIGMA * 2 ** (half / 2) for half in range(-2, 15))
"""Bandwidths of the oracle rows, radians: 0.008 to 2.05 in steps of √2."""

ORACLES: dict[str, dict[str, Any]] = {
    "oracle": {},
    "oracle, per joint": {"weights": "joint"},
}
"""For each clip and noise the best bandwidth of the grid, by the mean PSNR over the seeds."""

NOISY = "noisy"


@dataclass(frozen=True)
class Noise:
    """One column of the table."""

    name: str
    multiple: int | None
    """Deviation in units of `SIGMA`; None for impulses."""

    @property
    def wrapped(self) -> float:
        """Share of the samples that the noise turns by more than half a turn: they come out as smaller turns."""
        return 0.0 if self.multiple is None else float(chi.sf(math.pi / (self.multiple * SIGMA), df=3))

    def add(self, q: Array, rng: np.random.Generator) -> Array:
        """Return noisy rotations."""
        if self.multiple is None:
            return add_impulse_noise(q, probability=IMPULSES, magnitude=MAGNITUDE, rng=rng)
        return add_gaussian_noise(q, sigma=self.multiple * SIGMA, rng=rng)


NOISES = (*(Noise(f"{multiple}σ", multiple) for multiple in MULTIPLES), Noise("impulses", None))


@dataclass(frozen=True)
class Clip:
    """A clip and which of its joints count."""

    name: str
    what: str
    motion: Motion
    steady: Mask


@dataclass(frozen=True)
class Result:
    """A method on a clip with a noise: one set of measures for each seed."""

    clip: str
    noise: str
    method: str
    bandwidth: float | None
    """Radians, where it is fixed or was chosen; None where the method takes it from the clip."""
    measures: tuple[Measures, ...]


def load(data: Path | None) -> list[Clip]:
    """Read the clips of the table from a folder, or make the walk.

    Parameters
    ----------
    data : Path or None
        Folder that holds ``07_01.amc`` and the others, at any depth; None for the built-in walk.

    Returns
    -------
    list of Clip
        In the order of the table.

    Raises
    ------
    QuatfiltError
        If a clip is not there or does not open.
    """
    if data is None:
        return [_clip(SYNTHETIC, "walk", walk(seconds=8))]
    if not data.is_dir():
        raise FileAccessError(data, "expected a folder of motion capture")
    return [_clip(name, what, read_motion(_find(data, name))) for name, what in CLIPS.items()]


def _find(data: Path, name: str) -> Path:
    found = sorted(data.rglob(f"{name}.amc"))
    if not found:
        raise FileAccessError(data, f"expected {name}.amc in this folder or below it")
    return found[0]


def _clip(name: str, what: str, motion: Motion) -> Clip:
    return Clip(name, what, motion, find_defects(motion.rotations, fps=motion.fps).steady)


def run(
    clips: Sequence[Clip],
    *,
    seeds: int,
    noises: Sequence[Noise] = NOISES,
    workers: int | None = None,
    progress: Callable[[int, int], None] = lambda done, total: None,
) -> list[Result]:
    """Add noise, filter and measure.

    Parameters
    ----------
    clips : sequence of Clip
        From `load`.
    seeds : int
        How many noises of each kind, at least 1.
    noises : sequence of Noise
        The columns.
    workers : int or None, default None
        Processes; None for one on each processor. 1 computes here.
    progress : callable
        Is told how many of how many pieces are done.

    Returns
    -------
    list of Result
        By clip, noise and method, in the order of the table.
    """
    pieces = [(clip, noise, seeds) for clip, noise in itertools.product(clips, noises)]
    results: dict[int, list[Result]] = {}
    for number, result in _computed(pieces, workers or os.cpu_count() or 1):
        results[number] = result
        progress(len(results), len(pieces))
    return [result for number in sorted(results) for result in results[number]]


def _computed(pieces: Sequence[tuple[Clip, Noise, int]], workers: int) -> Iterator[tuple[int, list[Result]]]:
    if workers == 1:
        for number, piece in enumerate(pieces):
            yield number, _piece(*piece)
        return
    # Spawned, because the threads of this process would not survive a fork; the longest clips first.
    with ProcessPoolExecutor(
        workers, mp_context=get_context("spawn"), initializer=set_num_threads, initargs=(1,)
    ) as pool:
        order = sorted(range(len(pieces)), key=lambda number: -len(pieces[number][0].motion))
        numbers = {pool.submit(_piece, *pieces[number]): number for number in order}
        try:
            for future in as_completed(numbers):
                yield numbers[future], future.result()
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise


def _piece(clip: Clip, noise: Noise, seeds: int) -> list[Result]:
    """Run all methods on one clip with one kind of noise."""
    truth = np.ascontiguousarray(clip.motion.rotations[:, clip.steady])
    noisy = [
        noise.add(truth, np.random.default_rng([seed, *clip.name.encode(), *noise.name.encode()]))
        for seed in range(seeds)
    ]

    def result(method: str, bandwidth: float | None, estimates: list[Array]) -> Result:
        found = tuple(_measured(clip, estimate) for estimate in estimates)
        return Result(clip.name, noise.name, method, bandwidth, found)

    results = [result(NOISY, None, noisy)]
    for method, options in METHODS.items():
        estimates = [nonlocal_pose_means(q, **options) for q in noisy]
        results.append(result(method, options.get("bandwidth"), estimates))
    for method, options in ORACLES.items():
        best = max(
            GRID,
            key=lambda bandwidth: np.mean(
                [psnr(truth, nonlocal_pose_means(q, bandwidth=bandwidth, **options)) for q in noisy]
            ),
        )
        results.append(
            result(method, best, [nonlocal_pose_means(q, bandwidth=best, **options) for q in noisy])
        )
    return results


def _measured(clip: Clip, estimate: Array) -> Measures:
    rotations = clip.motion.rotations.copy()
    rotations[:, clip.steady] = estimate
    return measure(clip.motion, clip.motion.replace(rotations=rotations), joints=clip.steady)


__all__ = [
    "CLIPS",
    "GRID",
    "METHODS",
    "NOISES",
    "NOISY",
    "ORACLES",
    "SIGMA",
    "SYNTHETIC",
    "Clip",
    "Noise",
    "Result",
    "load",
    "run",
]
