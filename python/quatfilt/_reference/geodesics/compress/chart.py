"""Principal geodesic coordinates: a rotation as three successive rotations about the axes of a frame.

    q = c · exp(s₁ v₁) · exp(s₂ v₂) · exp(s₃ v₃)

with orthonormal `v`. A frame is two quaternions: the centre `c`, and `a`, which turns x, y and z into the axes. With
`p = a⁻¹ c⁻¹ q a = exp(s₁ x) exp(s₂ y) exp(s₃ z)`,

    p_w + p_y = (cos s₂ + sin s₂) cos(s₁ + s₃)        p_w − p_y = (cos s₂ − sin s₂) cos(s₁ − s₃)
    p_x + p_z = (cos s₂ + sin s₂) sin(s₁ + s₃)        p_x − p_z = (cos s₂ − sin s₂) sin(s₁ − s₃)

so three geodesics reach every rotation, and the coordinates have every digit everywhere. Both radii may change their sign: then the
path goes on straight through the points where an angle is not defined, and as far about the first axis as it likes.
"""

import numpy as np

from quatfilt._reference.geodesics.compress.arithmetic import Doubles, atan2, round_even, sin_cos
from quatfilt._reference.rotations.quaternion import between

TINY_SQUARE = 1e-200
"""Keeps the quotients of sines and angles from 0/0."""


def coordinates(q: Doubles, centre: Doubles, axes: Doubles) -> Doubles:
    """Coordinates of a path, `(n, 4)` → `(n, 3)`: `s`, half of the angles, without jumps where the path has none."""
    folded = np.where(q[:, :1] < 0.0, -q, q)
    w, x, y, z = product(product(conjugate(product(centre, axes)), folded), axes).T
    upper_x, upper_y, lower_x, lower_y = w + y, x + z, w - y, x - z
    upper, turns_upper = _unwrapped(atan2(upper_y, upper_x), np.pi)
    lower, turns_lower = _unwrapped(atan2(lower_y, lower_x), np.pi)
    radius_upper = _signed(np.sqrt(upper_x * upper_x + upper_y * upper_y), turns_upper)
    radius_lower = _signed(np.sqrt(lower_x * lower_x + lower_y * lower_y), turns_lower)
    middle, _ = _unwrapped(atan2(radius_upper - radius_lower, radius_upper + radius_lower), np.pi)
    return np.stack([(upper + lower) * 0.5, middle, (upper - lower) * 0.5], axis=-1)


def rotations(s: Doubles, centre: Doubles, axes: Doubles) -> Doubles:
    """Rotations with these coordinates, `(n, 3)` → `(n, 4)`."""
    (s1, c1), (s2, c2), (s3, c3) = (sin_cos(column) for column in s.T)
    p = np.stack(
        [
            c1 * c2 * c3 - s1 * s2 * s3,
            s1 * c2 * c3 + c1 * s2 * s3,
            c1 * s2 * c3 - s1 * c2 * s3,
            c1 * c2 * s3 + s1 * s2 * c3,
        ],
        axis=-1,
    )
    return product(product(product(centre, axes), p), conjugate(axes))


def angles(a: Doubles, b: Doubles) -> Doubles:
    """Rotation angles between rotations of any length, `(n, 4)` and `(n, 4)` → `(n,)`."""
    w, x, y, z = between(a, b).T
    return 2.0 * atan2(np.sqrt(x * x + y * y + z * z), np.abs(w))


def product(a: Doubles, b: Doubles) -> Doubles:
    """Hamilton product, its sums from left to right."""
    (aw, ax, ay, az), (bw, bx, by, bz) = np.moveaxis(a, -1, 0), np.moveaxis(b, -1, 0)
    return np.stack(
        [
            aw * bw - ax * bx - ay * by - az * bz,
            aw * bx + ax * bw + ay * bz - az * by,
            aw * by - ax * bz + ay * bw + az * bx,
            aw * bz + ax * by - ay * bx + az * bw,
        ],
        axis=-1,
    )


def conjugate(q: Doubles) -> Doubles:
    """Conjugate, the inverse of a unit quaternion."""
    return np.asarray(q * np.array([1.0, -1.0, -1.0, -1.0]))


def rounded(q: Doubles, width: int) -> list[int]:
    """Return a rotation as three integers of `width` bits: its logarithm, in parts of π/2."""
    w, x, y, z = q
    sine = np.sqrt(x * x + y * y + z * z + TINY_SQUARE)
    factor = np.copysign(atan2(sine, np.abs(w)) / sine, w)
    return [int(round_even(part * factor * (greatest(width) / (np.pi / 2)))) for part in (x, y, z)]


def from_rounded(numbers: list[int], width: int) -> Doubles:
    """Return the rotation of three integers."""
    x, y, z = np.array(numbers, np.float64) * (np.pi / 2 / greatest(width))
    angle = np.sqrt(x * x + y * y + z * z + TINY_SQUARE)
    sine, cosine = sin_cos(angle)
    factor = sine / angle
    return np.array([cosine, x * factor, y * factor, z * factor])


def greatest(width: int) -> float:
    """Return the largest number of `width` bits with a sign."""
    return float((1 << width - 1) - 1)


def _unwrapped(angles: Doubles, period: float) -> tuple[Doubles, Doubles]:
    """Shift angles by whole periods so that none is more than half a period from the one before; and by how many."""
    turns = np.concatenate([[0.0], np.cumsum(round_even((angles[:-1] - angles[1:]) / period))])
    return angles + turns * period, turns


def _signed(radius: Doubles, turns: Doubles) -> Doubles:
    """Return radii whose sign changes with every 180° of their angle."""
    return np.where(turns - 2.0 * np.floor(turns * 0.5) != 0.0, -radius, radius)
