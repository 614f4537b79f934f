"""A motion that follows control points, frame by frame."""

import math
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from quatfilt._reference.reconstruction.examples import (
    Observations,
    Poses,
    State,
    begin,
    follow,
    nearest,
    shrunk,
)
from quatfilt._reference.reconstruction.kinematics import ROOT, Base, Body, Floats, pose
from quatfilt._reference.reconstruction.local_models.predict import predict_pose
from quatfilt._reference.reconstruction.signals import signals
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
        Distance of control points that counts as much as a radian between poses; infinite: poses alone, in the search and in the
        models.
    patience : int
        After so many frames without a control point the next one is a new start.
    floor : array (5,)
        Standard deviations of what models do not see: of a joint's coordinate in radians, and of the root's way.
    steps : int
        The most steps of the solver per frame.
    refresh : int
        With a graph: frames after which all examples are looked at again.
    ratio : float
        With a graph: how many times as far as at best since then the last of the examples may be before all are looked at.
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
    refresh: int
    ratio: float
    model: tuple[str, str, str, float, float, float]


@dataclass
class Search:
    """The examples of one frame after the other.

    Without a graph, all poses of the database that may be examples are looked at in each frame. With one, the candidates are
    the examples of the frame before, the poses after them, and the neighbours of both; since not every pose may be an
    example, those fewer than `stride` poses away from them. All are looked at in the first frame, after `refresh` frames, where
    there are fewer examples than are sought, and where the last of them is more than `ratio` times as far as it was at best
    since all were looked at (Chai and Hodgins 2005).
    """

    poses: Poses
    how: Options
    up: int
    before: NDArray[np.intp] = field(default_factory=lambda: np.zeros(0, np.intp))
    since: float = math.inf
    least: float = 0.0

    def reset(self) -> None:
        """Forget the frames before."""
        self.since = math.inf

    def next(self, state: State, observations: Observations) -> NDArray[np.intp]:
        """Find the examples of the next frame, nearest first."""
        how = self.how
        every = self.poses.candidates(history(how), how.stride)
        graph = self.poses.graph
        kept = False
        if graph is not None and self.since < how.refresh:
            found, squares = self._among(self._around(every, graph), state, observations)
            kept = len(found) == how.neighbors and (
                math.isinf(how.ratio) or math.sqrt(squares[-1]) <= how.ratio * self.least
            )
        if not kept:
            found, squares = self._among(every, state, observations)
        last = math.sqrt(squares[-1])
        self.least = min(self.least, last) if kept else last
        self.since = self.since + 1 if kept else 0
        self.before = found
        return found

    def _among(
        self, candidates: NDArray[np.intp], state: State, observations: Observations
    ) -> tuple[NDArray[np.intp], Floats]:
        how = self.how
        return nearest(
            self.poses, candidates, state, observations, self.up, how.neighbors, how.spacing, how.scale
        )

    def _around(self, every: NDArray[np.intp], graph: NDArray[np.int32]) -> NDArray[np.intp]:
        poses = np.concatenate([self.before, self.before + 1])
        poses = poses[poses < len(graph)]
        hints = np.concatenate([self.before, self.before + 1, graph[poses].ravel()])
        near = np.zeros(len(graph) + self.how.stride, bool)
        for hint in hints[hints >= 0]:
            near[max(0, hint - self.how.stride + 1) : hint + self.how.stride] = True
        return every[near[every]]


def track(
    parents: NDArray[np.int64],
    offsets: Floats,
    points: NDArray[np.int64],
    up: int,
    poses: tuple[NDArray[np.generic] | None, ...],
    options: tuple[object, ...],
    model: tuple[str, str, str, float, float, float],
    initial: tuple[Floats, Floats, float] | None,
    positions: Floats,
    position_deviations: Floats,
    orientations: Floats,
    orientation_deviations: Floats,
) -> tuple[Floats, Floats, Floats]:
    """Reconstruct a motion from trajectories of some joints.

    In each frame, the examples nearest to the last poses are found (`Search`), a local model of how they went on predicts
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
    search = Search(database, how, up)
    blind = 0
    weights = np.where(np.isfinite(position_deviations), 1 / position_deviations**2, 0)
    for frame in range(len(positions)):
        lags = how.window[how.window <= frame]
        observations = Observations(positions[frame - lags], weights[frame - lags], lags)
        seen = Targets(
            positions[frame],
            position_deviations[frame],
            orientations[frame],
            orientation_deviations[frame],
        )
        missing = not np.isfinite(seen.position_deviations).any()
        if state is None or (blind >= how.patience and not missing):
            state = begin(database, observations, up, how.order, history(how), how.stride)
            search.reset()
        blind = blind + 1 if missing else 0
        q, place, parts = next_pose(body, search, state, observations, seen)
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
    body: Body, search: Search, state: State, observations: Observations, seen: Targets
) -> tuple[Floats, Floats, tuple[float, float]]:
    """Find the most probable pose of the next frame, and the two parts of its energy."""
    poses, how = search.poses, search.how
    found = search.next(state, observations)
    segments = poses.rotations[found[:, None] + np.arange(-how.order, 1)].astype(np.float64)
    differences, roots = signals(poses, found, state, observations, body.up, how.scale)
    chart, mean, deviation, axes = predict_pose(
        segments,
        roots,
        differences,
        shrunk(segments, state.recent, poses.joint_weights),
        poses.joint_weights,
        *how.model,
    )
    joints = len(body.parents)
    floor = np.concatenate([np.full(3 * joints, how.floor[0]), how.floor[-ROOT:]])
    prior = Prior(mean, np.sqrt(deviation**2 + floor**2), axes)
    base = Base(chart, state.place, state.heading)
    example = np.concatenate([2 * log_short(between(chart, segments[0, -1])).reshape(-1), roots[0]])
    start = min(mean, example, key=lambda x: energy(body, base, prior, seen, x))
    result = solve(body, base, prior, seen, start, how.steps)
    rotations, place = pose(base, result.x, body.up)
    return rotations, place, (result.likelihood, result.prior)
