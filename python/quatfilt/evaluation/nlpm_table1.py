"""Table I of Dean and Lewis: what non-local pose means leave of noise that was added to clean clips.

The clips, the noise, the settings and the grid were fixed before the first run; only the rows called oracle choose by the
result.
"""

import itertools
import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from quatfilt._typing import Array
from quatfilt.evaluation.clips import Clip
from quatfilt.evaluation.measures import Measures, measure
from quatfilt.evaluation.methods import GRID, METHODS, NOISY, ORACLES
from quatfilt.evaluation.noises import NOISES, Noise
from quatfilt.evaluation.processes import computed
from quatfilt.filters.nonlocal_pose_means import nonlocal_pose_means
from quatfilt.motion.metrics import psnr


@dataclass(frozen=True)
class Result:
    """A method on a clip with a noise: one set of measures for each seed."""

    clip: str
    noise: str
    method: str
    bandwidth: float | None
    """Radians, where it is fixed or was chosen; None where the method takes it from the clip."""
    measures: tuple[Measures, ...]


def run(
    clips: Sequence[Clip],
    *,
    seeds: int,
    noises: Sequence[Noise] = NOISES,
    workers: int | None = None,
    progress: Callable[[int, int], None] | None = None,
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
    progress : callable or None, default None
        Is told how many of how many pieces are done.

    Returns
    -------
    list of Result
        By clip, noise and method, in the order of the table.
    """
    pieces = [(clip, noise, seeds) for clip, noise in itertools.product(clips, noises)]
    results: dict[int, list[Result]] = {}
    for number, result in computed(
        _piece,
        pieces,
        workers=workers or os.cpu_count() or 1,
        sizes=[len(clip.motion) for clip, *_ in pieces],
    ):
        results[number] = result
        if progress is not None:
            progress(len(results), len(pieces))
    return [result for number in sorted(results) for result in results[number]]


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


__all__ = ["Result", "run"]
