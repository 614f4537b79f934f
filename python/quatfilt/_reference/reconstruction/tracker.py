"""A motion that follows control points, frame by frame."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from quatfilt._reference.reconstruction.examples import (
    Poses,
    Sight,
    State,
    begin,
    follow,
    nearest,
    ways,
    within,
)
from quatfilt._reference.reconstruction.kinematics import WAY, Base, Body, Floats, pose
from quatfilt._reference.reconstruction.local_models.predict import predict_pose
from quatfilt._reference.reconstruction.solver import Prior, Targets, energy, solve
from quatfilt._reference.rotations.quaternion import between, log_short


class Options(NamedTuple):
    """How a motion is reconstructed.

    Parameters
    ----------
    order : int
        How many poses before are compared, and predicted from: m.
    neighbors : int
        How many examples are learned from: K.
    stride : int
        Every which pose of a clip may be an example.
    spacing : int
        So many frames apart are examples of one clip, at least.
    window : array (n,) of int64
        How many frames ago control points are compared; the first is 0.
    scale : float
        Distance of control points that counts as much as a radian between poses; infinite: poses alone.
    patience : int
        After so many frames without a control point the next one is a new start.
    floor : array (5,)
        Standard deviations of what models do not see: of a joint's coordinate in radians, and of the root's way.
    steps : int
        The most steps of the solver per frame.
    model : tuple of (str, str, str, float, float, float)
        Model, target, deviation, bandwidth, ridge and share, as in `predict_pose`.
    """

    order: int
    neighbors: int
    stride: int
    spacing: int
    window: NDArray[np.int64]
    scale: float
    patience: int
    floor: Floats
    steps: int
    model: tuple[str, str, str, float, float, float]


def track(
    parents: NDArray[np.int64],
    offsets: Floats,
    points: NDArray[np.int64],
    up: int,
    poses: tuple[NDArray[np.generic], ...],
    options: tuple[object, ...],
    model: tuple[str, str, str, float, float, float],
    initial: tuple[Floats, Floats, float] | None,
    positions: Floats,
    position_deviations: Floats,
    orientations: Floats,
    orientation_deviations: Floats,
) -> tuple[Floats, Floats, Floats]:
    """Reconstruct a motion from trajectories of some joints.

    In each frame, the examples nearest to the last poses are found (`nearest`), a local model of how they went on predicts
    the pose, and the most probable pose is found, from the prediction or from the nearest example, whichever has the lower
    energy.

    Parameters
    ----------
    parents, offsets, points, up
        The skeleton, its control points and the up axis, as in `Body`.
    poses : tuple
        The fields of `Poses`.
    options : tuple
        The fields of `Options` but the last.
    model : tuple
        The last.
    initial : (array (m, joints, 4), array (3,), float) or None
        Poses before the first frame, the oldest first, without headings; place and heading of the root in the last of
        them. None: those of the database's pose that fits the control points of the first frame best.
    positions, position_deviations, orientations, orientation_deviations : arrays (frames, points, …)
        Where control points are seen, as in `Targets`.

    Returns
    -------
    rotations : array (frames, joints, 4)
        Rotation of each joint in its parent.
    translation : array (frames, 3)
        Position of the root.
    energies : array (frames, 2)
        The two parts of the energy of each frame: of what is seen, and of what was expected.
    """
    body, database = Body(parents, offsets, points, up), Poses(*poses)  # type: ignore[arg-type]
    how = Options(*options, model)  # type: ignore[call-arg, arg-type]
    state = None if initial is None else State(*initial)
    rotations, translation, energies = [], [], []
    blind = 0
    weights = np.where(np.isfinite(position_deviations), 1 / position_deviations**2, 0)
    for frame in range(len(positions)):
        lags = how.window[how.window <= frame]
        sight = Sight(positions[frame - lags], weights[frame - lags], lags)
        seen = Targets(
            positions[frame],
            position_deviations[frame],
            orientations[frame],
            orientation_deviations[frame],
        )
        missing = not np.isfinite(seen.position_deviations).any()
        if state is None or (blind >= how.patience and not missing):
            state = begin(database, sight, up, how.order, history(how), how.stride)
        blind = blind + 1 if missing else 0
        q, place, parts = next_pose(body, database, how, state, sight, seen)
        state = follow(state, q, place, up)
        rotations.append(q)
        translation.append(place)
        energies.append(parts)
    joints = len(parents)
    return (
        np.array(rotations).reshape(-1, joints, 4),
        np.array(translation).reshape(-1, 3),
        np.array(energies).reshape(-1, 2),
    )


def history(how: Options) -> int:
    """How many poses of its clip an example has before it."""
    return max(how.order, int(how.window.max()))


def next_pose(
    body: Body, poses: Poses, how: Options, state: State, sight: Sight, seen: Targets
) -> tuple[Floats, Floats, tuple[float, float]]:
    """Find the most probable pose of the next frame, and the two parts of its energy."""
    found = nearest(
        poses, state, sight, body.up, history(how), how.stride, how.neighbors, how.spacing, how.scale
    )
    segments = poses.rotations[found[:, None] + np.arange(-how.order, 1)].astype(np.float64)
    roots = ways(poses, found, body.up)
    chart, mean, deviation, axes = predict_pose(
        segments,
        roots,
        within(segments, state.recent, poses.joint_weights),
        poses.joint_weights,
        *how.model,
    )
    joints = len(body.parents)
    floor = np.concatenate([np.full(3 * joints, how.floor[0]), how.floor[-WAY:]])
    prior = Prior(mean, np.sqrt(deviation**2 + floor**2), axes)
    base = Base(chart, state.place, state.heading)
    example = np.concatenate([2 * log_short(between(chart, segments[0, -1])).reshape(-1), roots[0]])
    start = min(mean, example, key=lambda x: energy(body, base, prior, seen, x))
    result = solve(body, base, prior, seen, start, how.steps)
    rotations, place = pose(base, result.x, body.up)
    return rotations, place, (result.likelihood, result.prior)
