"""Clips continued beyond their ends.

`"nearest"` holds the end frame, `"mirror"` reflects the clip at its end frame, which is not repeated (as often as the
padding asks for), and `"linear"` goes on with the velocity that the clip has at its end.
"""

from typing import Literal

import numpy as np

from quatfilt._reference._arrays import Reals
from quatfilt._reference.rotations.quaternion import between, exp, log_short, multiply

Boundary = Literal["mirror", "linear", "nearest"]


def extend_rotations(q: Reals, padding: int, boundary: Boundary) -> Reals:
    """Continue a clip of at least two frames by `padding` frames at both ends; unit quaternions `(frames, joints, 4)`.

    With `"linear"`, `q_{−n} = q_0 · exp(−n log(q_0⁻¹ q_1))` and `q_{T−1+n} = q_{T−1} · exp(n log(q_{T−2}⁻¹ q_{T−1}))`,
    each increment taken the shorter way. If the clip is continuous in sign, so is its continuation.
    """
    if boundary != "linear":
        return extend_by_index(q, padding, boundary)
    steps = np.arange(1, padding + 1)[:, None, None]
    first = log_short(between(q[0], q[1]))
    last = log_short(between(q[-2], q[-1]))
    before = multiply(q[:1], exp(-steps[::-1] * first))
    after = multiply(q[-1:], exp(steps * last))
    return np.concatenate([before, q, after])


def extend_vectors(x: Reals, padding: int, boundary: Boundary) -> Reals:
    """Continue vectors `(frames, 3)`, at least two frames, by `padding` frames at both ends; `"linear"`: straight on."""
    if boundary != "linear":
        return extend_by_index(x, padding, boundary)
    steps = np.arange(1, padding + 1)[:, None]
    before = x[:1] - steps[::-1] * (x[1] - x[0])
    after = x[-1:] + steps * (x[-1] - x[-2])
    return np.concatenate([before, x, after])


def extend_by_index(x: Reals, padding: int, boundary: Boundary) -> Reals:
    """Continue any frames by copies of the clip's own ones; with `"linear"` too, the end's value is held."""
    mode: Literal["reflect", "edge"] = "reflect" if boundary == "mirror" else "edge"
    return x[np.pad(np.arange(len(x)), padding, mode=mode)]
