"""Euler angles: rotations as three successive rotations about coordinate axes, as in motion files.

The angles `(a₀, a₁, a₂)` about the axes `(i, j, k)`, a word such as `"ZXY"`, stand for `R_i(a₀)·R_j(a₁)·R_k(a₂)`: each turn
is about the axis as those before it have left it. `(a₀ + π, π − a₁, a₂ + π)` is the same rotation, and whole turns may be
added to each angle. Where `a₁ = ±π/2`, the gimbal is locked: only `a₀ ± a₂` is determined.
"""

import numpy as np

from quatfilt._reference._arrays import Reals
from quatfilt._reference.rotations.quaternion import multiply, norm

LOCK = 1e-12
"""Nearer to a gimbal lock than this, relative to the length of the quaternion, the third angle is set to 0."""

NEARLY_LOCKED = 4e-12
"""As `LOCK`, for the second angle itself, in radians."""

RIGHT_HANDED = ("XYZ", "YZX", "ZXY")
"""The orders of the axes in which the first times the second is the third; in the others it is its opposite."""


def parity(axes: str) -> int:
    """1 for right-handed orders of the axes, −1 for the others."""
    return 1 if axes in RIGHT_HANDED else -1


def from_euler(angles: Reals, axes: str) -> Reals:
    """Turn Euler angles in radians into unit quaternions, `(n, 3)` → `(n, 4)`; NaN where an angle is NaN."""
    turns = []
    for angle, axis in zip(np.moveaxis(angles, -1, 0), axes, strict=True):
        turn = np.zeros((len(angles), 4))
        turn[:, 0] = np.cos(angle / 2)
        turn[:, 1 + "XYZ".index(axis)] = np.sin(angle / 2)
        turns.append(turn)
    product = multiply(multiply(turns[0], turns[1]), turns[2])
    product[np.isnan(angles).any(axis=-1)] = np.nan
    return product


def to_euler(q: Reals, axes: str) -> Reals:
    """Euler angles of quaternions in radians, `(n, 4)` → `(n, 3)`: the second in `[−π/2, π/2]`, the others in `[−π, π]`.

    With the components `(w, x, y, z)` of `q` along `(1, i, j, k)` and `c = ±a₂` by the parity of the axes,
    `w + y` and `x + z` are cosine and sine of `(a₀ + c)/2` times one factor, `w − y` and `x − z` those of `(a₀ − c)/2` times
    another, and the tangent of `a₁/2 + π/4` is the ratio of the two factors.

    Neither sign nor length of a quaternion matters; NaN for missing samples. In a gimbal lock the third angle is 0.

    References
    ----------
    E. Bernardes and S. Viollet, "Quaternion to Euler angles conversion: a direct, general and computationally efficient
    method", PLOS ONE 17(11), 2022.
    """
    w, x, y, z = (q[:, component] for component in (0, *(1 + "XYZ".index(axis) for axis in axes)))
    z = parity(axes) * z
    upper = norm(np.stack([w + y, x + z], axis=-1))
    lower = norm(np.stack([w - y, x - z], axis=-1))
    half_sum, half_rest = np.arctan2(x + z, w + y), np.arctan2(x - z, w - y)
    lock = LOCK * (upper + lower)
    half_sum, half_rest = (
        np.where(upper < lock, half_rest, half_sum),
        np.where(lower < lock, half_sum, half_rest),
    )
    angles = np.stack(
        [
            wrapped(half_sum + half_rest),
            2 * np.arctan2(upper, lower) - np.pi / 2,
            wrapped(parity(axes) * (half_sum - half_rest)),
        ],
        axis=-1,
    )
    angles[~((upper + lower) > 0)] = np.nan
    return angles


def wrapped(angle: Reals) -> Reals:
    """Angles in `[−2π, 2π]`, moved by multiples of 2π to `[−π, π]`."""
    near_zero: Reals = angle - 2 * np.pi * (angle > np.pi) + 2 * np.pi * (angle < -np.pi)
    return near_zero


def continuous_euler(angles: Reals, start: Reals, axes: str) -> Reals:
    """Euler angles made continuous along time, in radians, `(frames, joints, 3)`.

    Each triple becomes the one of the same rotation that is nearest to the triple before it, the first one nearest to
    `start`, `(joints, 3)`. In gimbal lock the third angle keeps its previous value, and the first compensates for it. Triples with
    NaN stay as they are, and continuity goes across them; a joint whose start has NaN begins with its first triple.
    """
    result = angles.copy()
    before = start.copy()
    for here in result:
        present = np.isfinite(here).all(axis=-1)
        moved = present & np.isfinite(before).all(axis=-1)
        here[moved] = nearest(here[moved], before[moved], axes)
        before[present] = here[present]
    return result


def nearest(angles: Reals, before: Reals, axes: str) -> Reals:
    """Triples of the same rotations as `angles` that are nearest to the triples `before`, `(n, 3)`."""
    angles = angles.copy()
    locked = np.abs(np.abs(angles[:, 1]) - np.pi / 2) < NEARLY_LOCKED
    side = parity(axes) * np.sign(angles[:, 1])
    angles[locked, 0] += (side * (angles[:, 2] - before[:, 2]))[locked]
    angles[locked, 2] = before[locked, 2]
    one = near(angles, before)
    other = near(angles * [1, -1, 1] + np.pi, before)
    closer = norm(other - before) < norm(one - before)
    return np.where(closer[:, None], other, one)


def near(angles: Reals, target: Reals) -> Reals:
    """Add multiples of 2π to `angles` to bring them nearest to `target`."""
    turns: Reals = np.round((target - angles) / (2 * np.pi))
    return angles + 2 * np.pi * turns
