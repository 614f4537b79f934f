"""Reconstruction with a latent variable model of all poses, in the place of a local model for each frame."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from quatfilt._backend import ops
from quatfilt.reconstruction.gplvm import PoseGPLVM
from quatfilt.reconstruction.reconstructor.examples import Examples
from quatfilt.reconstruction.reconstructor.settings import MOST_STEPS, Settings

POSES = 500
"""Poses that are learned from, evenly spaced among those of the database: the cost is cubic."""

HORIZONTAL = ((1, 2), (2, 0), (0, 1))
"""The two level axes for each vertical one, in the order in which a heading turns the first into the second."""

Floats = NDArray[np.float64]

Tracked = tuple[Floats, Floats, Floats]
"""Rotations, translation and energies."""


@dataclass
class State:
    """What is known of the frames before.

    Parameters
    ----------
    recent : ndarray, shape (order, joints, 4)
        The last poses, the oldest first, without headings.
    place : ndarray, shape (3,)
        Where the root was in the last frame.
    heading : float
        Its heading then, radians.
    """

    recent: Floats
    place: Floats
    heading: float


class LatentModel:
    """A model that is learned once of poses of the database.

    The prior of a pose is what the model says at the latent point that is most likely for the last pose, and its changes with
    the latent numbers; of the root's step, height and turn it is mean and deviation among the nearest examples.

    Parameters
    ----------
    examples : Examples
        The database, and the body in it.
    settings : Settings
        The options of the reconstructor.
    """

    def __init__(self, examples: Examples, settings: Settings) -> None:
        db = examples.database
        self._examples, self._settings = examples, settings
        self._model = PoseGPLVM(np.asarray(db.rotations), subset=min(POSES, len(db)))
        options, model = settings.kernel(examples)
        self.patience, self._floor = int(options[6]), np.asarray(options[7])
        self._start = options, ("nearest", *model[1:])

    def _body(self) -> tuple[Any, ...]:
        skeleton = self._examples.skeleton
        return skeleton.parents, skeleton.offsets, self._examples.points, self._examples.database.up

    def first(self, seen: tuple[Floats, ...]) -> Tracked:
        """Find a pose that nothing is known before: that of the nearest example, where the control points fit."""
        one = [array[None] for array in seen]
        found = ops().track(*self._body(), self._examples.arrays, *self._start, None, *one)
        rotations, translation, energies = (np.asarray(array)[0] for array in found)
        return rotations, translation, energies

    def next(self, state: State, seen: tuple[Floats, ...]) -> Tracked:
        """Find the most probable pose after others."""
        prediction = self._model.predict_pose(state.recent[-1:])
        steps = self._root_steps(state.recent)
        mean = np.concatenate([prediction.mean, steps.mean(axis=0)])
        deviation = np.concatenate([prediction.deviation, steps.std(axis=0)])
        floor = np.concatenate([np.full(len(prediction.mean), self._floor[0]), self._floor[1:]])
        axes = np.concatenate([prediction.axes, np.zeros((steps.shape[1], prediction.axes.shape[1]))])
        _, rotations, translation, likelihood, prior, _ = ops().solve_pose(
            *self._body(),
            prediction.chart,
            state.place,
            state.heading,
            mean,
            np.hypot(deviation, floor),
            np.ascontiguousarray(axes),
            *seen,
            mean,
            MOST_STEPS,
        )
        return rotations, translation, np.array([likelihood, prior])

    def _root_steps(self, recent: Floats) -> Floats:
        """Return the way of the root to the poses after those nearest to the last: step, height and turn, ``(K, 4)``."""
        db = self._examples.database
        query = ops().pose_features(recent, db.mean_rotations, db.joint_weights)
        count = min(self._settings.neighbors, len(db))
        found, _ = db.nearest(np.asarray(query, np.float32), k=count, successors=1)
        before = found[found >= 0]
        heading = db.heading[before].astype(np.float64)
        places = self._examples.translation
        step = (places[before + 1] - places[before]).astype(np.float64)
        first, second = HORIZONTAL[db.up]
        c, s = np.cos(heading)[:, None], np.sin(heading)[:, None]
        level = c * step[:, [first, second]] + s * step[:, [second, first]] * [1, -1]
        height = places[before + 1, db.up].astype(np.float64)
        turn = db.heading[before + 1].astype(np.float64) - heading
        return np.column_stack([level, height, turn])

    def follow(self, state: State | None, pose: Floats, place: Floats) -> State:
        """Return what is known after one more frame; before the first all poses were as it."""
        headings, rest = ops().split_heading(np.ascontiguousarray(pose[None, 0]), self._examples.database.up)
        last = pose.copy()
        last[0] = rest[0]
        order = self._settings.order
        recent = np.repeat(last[None], order, axis=0)
        if state is not None:
            recent[:-1] = state.recent[1:]
        return State(recent, place, float(headings[0]))


class LatentTracker:
    """Take the control points of one frame after the other, and give poses.

    Parameters
    ----------
    model : LatentModel
        What was learned.
    state : tuple of (ndarray, ndarray, float) or None
        The fields of `State`; None: the first frame is a new start.
    """

    def __init__(self, model: LatentModel, state: tuple[Floats, Floats, float] | None) -> None:
        self._model = model
        self._state = None if state is None else State(*state)
        self._blind = 0

    def push(self, *seen: Floats) -> Tracked:
        """Return rotations, translation and energies of the next frame, as the kernel's stream."""
        missing = not np.isfinite(seen[1]).any()
        state = self._state
        if self._blind >= self._model.patience and not missing:
            state = None
        found = self._model.first(seen) if state is None else self._model.next(state, seen)
        self._state = self._model.follow(state, *found[:2])
        self._blind = self._blind + 1 if missing else 0
        return found

    def track(self, *targets: Floats) -> Tracked:
        """Return those of all frames, one after the other."""
        frames = [self.push(*map(np.ascontiguousarray, seen)) for seen in zip(*targets, strict=True)]
        rotations, translation, energies = (np.array(part) for part in zip(*frames, strict=True))
        return rotations, translation, energies


__all__ = ["LatentModel", "LatentTracker"]
