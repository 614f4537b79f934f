"""Rotations as numbers that filters for numbers take, as users do it, and back.

Both views start from the path with continuous signs: what a user gets who knows that ``q`` and ``−q`` rotate alike. One
who does not gets jumps.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from quatfilt._typing import Array
from quatfilt.rotations.continuity import continuous
from quatfilt.rotations.mean import mean
from quatfilt.rotations.quaternion import conjugate, exp, log, multiply

Values: TypeAlias = NDArray[np.float64]


@dataclass(frozen=True)
class Channels:
    """A clip as numbers."""

    values: Values
    """``(frames, channels)``, float64."""
    rotations: Callable[[Values], Array]
    """Turns such numbers into unit quaternions ``(frames, joints, 4)``."""


def vectors(q: Array) -> Channels:
    """See rotation vectors from the mean of each joint, not folded back: they do not jump at half a turn.

    ``Rotation.as_rotvec`` of the clip as it is would, and is about the same elsewhere: the filters are spared that.
    """
    frames, joints = q.shape[:2]
    base = mean(q)[None]
    path = multiply(conjugate(base), continuous(q))
    # Of the two signs of the whole path, the one on the mean's side.
    path = path * np.where(path[..., 0].sum(axis=0) < 0, -1.0, 1.0)[:, None]

    def rotations(values: Values) -> Array:
        return multiply(base, exp(values.reshape(frames, joints, 3) / 2))

    return Channels(_numbers(2 * log(path)), rotations)


def components(q: Array) -> Channels:
    """See the four components; what comes back is made to have length 1."""
    frames, joints = q.shape[:2]

    def rotations(values: Values) -> Array:
        result = values.reshape(frames, joints, 4)
        length = np.linalg.norm(result, axis=-1, keepdims=True)
        return np.asarray(result / length)

    return Channels(_numbers(continuous(q)), rotations)


def _numbers(parts: Array) -> Values:
    return parts.reshape(len(parts), -1).astype(np.float64)


VIEWS: dict[str, Callable[[Array], Channels]] = {"vectors": vectors, "components": components}
"""How a filter for numbers may see rotations; the better counts."""

__all__ = ["VIEWS", "Channels", "Values", "components", "vectors"]
