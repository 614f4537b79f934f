"""Swaps: two joints that change places for some frames, as when a tracker mistakes left for right."""

import numpy as np
from numpy.typing import NDArray

from quatfilt._reference._arrays import Indices, Reals
from quatfilt._reference.filters.despike.despike import DEVIATION_OF_NOISE
from quatfilt._reference.filters.despike.place import distance
from quatfilt._reference.rotations.quaternion import normalize

CLEAR = 2.0
"""Where two joints cross, each moves so many times as far as from the place of one to that of the other, at least."""


def find_swaps(
    q: Reals, confidence: Reals | None, noise: Reals, smallest: Reals, threshold: float, longest: int
) -> NDArray[np.int64]:
    """Find the frames in which two joints have changed places.

    Two joints `a` and `b` cross at the frame `t`, if their samples of `t − 1` and `t` have confidences above 0, if

        `min(d(a_{t−1}, a_t), d(b_{t−1}, b_t)) > CLEAR · max(d(a_{t−1}, b_t), d(b_{t−1}, a_t))`,

    and if each of them moves by more than its `smallest` and more than `threshold · 1.5 · noise`. A joint crosses one other at most: the
    pair with the smallest right side comes first.

    The two have changed places from one of their crossings to the next, if that lasts at most `longest` frames, and less than
    from the crossing before, or the start of the clip, and than to the crossing after, or the end of the clip.

    Parameters
    ----------
    q : array (frames, joints, 4)
        Rotations without missing samples.
    confidence : array (frames, joints) or None
        Confidences in [0, 1]; `None` stands for 1.
    noise, smallest, threshold
        As in :func:`.find_spikes`.
    longest : int, frames
        Swaps last no longer.

    Returns
    -------
    array (swaps, 4) of int
        The two joints, the first frame and the frame after the last; in order.
    """
    frames, joints = q.shape[:2]
    path = normalize(q.astype(np.float64))
    least = np.maximum(smallest, threshold * DEVIATION_OF_NOISE * noise)
    jumps = np.zeros((frames, joints), bool)
    jumps[1:] = distance(path[:-1], path[1:]) > least
    if confidence is not None:
        jumps[1:] &= (confidence[:-1] > 0) & (confidence[1:] > 0)
    crossings: dict[tuple[int, int], list[int]] = {}
    for t in np.flatnonzero(jumps.sum(axis=1) > 1):
        for pair in crossing(path[t - 1], path[t], np.flatnonzero(jumps[t])):
            crossings.setdefault(pair, []).append(int(t))
    found = [
        (*pair, start, end)
        for pair, times in crossings.items()
        for before, start, end, after in zip(
            [0, *times], times, times[1:], [*times[2:], frames], strict=False
        )
        if end - start <= longest and end - start < min(start - before, after - end)
    ]
    return np.array(sorted(found), np.int64).reshape(-1, 4)


def crossing(before: Reals, after: Reals, jumping: Indices) -> list[tuple[int, int]]:
    """Return the pairs of joints that cross between two poses `(joints, 4)`, among those that jump."""
    moved = distance(before[jumping], after[jumping])
    to = distance(before[jumping, None], after[None, jumping])
    apart = np.maximum(to, to.T)
    clear = np.minimum(moved[:, None], moved) > CLEAR * apart
    pairs = [(apart[i, j], i, j) for i, j in np.argwhere(np.triu(clear, 1))]
    result: list[tuple[int, int]] = []
    for _, i, j in sorted(pairs):
        pair = int(jumping[i]), int(jumping[j])
        if not set(pair) & {joint for other in result for joint in other}:
            result.append(pair)
    return result
