"""Columns of Euler angles to rotations, and back."""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from quatfilt._backend import ops
from quatfilt._typing import Array, Mask

_ROUNDED = 8
"""Decimals of what is new in a file: a hundred millionth of a degree or unit."""

_SAME = 4.0
"""A component that differs by no more than so many roundings is the one that was read."""

_REACHED = 1e-5
"""Radians by which a joint with fewer than three rotation channels may miss a rotation: below a thousandth of a degree."""

Values = NDArray[np.float64]


class Turns(NamedTuple):
    """The rotation channels of a joint: axes such as ``"ZXY"``, the first one outermost, and their columns."""

    axes: str
    columns: tuple[int, ...]


class _Group(NamedTuple):
    """Joints of one order of axes; columns ``(joints, 3)``, −1 where the joint has no such channel."""

    axes: str
    joints: list[int]
    columns: NDArray[np.intp]


def completed(axes: str) -> str:
    """Return `axes` with the axes that it lacks at its end: turned by 0, they change nothing."""
    return axes + "".join(axis for axis in "XYZ" if axis not in axes)


def _groups(joints: Sequence[Turns]) -> Iterator[_Group]:
    orders: dict[str, list[int]] = {}
    for joint, turns in enumerate(joints):
        if turns.axes:
            orders.setdefault(completed(turns.axes), []).append(joint)
    for axes, members in orders.items():
        columns = np.full((len(members), 3), -1, np.intp)
        for row, joint in zip(columns, members, strict=True):
            row[: len(joints[joint].columns)] = joints[joint].columns
        yield _Group(axes, members, columns)


def _angles(values: Values, columns: NDArray[np.intp], unit: str) -> Values:
    """Return angles in radians, ``(frames, joints, 3)``; zeros for channels that a joint lacks."""
    flat = columns.ravel()
    if (np.diff(flat) == 1).all() and flat[0] >= 0:
        table = values[:, flat[0] : flat[-1] + 1]
        angles = np.deg2rad(table) if unit == "degrees" else table.copy()
    else:
        angles = np.take(values, flat, axis=1)
        angles[:, flat < 0] = 0
        if unit == "degrees":
            np.deg2rad(angles, out=angles)
    return angles.reshape(len(values), *columns.shape)


def _rotations_of(angles: Values, axes: str) -> Values:
    quaternions: Values = ops().from_euler(angles.reshape(-1, 3), axes)
    return quaternions.reshape(*angles.shape[:-1], 4)


def rotations(values: Values, joints: Sequence[Turns], *, unit: str = "degrees") -> Values:
    """Return the rotations ``(frames, joints, 4)`` that a table of channels holds."""
    result: Values | None = None
    for axes, members, columns in _groups(joints):
        part = _rotations_of(_angles(values, columns, unit), axes)
        if members == list(range(len(joints))):
            return part
        if result is None:
            result = _identity(len(values), len(joints))
        result[:, members] = part
    return _identity(len(values), len(joints)) if result is None else result


def _identity(frames: int, joints: int) -> Values:
    result = np.zeros((frames, joints, 4))
    result[..., 0] = 1
    return result


def same_rotations(a: Array, b: Array) -> Mask:
    """Tell where two arrays of quaternions hold the same samples, missing ones included; ``(...)``."""
    tolerance = _SAME * np.finfo(a.dtype).eps
    b = b.astype(a.dtype)
    equal = (np.abs(a - b).max(axis=-1) <= tolerance) | (np.abs(a + b).max(axis=-1) <= tolerance)
    missing = ~np.isfinite(a).all(axis=-1) & ~np.isfinite(b).all(axis=-1)
    result: Mask = equal | missing
    return result


def _principal(quaternions: Array, axes: str, lacking: NDArray[np.bool_]) -> Values:
    """Return angles ``(frames, joints, 3)``; for joints that lack the third channel, those with the least third angle."""
    wide = np.ascontiguousarray(quaternions, np.float64)
    angles: Values = ops().to_euler(wide.reshape(-1, 4), axes).reshape(*quaternions.shape[:-1], 3)
    if lacking.any():
        over = lacking & (np.abs(angles[..., 2]) > np.pi / 2)
        angles[over] = angles[over] * [1, -1, 1] + np.pi
        angles[over, 2] -= 2 * np.pi * (angles[over, 2] > np.pi)
    return angles


def lacking_axes(quaternions: Array, axes: str) -> bool:
    """Tell whether the rotations of one joint, ``(frames, 4)``, need more axes than `axes`."""
    if len(axes) == 3:
        return False
    order = completed(axes)
    angles = _principal(quaternions[:, None], order, np.array([len(axes) == 2]))[:, 0, len(axes) :]
    return bool((np.abs(angles) > _REACHED).any())


def write_rotations(
    table: Values, quaternions: Array, joints: Sequence[Turns], original: Values | None
) -> None:
    """Fill the rotation channels of `table` with angles in degrees.

    A joint whose rotations are those of the `original` table keeps its numbers. Others get curves that are continuous in time
    and begin on the branch of the original's first frame, through the original's numbers where a sample is the same.
    """
    for group in _groups(joints):
        axes, members, columns = group
        q = quaternions[:, members]
        if original is None or not len(original):
            _write_curves(table, q, group, None, None)
            continue
        before = _angles(original, columns, "degrees")
        same = same_rotations(q, _rotations_of(before, axes))
        whole = same.all(axis=0)
        kept = columns[whole]
        table[:, kept[kept >= 0]] = original[:, kept[kept >= 0]]
        if not whole.all():
            new = ~whole
            part = _Group(axes, [], columns[new])
            _write_curves(table, q[:, new], part, before[:, new], same[:, new])


def _write_curves(
    table: Values, quaternions: Array, group: _Group, before: Values | None, same: Mask | None
) -> None:
    """Fill the channels of joints of one order of axes with curves, through `before` where samples are the `same`."""
    present = group.columns >= 0
    angles = _principal(quaternions, group.axes, present[:, 1] & ~present[:, 2])
    start = np.full((len(group.columns), 3), np.nan)
    if before is not None and same is not None:
        angles[same] = before[same]
        start = before[0].copy()
    curves = ops().continuous_euler(angles, start, group.axes)
    degrees = np.round(np.rad2deg(curves), _ROUNDED)
    if present.all():
        table[:, group.columns.ravel()] = degrees.reshape(len(degrees), -1)
    else:
        table[:, group.columns[present]] = degrees[:, present]


def rounded(values: Array, original: Array | None) -> Values:
    """Return positions as they are written: the original's numbers where they are the same, others rounded."""
    result: Values = np.round(values.astype(np.float64), _ROUNDED).astype(np.float64)
    if original is None:
        return result
    same = (values == original.astype(values.dtype)) | (np.isnan(values) & np.isnan(original))
    kept: Values = np.where(same, original.astype(np.float64), result)
    return kept


__all__ = [
    "Turns",
    "Values",
    "completed",
    "lacking_axes",
    "rotations",
    "rounded",
    "same_rotations",
    "write_rotations",
]
