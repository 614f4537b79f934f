"""Search for the examples of a pose: by the previous poses and by the control points."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from quatfilt._reference.reconstruction.frame import HORIZONTAL, heading, rotated, rotation_about
from quatfilt._reference.reconstruction.kinematics import Floats
from quatfilt._reference.rotations.quaternion import between, exp, log_short, multiply, normalize


class Poses(NamedTuple):
    """A database, with the positions of the control points.

    Parameters
    ----------
    rotations : array (poses, joints, 4)
        Rotations of the joints; those of the root without heading.
    heading : array (poses,)
        Headings of the root, radians.
    translation : array (poses, 3)
        Positions of the root, scaled to the reconstructed body.
    trajectories : array (poses, points, 3)
        Positions of the control points.
    starts : array (clips + 1,) of int64
        The first pose of each clip, followed by the number of poses.
    features : array (poses, 3·joints)
        Feature vectors of the poses.
    mean_rotations : array (joints, 4)
        Mean rotations to which the features are relative.
    joint_weights : array (joints,)
        Weight of each joint in the features.
    graph : array (poses, degree) of int32 or None
        Neighbours of the poses; −1 for missing entries.
    tables : object
        Tables that kernels reuse between calls; they do not affect the result.
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
        """Return the feature vector of a pose."""
        vectors = 2 * log_short(between(self.mean_rotations, pose))
        return (np.sqrt(self.joint_weights)[:, None] * vectors).reshape(-1)

    def candidates(self, before: int, stride: int) -> NDArray[np.intp]:
        """Return every `stride`-th pose of each clip, from the first with `before` poses before it on."""
        ranges = [
            np.arange(start + before, stop, stride)
            for start, stop in zip(self.starts[:-1], self.starts[1:], strict=True)
        ]
        return np.concatenate(ranges).astype(np.intp)


class Observations(NamedTuple):
    """Control points of some frames, the last of them the current frame.

    Parameters
    ----------
    positions : array (n, points, 3)
        Positions.
    weights : array (n, points)
        Weights; 0 where a point is not observed.
    lags : array (n,) of int64
        Lags in frames.
    """

    positions: Floats
    weights: Floats
    lags: NDArray[np.int64]


class Fit(NamedTuple):
    """Poses of the database, fitted to control points.

    Parameters
    ----------
    distance : array (candidates,)
        Weighted mean of the squared residuals; 0 if no point is observed.
    turn : array (candidates,)
        Rotation of a pose about the up axis, radians.
    shift : array (candidates, 2)
        Shift along the two horizontal axes, after the rotation.
    """

    distance: Floats
    turn: Floats
    shift: Floats


def fit(poses: Poses, candidates: NDArray[np.intp], observations: Observations, up: int) -> Fit:
    """Fit each candidate to the control points by a rotation about the up axis and a horizontal shift.

    With the horizontal coordinates as complex numbers, `z_i` of the points of an example and of the frames before it and `c_i`
    of the control points, less their weighted means, the rotation angle is that of `Σ w z̄_i c_i`, and the residual is
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
    """State after the previous frame.

    Parameters
    ----------
    recent : array (m, joints, 4)
        The last poses, the oldest first, without headings.
    place : array (3,)
        Position of the root in the last frame.
    heading : float
        Heading of the root in the last frame.
    """

    recent: Floats
    place: Floats
    heading: float


def begin(poses: Poses, observations: Observations, up: int, order: int, before: int, stride: int) -> State:
    """Return the poses before the best-fitting pose of the database, moved to the best fit.

    Parameters
    ----------
    poses, observations, up
        The database, the control points and the up axis.
    order : int
        Number of poses.
    before : int
        Number of poses of its clip that an example needs before it.
    stride : int
        Only every `stride`-th pose of a clip is a candidate.
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

    The squared distance of an example is the mean of the squared distances of its `m` poses from the last ones, in
    radians, and that of its control points (`fit`) over `scale` squared. With an infinite scale it is the paper's. Of
    examples less than `spacing` frames apart in one clip only the nearest is kept.
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
    """Root displacements of examples: step along the two axes of the previous heading, height, change of heading; `(K, 4)`."""
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
"""Largest distance of a query from the mean of its examples, relative to their root-mean-square distance.

People differ from each other more than examples do, and such a difference does not help to predict the next pose.
"""


def shrunk(segments: Floats, recent: Floats, weights: Floats) -> Floats:
    """Move the last poses towards those of the examples, `(m, joints, 4)`.

    A pose is moved towards the mean of the examples' poses of the same frame if its distance exceeds `BESIDE` times their
    distance, both root mean square and weighted by joint. It is moved until the distances agree. Without this step, a
    regression extrapolates beyond its examples, the next query contains the result, and a wrong pose persists.

    Parameters
    ----------
    segments : array (K, m + 1, joints, 4)
        The examples, the nearest first.
    recent : array (m, joints, 4)
        The last poses.
    weights : array (joints,)
        Weight of each joint.
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
