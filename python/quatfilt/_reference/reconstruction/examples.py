"""The examples that a pose is learned from: by the poses before it, and by the ways of the control points."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from quatfilt._reference.reconstruction.frame import HORIZONTAL, heading, rotated, rotation_about
from quatfilt._reference.reconstruction.kinematics import Floats
from quatfilt._reference.rotations.quaternion import between, exp, log_short, multiply, normalize


class Poses(NamedTuple):
    """A database, and where its poses would have the control points.

    Parameters
    ----------
    rotations : array (poses, joints, 4)
        Rotations of the joints; those of the root without heading.
    heading : array (poses,)
        Headings of the root, radians.
    translation : array (poses, 3)
        Positions of the root, in the size of the body that is reconstructed.
    trajectories : array (poses, points, 3)
        Positions of the control points.
    starts : array (clips + 1,) of int64
        The first pose of each clip, and the number of poses.
    features : array (poses, 3·joints)
        Poses as vectors.
    mean_rotations : array (joints, 4)
        From which they are measured.
    joint_weights : array (joints,)
        How much joints count in them.
    graph : array (poses, degree) of int32 or None
        Neighbours of the poses, −1 where there are fewer.
    tables : object
        What kernels keep from call to call; nothing depends on it.
    """

    rotations: NDArray[np.float32]
    heading: NDArray[np.float32]
    translation: NDArray[np.float32]
    trajectories: NDArray[np.float32]
    starts: NDArray[np.int64]
    features: NDArray[np.float32]
    mean_rotations: Floats
    joint_weights: Floats
    graph: NDArray[np.int32] | None
    tables: object = None

    def feature(self, pose: Floats) -> Floats:
        """Return a pose as a vector."""
        vectors = 2 * log_short(between(self.mean_rotations, pose))
        return (np.sqrt(self.joint_weights)[:, None] * vectors).reshape(-1)

    def candidates(self, before: int, stride: int) -> NDArray[np.intp]:
        """Return every `stride`-th pose of each clip, from the first with so many poses before it on."""
        ranges = [
            np.arange(start + before, stop, stride)
            for start, stop in zip(self.starts[:-1], self.starts[1:], strict=True)
        ]
        return np.concatenate(ranges).astype(np.intp)


class Observations(NamedTuple):
    """Control points of some frames, the last of them the one in question.

    Parameters
    ----------
    positions : array (n, points, 3)
        Where they are.
    weights : array (n, points)
        How far they are trusted; 0 where they are not seen.
    lags : array (n,) of int64
        How many frames ago.
    """

    positions: Floats
    weights: Floats
    lags: NDArray[np.int64]


class Fit(NamedTuple):
    """Poses of the database, laid on control points.

    Parameters
    ----------
    distance : array (candidates,)
        Weighted mean of the squared distances between points that are left; 0 where none is seen.
    turn : array (candidates,)
        By how much a pose is turned about the up axis, radians.
    shift : array (candidates, 2)
        And moved along the two level axes, after the turn.
    """

    distance: Floats
    turn: Floats
    shift: Floats


def fit(poses: Poses, candidates: NDArray[np.intp], observations: Observations, up: int) -> Fit:
    """Turn each candidate about the up axis, and move it on the ground, to where its control points fit best.

    With the level coordinates as complex numbers, `z_i` of the points of an example and of the frames before it and `c_i`
    of the control points, less their weighted means, the turn is the angle of `Σ w z̄_i c_i`, and what is left is
    `Σ w |z_i|² + Σ w |c_i|² − 2 |Σ w z̄_i c_i|` and the squared differences in height.
    """
    first, second = HORIZONTAL[up]
    weights = observations.weights.reshape(-1)
    total = weights.sum()
    if total == 0:
        none = np.zeros(len(candidates))
        return Fit(none, none, np.zeros((len(candidates), 2)))
    share = weights / total
    points = poses.trajectories[candidates[:, None] - observations.lags].astype(np.float64)
    points = points.reshape(len(candidates), -1, 3)
    seen = np.where(observations.weights[..., None] > 0, observations.positions, 0).reshape(-1, 3)
    z, c = points[..., first] + 1j * points[..., second], seen[:, first] + 1j * seen[:, second]
    z_mean, c_mean = z @ share, c @ share
    z, c = z - z_mean[:, None], c - c_mean
    product = np.sum(share * np.conj(z) * c, axis=1)
    level = np.sum(share * np.abs(z) ** 2, axis=1) + np.sum(share * np.abs(c) ** 2) - 2 * np.abs(product)
    height = np.sum(share * (points[..., up] - seen[:, up]) ** 2, axis=1)
    angle = np.angle(product)
    shift = c_mean - np.exp(1j * angle) * z_mean
    return Fit(np.maximum(level, 0) + height, angle, np.stack([shift.real, shift.imag], axis=1))


class State(NamedTuple):
    """What is known of the frames before.

    Parameters
    ----------
    recent : array (m, joints, 4)
        The last poses, the oldest first, without headings.
    place : array (3,)
        Where the root was in the last frame.
    heading : float
        Its heading then.
    """

    recent: Floats
    place: Floats
    heading: float


def begin(poses: Poses, observations: Observations, up: int, order: int, before: int, stride: int) -> State:
    """Take what came before from the pose that fits the control points best, where it fits best.

    Parameters
    ----------
    poses, observations, up
        The database, the control points and the up axis.
    order : int
        How many poses are wanted.
    before : int
        How many poses of its clip an example has before it.
    stride : int
        Every which pose of a clip may be an example.
    """
    candidates = poses.candidates(before, stride)
    found = fit(poses, candidates, observations, up)
    best = int(np.argmin(found.distance))
    last = int(candidates[best]) - 1
    angle = float(found.turn[best])
    first, second = HORIZONTAL[up]
    there = poses.translation[last].astype(np.float64)
    place = rotated(there[[first, second]], angle, up)
    place[[first, second]] += found.shift[best]
    place[up] = there[up]
    recent = poses.rotations[last - order + 1 : last + 1].astype(np.float64)
    return State(recent, place, float(poses.heading[last]) + angle)


def follow(state: State, rotations: Floats, position: Floats, up: int) -> State:
    """Return what is known after one more frame: `rotations` with the root's heading, and its position."""
    angle = float(heading(rotations[0], up))
    rest = rotations.copy()
    rest[0] = multiply(rotation_about(-angle, up), rotations[0])
    return State(np.concatenate([state.recent[1:], rest[None]]), position, angle)


def nearest(
    poses: Poses,
    candidates: NDArray[np.intp],
    state: State,
    observations: Observations,
    up: int,
    count: int,
    spacing: int,
    scale: float,
) -> tuple[NDArray[np.intp], Floats]:
    """Find the nearest examples' next poses among some, nearest first, and their squared distances.

    The poses before them are like the last ones, and their control points moved alike. The squared distance of an example is the mean of the squared distances of its `m` poses from the last ones, in
    radians, and that of its control points (`fit`) over `scale` squared. With an infinite scale it is the paper's. Of the
    examples within less than `spacing` frames of each other in a clip only the nearest is taken.
    """
    order = len(state.recent)
    squares = np.zeros(len(candidates))
    for lag, pose in enumerate(state.recent[::-1], 1):
        difference = poses.features[candidates - lag].astype(np.float64) - poses.feature(pose)
        squares += np.sum(difference**2, axis=1) / order
    if np.isfinite(scale):
        squares += fit(poses, candidates, observations, up).distance / scale**2
    found: list[int] = []
    free = np.ones(len(poses.heading), bool)
    clip = np.searchsorted(poses.starts, np.arange(len(free)), side="right")
    for number in np.argsort(squares, kind="stable"):
        pose = candidates[number]
        if len(found) < count and free[pose]:
            found.append(int(number))
            near = slice(max(0, int(pose) - spacing + 1), int(pose) + spacing)
            free[near] &= clip[near] != clip[pose]
    return candidates[found], squares[found]


def root_steps(poses: Poses, examples: NDArray[np.intp], up: int) -> Floats:
    """How the roots of examples came to their poses: step along two axes of the heading before, height, turn; `(K, 4)`."""
    first, second = HORIZONTAL[up]
    here, before = (poses.translation[at].astype(np.float64) for at in (examples, examples - 1))
    angle = poses.heading[examples - 1].astype(np.float64)
    step = here - before
    c, s = np.cos(angle), np.sin(angle)
    return np.stack(
        [
            c * step[:, first] + s * step[:, second],
            c * step[:, second] - s * step[:, first],
            here[:, up],
            poses.heading[examples].astype(np.float64) - angle,
        ],
        axis=1,
    )


BESIDE = 0.5
"""How far beside the mean of its examples a query may lie, in their root mean square distances: people differ from each other by more
than examples do, and what is peculiar to one says nothing about the others."""


def shrunk(segments: Floats, recent: Floats, weights: Floats) -> Floats:
    """Bring the last poses back among those of the examples, `(m, joints, 4)`.

    A pose that lies farther from the mean of the examples' poses of that frame than `BESIDE` times as these do, root mean square
    and weighted by joint, is moved towards it until it does not. What a regression makes of a query beyond its examples is passed
    on to the next query, and a wrong pose would be kept.

    Parameters
    ----------
    segments : array (K, m + 1, joints, 4)
        The examples, the nearest first.
    recent : array (m, joints, 4)
        The last poses.
    weights : array (joints,)
        How joints count.
    """
    poses = segments[:, :-1]
    signs = np.where(np.sum(poses * poses[0], axis=-1, keepdims=True) < 0, -1.0, 1.0)
    means = normalize(np.sum(signs * poses, axis=0))
    vectors = 2 * log_short(between(np.broadcast_to(means, poses.shape), poses))
    away = 2 * log_short(between(means, recent))
    spread = BESIDE**2 * np.mean(np.sum(weights[:, None] * vectors**2, axis=(2, 3)), axis=0)
    square = np.sum(weights[:, None] * away**2, axis=(1, 2))
    far = square > spread
    part = np.where(far, np.sqrt(spread / np.where(far, square, 1)), 1)
    return multiply(means, exp(part[:, None, None] * away / 2))
