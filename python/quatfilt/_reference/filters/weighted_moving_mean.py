"""Blender's "Smooth Keys": a weighted moving mean over five frames, on rotations about their reference path."""

import numpy as np

from quatfilt._reference._arrays import Reals
from quatfilt._reference.filters.development import Columns, filtered


def weighted_moving_mean(
    q: Reals,
    translation: Reals | None,
    confidence: Reals | None,
    reference_sigma: Reals,
    iterations: int,
) -> tuple[Reals, Reals | None]:
    """Average the vectors of :mod:`.development` over five frames, `iterations` times.

    Parameters
    ----------
    q : array (frames, joints, 4)
        Rotations without missing samples.
    translation : array (frames, 3) or None
        Positions of the root, filtered alike.
    confidence : array (frames, joints) or None
        From 0 to 1: how far samples are believed rather than their local mean.
    reference_sigma : array (joints,), frames
        Deviation of the mask that makes the reference path.
    iterations : int
        How often the filter is applied.

    Returns
    -------
    rotations : array (frames, joints, 4)
        Unit quaternions, continuous in sign from the hemisphere of the input's first frame.
    translation : array (frames, 3) or None
    """

    def smooth(columns: Columns, _joint: int) -> Reals:
        result = columns.pulled()
        for _ in range(iterations):
            result = smoothed_keys(result)
        return result

    return filtered(q, translation, confidence, reference_sigma, smooth)


def smoothed_keys(x: Reals) -> Reals:
    """Mean of what Blender calls the previous and the next value, for columns `(frames, 3)`.

    The end frames stay. Where the second neighbour lies beyond an end, the first one stands for it; Blender, which asks for
    `i − 2 > 0`, does so at frame 2 as well.
    """
    i = np.arange(1, len(x) - 1)
    p1, c, n1 = x[i - 1], x[i], x[i + 1]
    p2 = x[np.where(i - 2 > 0, i - 2, i - 1)]
    n2 = x[np.where(i + 2 < len(x), i + 2, i + 1)]
    before = (3 * p2 + 5 * p1 + 2 * c + n1 + n2) / 12
    after = (p2 + p1 + 2 * c + 5 * n1 + 3 * n2) / 12
    result = x.copy()
    result[i] = (before + after) / 2
    return result
