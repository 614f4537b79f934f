"""A database, as it serves for one body with some control points."""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from quatfilt._backend import ops, streams
from quatfilt._typing import Mask
from quatfilt.motion.skeleton import Skeleton
from quatfilt.reconstruction.database import MotionDatabase
from quatfilt.reconstruction.database.weights import reaches

POSES_AT_ONCE = 16 * 1024
"""Poses whose joints are placed together: some ten megabytes."""

POSES_MEASURED = 2048
"""Poses, spread over all, that tell how far apart control points are."""


@dataclass(frozen=True)
class Examples:
    """A database, and where a body in its poses would have its control points.

    Parameters
    ----------
    database : MotionDatabase
        The poses.
    skeleton : Skeleton
        The body, in the order of joints and the unit of the database.
    points : ndarray of int64, shape (points,)
        Its joints that are control points.
    """

    database: MotionDatabase
    skeleton: Skeleton
    points: NDArray[np.int64]

    @cached_property
    def reach(self) -> float:
        """Length of the longest chain of bones from the root, skeleton units: half of the body's size."""
        return float(reaches(self.skeleton)[0]) or 1.0

    @cached_property
    def translation(self) -> NDArray[np.float32]:
        """Positions of the roots, if the body had made the steps of each clip in its own size; shape (poses, 3)."""
        db = self.database
        own = np.array([self.reach / (float(reaches(one)[0]) or 1.0) for one in db.skeletons])
        scale = np.repeat(own[db.skeleton_indices], np.diff(db.starts))
        return np.ascontiguousarray(db.translation * scale[:, None], np.float32)

    @cached_property
    def trajectories(self) -> NDArray[np.float32]:
        """Positions of the control points; shape (poses, points, 3)."""
        return np.concatenate(
            [
                self._places(slice(start, start + POSES_AT_ONCE))
                for start in range(0, len(self.database), POSES_AT_ONCE)
            ]
        )

    def _places(self, which: slice) -> NDArray[np.float32]:
        db = self.database
        # In float64, so that backends round alike.
        rotations = db.rotations[which].astype(np.float64)
        turns = np.zeros((len(rotations), 3))
        turns[:, db.up] = db.heading[which] / 2
        rotations[:, 0] = ops().multiply(ops().exp(turns), np.ascontiguousarray(rotations[:, 0]))
        places = ops().forward_kinematics(
            rotations, self.translation[which].astype(np.float64), db.parents, self.skeleton.offsets
        )
        return np.ascontiguousarray(places[:, self.points], np.float32)

    def extents(self, used: Mask) -> NDArray[np.float64]:
        """Return how far some of the control points are from their middle, and above the ground, in poses all over the database."""
        step = max(1, len(self.database) // POSES_MEASURED)
        return extents(self.trajectories[::step, used], self.database.up)

    @cached_property
    def tables(self) -> Any:
        """What kernels make of the poses at their first frame, and share from then on; empty in a copy."""
        return streams().TrackerTables()

    @property
    def arrays(self) -> tuple[Any, ...]:
        """What the kernels take."""
        db = self.database
        return (
            db.rotations,
            db.heading,
            self.translation,
            self.trajectories,
            db.starts,
            db.features,
            db.mean_rotations,
            db.joint_weights,
            db.graph,
            self.tables,
        )


def extents(places: NDArray[Any], up: int) -> NDArray[np.float64]:
    """Return how far points are from their middle, and from the ground, in each frame in which all of them are seen.

    Parameters
    ----------
    places : ndarray, shape (frames, points, 3), skeleton units
        NaN where a point is not seen.
    up : int
        The axis that points up.

    Returns
    -------
    ndarray, shape (2, complete frames), skeleton units
        Root mean squares of the distances from the middle, and means of the heights.
    """
    complete = places[np.isfinite(places).all(axis=(1, 2))].astype(np.float64)
    middle = complete.mean(axis=1, keepdims=True)
    spread = np.sqrt(np.mean(np.sum((complete - middle) ** 2, axis=2), axis=1))
    return np.stack([spread, np.abs(complete[..., up]).mean(axis=1)])
