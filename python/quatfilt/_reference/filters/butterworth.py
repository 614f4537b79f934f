"""Recursive filters, forwards and backwards: on rotations about their reference path."""

import numpy as np

from quatfilt._reference._arrays import Reals
from quatfilt._reference.filters.development import Columns, filtered


def butterworth(
    q: Reals,
    translation: Reals | None,
    confidence: Reals | None,
    reference_sigma: Reals,
    sections: Reals,
    states: Reals,
    padding: int,
) -> tuple[Reals, Reals | None]:
    """Run second-order sections over the vectors of :mod:`.development`, forwards and then backwards.

    Parameters
    ----------
    q : array (frames, joints, 4)
        Rotations without missing samples.
    translation : array (frames, 3) or None
        Positions of the root, filtered as joint 0.
    confidence : array (frames, joints) or None
        From 0 to 1: how far samples are believed rather than their local mean.
    reference_sigma : array (joints,), frames
        Deviation of the mask that makes the reference path.
    sections : array (joints, sections, 6)
        Coefficients `b0 b1 b2 a0 a1 a2` of each section, with `a0 = 1`.
    states : array (joints, sections, 2)
        States of the sections that have seen ones for ever.
    padding : int, frames
        How far the columns go on beyond both ends: turned about their end points. Clips have to be longer; in shorter ones it
        is one frame less than they have.

    Returns
    -------
    rotations : array (frames, joints, 4)
        Unit quaternions, continuous in sign from the hemisphere of the input's first frame.
    translation : array (frames, 3) or None
    """

    def smooth(columns: Columns, joint: int) -> Reals:
        beyond = min(padding, len(q) - 1)
        extended = turned_about_ends(columns.pulled(), beyond)
        forwards = run_sections(extended, sections[joint], states[joint])
        backwards = run_sections(forwards[::-1], sections[joint], states[joint])[::-1]
        return backwards[beyond : beyond + len(q)]

    return filtered(q, translation, confidence, reference_sigma, smooth)


def turned_about_ends(x: Reals, padding: int) -> Reals:
    """Continue columns by `padding < frames` frames at both ends, `x_{−n} = 2 x_0 − x_n`: values and slopes go on."""
    before = 2 * x[0] - x[padding:0:-1]
    after = 2 * x[-1] - x[-2 : -2 - padding : -1]
    return np.concatenate([before, x, after])


def run_sections(x: Reals, sections: Reals, states: Reals) -> Reals:
    """Run sections one after the other along columns, as if the first row had been there for ever.

    Direct form II, transposed: `y = b0 x + z0`, then `z0 = b1 x − a1 y + z1` and `z1 = b2 x − a2 y`.
    """
    result = x.copy()
    for (b0, b1, b2, _, a1, a2), state in zip(sections, states, strict=True):
        z0, z1 = state[0] * x[0], state[1] * x[0]
        for t, row in enumerate(result):
            y = b0 * row + z0
            z0 = b1 * row - a1 * y + z1
            z1 = b2 * row - a2 * y
            result[t] = y
    return result
