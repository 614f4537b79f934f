"""Trajectories of control points, at the frame rate of a database."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from quatfilt import _validation
from quatfilt._backend import ops
from quatfilt._typing import Array, Mask

SAME_RATE = 1e-9
"""Relative difference of frame rates, and frames between times, that are roundings."""

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Trajectories:
    """What is seen of control points.

    Parameters
    ----------
    positions : ndarray, shape (frames, points, 3)
        Where they are, any number where they are not seen.
    position_weights : ndarray, shape (frames, points), 0…1
        How far places are trusted; 0 where they are not seen.
    orientations : ndarray, shape (frames, points, 4)
        Their global rotations.
    orientation_weights : ndarray, shape (frames, points), 0…1
        Likewise.
    """

    positions: Floats
    position_weights: Floats
    orientations: Floats
    orientation_weights: Floats

    def __len__(self) -> int:
        return len(self.positions)

    def targets(self, position_noise: float, orientation_noise: float) -> tuple[Floats, ...]:
        """Return places and turns with their standard deviations, infinite where nothing is seen."""
        return (
            self.positions,
            _deviations(self.position_weights, position_noise),
            self.orientations,
            _deviations(self.orientation_weights, orientation_noise),
        )

    def resampled(self, fps: float, new_fps: float) -> "Trajectories":
        """Return the trajectories at another frame rate, as far as the last frame or a little beyond.

        Between two frames a point is seen if it is in both; beyond the last one it stays.
        """
        last = len(self) - 1
        times = np.arange(math.ceil(last * new_fps / fps - SAME_RATE) + 1) * (fps / new_fps)
        nearest = np.rint(times)
        times = np.minimum(np.where(np.abs(times - nearest) < SAME_RATE * max(last, 1), nearest, times), last)
        left = np.minimum(np.floor(times).astype(np.intp), max(last - 1, 0))
        right = np.minimum(left + 1, last)
        part = times - left
        share = part[:, None]

        def weights(of: Floats) -> Floats:
            both = np.minimum(
                np.where(share == 1, of[right], of[left]), np.where(share == 0, of[left], of[right])
            )
            return np.where(both > 0, (1 - share) * of[left] + share * of[right], 0)

        positions = (1 - share[..., None]) * self.positions[left] + share[..., None] * self.positions[right]
        turned = ops().slerp(self.orientations, np.arange(len(self), dtype=np.float64), times)
        return Trajectories(
            positions, weights(self.position_weights), turned, weights(self.orientation_weights)
        )


def checked(
    positions: ArrayLike,
    orientations: ArrayLike | None,
    confidence: ArrayLike | None,
    points: int,
    *,
    one: bool = False,
) -> tuple[Trajectories, np.dtype[np.floating]]:
    """Return what a user passed in, and the dtype of the positions; of `one` frame without its axis.

    Raises
    ------
    ValueError
        If the shapes do not fit each other, or a position is absurd.
    """
    array = _validation.control_points(positions, "positions", points, one=one)
    rows = array.reshape(-1, points, 3)
    trust = _trust(confidence, rows.shape[:2], one=one)
    known: Mask = np.logical_and.reduce(np.isfinite(rows), axis=2)
    places = np.where(known[..., None], rows, 0).astype(np.float64)
    turns = np.tile([1.0, 0.0, 0.0, 0.0], (*known.shape, 1))
    turned = np.zeros(known.shape)
    if orientations is not None:
        given = _validation.quaternions(orientations, "orientations")
        if given.shape != (*array.shape[:-1], 4):
            raise ValueError(
                f"orientations: expected shape {(*array.shape[:-1], 4)} as of the positions, got {given.shape}"
            )
        clip, _ = _validation.clip(given.reshape(-1, points, 4), "orientations")
        valid: Mask = np.logical_and.reduce(np.isfinite(clip), axis=2) & (clip != 0).any(axis=2)
        turns = np.where(valid[..., None], clip, turns).astype(np.float64)
        turns = ops().normalize(turns.reshape(-1, 4)).reshape(turns.shape)
        turned = np.where(valid, trust, 0)
    return Trajectories(places, np.where(known, trust, 0), turns, turned), array.dtype


def _trust(value: ArrayLike | None, shape: tuple[int, ...], *, one: bool) -> Floats:
    frames, points = shape
    if value is None:
        return np.ones(shape)
    if one:
        trust: Array | None = _validation.pose_confidence(value, points)
        trust = None if trust is None else trust[None]
    else:
        trust = _validation.confidence(value, frames, points, np.dtype(np.float64))
    return np.ones(shape) if trust is None else np.asarray(trust, np.float64)


def _deviations(weights: Floats, noise: float) -> Floats:
    with np.errstate(divide="ignore"):
        return np.where(weights > 0, noise / np.sqrt(weights), np.inf)
