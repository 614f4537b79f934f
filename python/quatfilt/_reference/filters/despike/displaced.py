"""Displaced runs: samples that jump away and jump back, beside calm motion."""

from collections.abc import Callable

import numpy as np

from quatfilt._reference._arrays import Indices, Mask, Reals
from quatfilt._reference.filters.despike.place import distance

SHARP = 3.0
"""A jump is longer than so many of the steps beside it. No body starts and stops within one frame."""

CALM = 4
"""Steps beside a run that are compared with its jumps, at least: a run that is shorter than this is compared with so many."""

SURROUNDINGS = 3
"""Neighbours are looked for among so many lengths of a run on either side, or of `CALM` frames."""


def displaced(
    path: Reals, trust: Reals, trusted: Mask, lengths: range, least: Callable[[float], float]
) -> Mask:
    """Find the runs that a jump leads into and another jump leads out of.

    With the nearest trusted samples on either side, the shorter of the two jumps is longer than

    - `least` of the run's confidence;
    - `SHARP` times the longest step, per frame, beside it: within the run, and on either side among as many trusted samples as
      the run has, at least `CALM`. So a run is shorter than the calm motion around it;
    - the distance across the run: the joint comes back.

    Where the samples before the run, in it and after it are repeats of one another, the joint has to come back to the same sample. Short runs are found first, and
    are not trusted when longer ones are judged.

    Parameters
    ----------
    path : array (frames, 4) or (frames, 3)
        Unit quaternions or positions of one joint.
    trust : array (frames,)
        Confidences; a run has no sample of confidence 0.
    trusted : array (frames,) of bool
        Samples that can be neighbours.
    lengths : range, frames
        Lengths of runs.
    least : function
        From a confidence to the least length of a jump.

    Returns
    -------
    array (frames,) of bool
        The samples of displaced runs.
    """
    floor = least(float(np.min(trust, where=trust > 0, initial=1.0)))
    found = np.zeros(len(path), bool)
    known = np.flatnonzero(trusted)
    into, out = jumps(path, trust, known, floor)
    for length in lengths:
        runs = [
            slice(start, start + length)
            for start in into[np.isin(into + length, out)]
            if (trust[start : start + length] > 0).all()
            and is_displaced(
                path, known, start, start + length, least(float(trust[start : start + length].max()))
            )
        ]
        for run in runs:
            found[run] = True
        if runs:
            known = np.flatnonzero(trusted & ~found)
            into, out = jumps(path, trust, known, floor)
    return found


def is_displaced(path: Reals, known: Indices, start: int, end: int, least: float) -> bool:
    """Tell whether a run is displaced, given the trusted samples in order."""
    steps = max(end - start, CALM)
    earlier, later = known[known < start][-steps - 1 :], known[known >= end][: steps + 1]
    reach = SURROUNDINGS * steps
    if min(len(earlier), len(later)) <= steps or earlier[0] < start - reach or later[-1] >= end + reach:
        return False
    before, after = earlier[-1], later[0]
    jump = min(distance(path[before], path[start]), distance(path[end - 1], path[after]))
    parts = (earlier, np.arange(start, end), later)
    pace = max(longest_step(path, frames) for frames in parts)
    gap = max(start - before, after - end + 1)
    away = max(least, SHARP * gap * pace, float(distance(path[before], path[after])))
    held = all((path[frames] == path[frames[0]]).all() for frames in parts)
    return bool(jump > away and not (held and (path[before] != path[after]).any()))


def jumps(path: Reals, trust: Reals, known: Indices, least: float) -> tuple[Indices, Indices]:
    """Return the frames at which a run can start or end: farther than `least` from the nearest trusted sample beyond."""
    frames = np.arange(1, len(path))
    if len(known) == 0:
        return frames[:0], frames[:0]
    next_one = np.searchsorted(known, frames)
    before, after = known[np.maximum(next_one - 1, 0)], known[np.minimum(next_one, len(known) - 1)]
    into = (distance(path[before], path[frames]) > least) & (trust[frames] > 0)
    out = (distance(path[frames - 1], path[after]) > least) & (trust[frames - 1] > 0)
    return frames[into], frames[out]


def longest_step(path: Reals, frames: Indices) -> float:
    """Return the longest distance per frame from one of the frames to the next; 0 without any."""
    steps = distance(path[frames[1:]], path[frames[:-1]]) / np.diff(frames)
    return float(np.max(steps, initial=0.0))
