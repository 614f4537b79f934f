"""Where control points are, and how they move with the coordinates of a pose.

The coordinates `x` of a pose are three for each joint and four for the root's way. Joint `j` turns by
`c_j exp(x_j / 2)` from its centre `c_j`, so that `x_j` is a rotation vector; the root moreover by its heading, which is that of the frame before and the turn
`x_turn`. The root stands a step ahead of its place in the frame before, as seen in that frame's heading, and at the height
`x_height`. So `x = [3·J joint coordinates, forward, sideways, height, turn]`.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from quatfilt._reference._arrays import Reals
from quatfilt._reference.motion.skeleton import rotate
from quatfilt._reference.reconstruction.frame import rotated, rotation_about
from quatfilt._reference.rotations.quaternion import exp, multiply

Floats = Reals
"""Arrays of float64, as far as the type checker follows them."""

ROOT = 4
"""Coordinates of the root's way: two of its step, its height, its turn."""


class Body(NamedTuple):
    """A skeleton, and which joints are control points.

    Parameters
    ----------
    parents : array (joints,) of int64
        Parents, which come before their children; −1 for the root, the first joint.
    offsets : array (joints, 3)
        Positions of the joints in their parents' frames.
    points : array (points,) of int64
        The joints that are control points.
    up : int
        The axis that points up.
    """

    parents: NDArray[np.int64]
    offsets: Floats
    points: NDArray[np.int64]
    up: int


class Base(NamedTuple):
    """Where coordinates are measured from.

    Parameters
    ----------
    centres : array (joints, 4)
        Rotations at the origin of the coordinates; that of the root without a heading.
    place : array (3,)
        Where the root was in the frame before; its height does not matter.
    heading : float
        Its heading then, radians.
    """

    centres: Floats
    place: Floats
    heading: float


class Points(NamedTuple):
    """Control points of a pose.

    Parameters
    ----------
    positions : array (points, 3)
        Where they are.
    orientations : array (points, 4)
        Their global rotations.
    position_rows, orientation_rows : array (points, 3, coordinates)
        How the positions move, and how the global rotations turn (angular velocity in the world, radians), with the
        coordinates.
    """

    positions: Floats
    orientations: Floats
    position_rows: Floats
    orientation_rows: Floats


def pose(base: Base, x: Floats, up: int) -> tuple[Floats, Floats]:
    """Local rotations `(joints, 4)` with the root's heading, and the root's position `(3,)`, of coordinates `x`."""
    joints = len(base.centres)
    rotations = multiply(base.centres, exp(x[: 3 * joints].reshape(joints, 3) / 2))
    step, height, angle = x[3 * joints : 3 * joints + 2], x[3 * joints + 2], x[3 * joints + 3]
    rotations[0] = multiply(rotation_about(base.heading + angle, up), rotations[0])
    position = base.place + rotated(step, base.heading, up)
    position[up] = height
    return rotations, position


def control_points(body: Body, base: Base, x: Floats) -> Points:
    """Positions and orientations of the control points of a pose, and how they change with its coordinates.

    A joint that turns by `ω` moves what hangs below it by `ω × (place − joint)`. With the joint's global rotation `g` and
    its coordinates `x_j`, a rotation vector, `ω = g J(x_j) dx_j`, where `J` is the right Jacobian of the rotation group
    (`right_jacobian`).
    """
    joints = len(body.parents)
    rotations, root = pose(base, x, body.up)
    places = np.tile(root, (joints, 1))
    turns = rotations.copy()
    for joint, parent in enumerate(body.parents):
        if parent >= 0:
            places[joint] = places[parent] + rotate(turns[parent : parent + 1], body.offsets[joint])[0]
            turns[joint] = multiply(turns[parent], rotations[joint])
    count = len(body.points)
    rows = Points(
        places[body.points],
        turns[body.points],
        np.zeros((count, 3, 3 * joints + ROOT)),
        np.zeros((count, 3, 3 * joints + ROOT)),
    )
    axis = np.eye(3)[body.up]
    for i, point in enumerate(body.points):
        joint = int(point)
        while joint >= 0:
            columns = slice(3 * joint, 3 * joint + 3)
            spin = matrix(turns[joint]) @ right_jacobian(x[columns])
            rows.orientation_rows[i, :, columns] = spin
            rows.position_rows[i, :, columns] = np.cross(spin, places[point] - places[joint], axis=0)
            joint = int(body.parents[joint])
        rows.orientation_rows[i, :, 3 * joints + 3] = axis
        rows.position_rows[i, :, 3 * joints + 3] = np.cross(axis, places[point] - places[0])
        for column, step in enumerate(np.eye(2)):
            rows.position_rows[i, :, 3 * joints + column] = rotated(step, base.heading, body.up)
        rows.position_rows[i, body.up, 3 * joints + 2] = 1
    return rows


def right_jacobian(v: Floats) -> Floats:
    """Right Jacobian of the rotation group at the rotation vector `v`: `exp(v + dv) ≈ exp(v) exp(J dv)`; 3 × 3.

    `J = 1 − (1 − cos θ)/θ² [v] + (θ − sin θ)/θ³ [v]²`, `[v]` the matrix of `v ×`.
    """
    square = float(v @ v)
    angle = np.sqrt(square)
    if square < SMALL_SQUARE:
        first, second = 1 / 2 - square / 24, 1 / 6 - square / 120
    else:
        first, second = (1 - np.cos(angle)) / square, (angle - np.sin(angle)) / (square * angle)
    across = cross_matrix(v)
    return np.eye(3) - first * across + second * across @ across


SMALL_SQUARE = 1e-4
"""Radians²: below, two terms of the series are good to the last digits of float64, and `θ − sin θ` is not."""


def cross_matrix(v: Reals) -> Floats:
    """Return the matrix of `v ×`."""
    return np.array([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]], np.float64)


def matrix(q: Reals) -> Floats:
    """Return the rotation matrix of a unit quaternion."""
    across = cross_matrix(q[1:])
    return np.asarray(np.eye(3) + 2 * q[0] * across + 2 * across @ across)
