"""The neighbours of a run, and where they would have its samples."""

import numpy as np

from quatfilt._reference._arrays import Indices, Reals
from quatfilt._reference.filters.despike.place import distance, moved, step


def deviation(path: Reals, start: int, end: int, earlier: Indices, later: Indices) -> float:
    """How far a run is from where its neighbours would have it, at the sample and by the explanation that fit best.

    The explanations are: the sample is where its nearest neighbour on either side is (the joint rested, or jumped); on
    the straight line, in time, of the neighbours of either side (the motion goes on, and turns or jumps at the other end
    of the run); on the way from one side to the other (the motion goes through). NaN without a neighbour on either side.
    """
    if len(earlier) == 0 or len(later) == 0:
        return float("nan")
    a, b = path[earlier[0]], path[later[0]]
    t = np.arange(start, end)
    part = (t - earlier[0]) / (later[0] - earlier[0])
    across = moved(a, part[:, None] * step(a, b))
    explanations = [a, b, line(path, earlier, t), line(path, later, t), across]
    return float(min(np.min(distance(path[t], expected)) for expected in explanations))


def line(path: Reals, neighbours: Indices, t: Indices) -> Reals:
    """Where the straight line through neighbours is at frames `t`: that of least squares, as seen from the nearest."""
    nearest = path[neighbours[0]]
    vectors = step(nearest, path[neighbours])
    spread = neighbours - neighbours.mean()
    slope = spread @ vectors / max(spread @ spread, 1.0)
    return moved(nearest, vectors.mean(axis=0) + (t - neighbours.mean())[:, None] * slope)


def pace(path: Reals, earlier: Indices, later: Indices) -> float:
    """Median of the movements per frame from one neighbour to the next on its side; 0 without any.

    The median, because another spike among the neighbours moves up to half of them.
    """
    steps = [distance(path[side[1:]], path[side[:-1]]) / np.abs(np.diff(side)) for side in (earlier, later)]
    together = np.concatenate(steps)
    return float(np.median(together)) if len(together) else 0.0
