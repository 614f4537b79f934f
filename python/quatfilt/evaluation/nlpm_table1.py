"""Table I of Dean and Lewis: what non-local pose means leave of noise that was added to clean clips.

The clips, the noise, the settings and the grid were fixed before the first run; only the rows called oracle choose by the
result.
"""

import itertools
import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from quatfilt._typing import Array
from quatfilt.evaluation.clips import Clip
from quatfilt.evaluation.measures import Measures, measure
from quatfilt.evaluation.methods import ROWS, Clips
from quatfilt.evaluation.noises import NOISES, Noise, versions
from quatfilt.evaluation.processes import computed
from quatfilt.evaluation.selection import best_of


@dataclass(frozen=True)
class Result:
    """A row on a clip with a noise: one set of measures for each seed."""

    clip: str
    fps: float
    noise: str
    row: str
    setting: str
    """What was chosen, where there was a choice."""
    measures: tuple[Measures, ...]


def run(
    clips: Sequence[Clip],
    *,
    seeds: int,
    noises: Sequence[Noise] = NOISES,
    rows: Sequence[str] = tuple(ROWS),
    workers: int | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> list[Result]:
    """Add noise, filter and measure.

    Parameters
    ----------
    clips : sequence of Clip
        From `clips.load`.
    seeds : int
        How many noises of each kind, at least 1.
    noises : sequence of Noise
        The columns.
    rows : sequence of str
        Which of `methods.ROWS`.
    workers : int or None, default None
        Processes; None for one on each processor. 1 computes here.
    progress : callable or None, default None
        Is told how many of how many pieces are done.

    Returns
    -------
    list of Result
        By clip, noise and row, in the order given.
    """
    pieces = [(clip, noise, seeds, tuple(rows)) for clip, noise in itertools.product(clips, noises)]
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


def _piece(clip: Clip, noise: Noise, seeds: int, rows: Sequence[str]) -> list[Result]:
    """Run rows on one clip with one kind of noise."""
    truth = clip.steady_rotations
    noisy = Clips.of(versions(clip, noise, seeds), clip.motion.fps)
    results = []
    for name in rows:
        setting, estimates = best_of(ROWS[name].candidates(noisy), truth, noisy)
        found = tuple(_measured(clip, estimate) for estimate in estimates)
        results.append(Result(clip.name, clip.motion.fps, noise.name, name, setting, found))
    return results


def _measured(clip: Clip, estimate: Array) -> Measures:
    rotations = clip.motion.rotations.copy()
    rotations[:, clip.steady] = estimate
    return measure(clip.motion, clip.motion.replace(rotations=rotations), joints=clip.steady)


__all__ = ["Result", "run"]
