"""Frames that turn along with a spinning joint.

The signs of quaternions, and their averages in R⁴, need neighbours that lie close together. A joint that turns steadily, `q_t =
b · exp(ω t / 2)`, is brought to rest from both sides, half from each,

    `p_t = L_t⁻¹ · q_t · S_t⁻¹`,    `L_0 = S_0 = 1`,    `L_{t+1} = exp(Ω_t / 4) · L_t`,    `S_{t+1} = S_t · exp(ω_t / 4)`,

with the means `ω_t` and `Ω_t` of the turns from frame to frame as the body sees them, and as the world does: the noise of single
frames cancels in them, the spin stays. So the inverse of a path has the inverse `p`, and constant rotations on either side, or time
that runs backwards, change `p` by constant rotations alone.
"""

import numpy as np

from quatfilt._reference._arrays import Reals
from quatfilt._reference.filters.columns import weighted_mean
from quatfilt._reference.motion.skeleton import rotate
from quatfilt._reference.rotations.quaternion import between, exp, log_short, multiply, normalize

FAST = 1.5
"""Radians within a deviation of the mask: a joint that turns as steadily and faster spins. Averages of slower turns are long, and
neighbours keep their signs."""


def mean_turns(path: Reals, trust: Reals | None, mask: Reals) -> tuple[Reals, Reals]:
    """Average the turns from frame to frame, the shorter way, of one joint `(frames, 4)`.

    Turns from or to a sample that is less trusted weigh less; those of no weight are none.

    Returns
    -------
    of_world, of_body : array (frames − 1, 3), radians
    """
    turns = 2 * log_short(between(path[:-1], path[1:]))
    weights = None if trust is None else trust[:-1] * trust[1:]
    if weights is not None:
        turns[weights == 0] = 0
    both = rotate(path[:-1], turns), turns
    of_world, of_body = (weighted_mean(way, weights, mask, "nearest") for way in both)
    return of_world, of_body


def rolled(turns: Reals) -> Reals:
    """Roll out halves of turns `(frames − 1, 3)`: `S` of `ω`, and `L⁻¹` of `−Ω`; unit quaternions `(frames, 4)`."""
    result = np.zeros((len(turns) + 1, 4))
    result[0, 0] = 1
    for t, step in enumerate(exp(turns / 4)):
        result[t + 1] = normalize(multiply(result[t], step))
    return result
