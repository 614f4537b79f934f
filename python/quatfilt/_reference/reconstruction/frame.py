"""Where a pose stands: heading about the up axis, and the place of the root.

The heading `h` of a rotation is its turn about the up axis `e`: of `q = (w, v)` the part `(w, (v·e) e)`, scaled to length
1. What is left, `h⁻¹ q`, turns about a horizontal axis, and `heading(a q) = a heading(q)` for every turn `a` about `e`.
"""

import numpy as np
from numpy.typing import NDArray

from quatfilt._reference._arrays import Reals

HORIZONTAL = ((1, 2), (2, 0), (0, 1))
"""The two level axes of each up axis, in the order in which a turn by 90 degrees about it takes the first to the second."""


def heading(q: Reals, up: int) -> Reals:
    """Angle of the turn about the up axis, in (−π, π], radians; `(..., 4)` → `(...)`; 0 where a body hangs head down."""
    angle: Reals = 2 * np.arctan2(q[..., 1 + up], q[..., 0])
    wrapped: Reals = angle - 2 * np.pi * np.round(angle / (2 * np.pi))
    return wrapped


def rotation_about(angle: float, up: int) -> NDArray[np.float64]:
    """Quaternion of a turn about the up axis by an angle in radians."""
    q = np.zeros(4)
    q[0], q[1 + up] = np.cos(angle / 2), np.sin(angle / 2)
    return q


def rotated(step: Reals, angle: float, up: int) -> NDArray[np.float64]:
    """Turn a step (along the two level axes) by a heading: 3 components."""
    first, second = HORIZONTAL[up]
    c, s = np.cos(angle), np.sin(angle)
    result = np.zeros(3)
    result[first] = c * step[0] - s * step[1]
    result[second] = s * step[0] + c * step[1]
    return result
