"""Takes: unbroken stretches of a motion, as a database keeps them."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal, Self

import numpy as np
from numpy.typing import NDArray

from quatfilt import _validation
from quatfilt._backend import ops
from quatfilt._typing import Array, Mask
from quatfilt.filters.gaps import fill_gaps
from quatfilt.motion.motion import Motion
from quatfilt.motion.skeleton import Skeleton
from quatfilt.reconstruction.database.body import Body, listed
from quatfilt.rotations.resample import resample

Axis = Literal["x", "y", "z"]

_AXES: tuple[Axis, ...] = ("x", "y", "z")

_SAME_RATE = 1e-9
"""Relative difference of frame rates, or of their ratio from a whole number, that is a rounding."""

_MOVES = 1e-3
"""Joints that move in their parents by less of the longest bone do not: coordinates in files have a few digits."""


@dataclass(frozen=True)
class How:
    """How motions become takes.

    Parameters
    ----------
    fps : float, hertz
        Frame rate of the database.
    up : int
        Axis of the vertical.
    max_gap : float, seconds
        Longest run of missing samples that is filled.
    min_length : float, seconds
        Shortest stretch that is kept.
    """

    fps: float
    up: int
    max_gap: float
    min_length: float

    @classmethod
    def checked(cls, *, fps: float, up: str, max_gap: float, min_length: float) -> Self:
        """Return what a user asked for."""
        return cls(
            fps=_validation.number(fps, "fps", above=0),
            up=_AXES.index(_validation.choice(up, "up", _AXES)),
            max_gap=_validation.number(max_gap, "max_gap", at_least=0),
            min_length=_validation.number(min_length, "min_length", at_least=0),
        )


@dataclass(frozen=True)
class Take:
    """An unbroken stretch of a motion, at the frame rate, in the order and unit of a database.

    Parameters
    ----------
    name : str
        The clip.
    skeleton : Skeleton
        Its joints.
    rotations : ndarray of float32, shape (frames, joints, 4)
        Local rotations, continuous in sign; of the root, what its heading leaves.
    heading : ndarray of float32, shape (frames,), radians
        Turns of the root about the vertical.
    translation : ndarray of float32, shape (frames, 3)
        Positions of the root.
    """

    name: str
    skeleton: Skeleton
    rotations: NDArray[np.float32]
    heading: NDArray[np.float32]
    translation: NDArray[np.float32]


def takes(motion: Motion, name: str, body: Body, how: How, notes: list[str]) -> Iterator[Take]:
    """Cut a motion into takes.

    What is left out is added to `notes`.

    Raises
    ------
    ValueError
        If the motion has other joints than the body, or so low a frame rate that it would grow a hundredfold.
    """
    _validation.resampling(how.fps, "fps", motion.fps, name, faster=True)
    order, skeleton = body.arranged(motion.skeleton, name)
    if motion.joint_translations is not None:
        skeleton = _standing(motion, order, skeleton, name, notes)
    arranged = np.ascontiguousarray(motion.rotations[:, order], np.float64)
    rotations: Array = ops().normalize(arranged.reshape(-1, 4)).reshape(arranged.shape)
    scale = motion.skeleton.centimetres_per_unit / body.centimetres_per_unit
    translation: Array = motion.translation.astype(np.float64) * scale
    rotations, translation, usable = _filled(rotations, translation, motion.fps, how.max_gap)
    if not len(motion):
        notes.append(f"{name}: left out: no frames")
    borders = np.flatnonzero(np.diff(usable.astype(np.int8), prepend=0, append=0))
    for start, stop in borders.reshape(-1, 2).tolist():
        whole = stop - start == len(motion)
        piece = name if whole else f"{name}[{start}:{stop}]"
        seconds = (stop - start) / motion.fps
        if seconds < how.min_length:
            notes.append(f"{piece}: left out: {seconds:.3g} s, shorter than {how.min_length:g} s")
            continue
        path = rotations[start:stop], translation[start:stop]
        yield _take(piece, skeleton, path, motion.fps, how)
    if not usable.all():
        cut = len(motion) - np.count_nonzero(usable)
        notes.append(f"{name}: cut where samples are missing: {cut} of {len(motion)} frames left out")


def _standing(
    motion: Motion, order: NDArray[np.intp], skeleton: Skeleton, name: str, notes: list[str]
) -> Skeleton:
    """Return a skeleton whose joints stay where they are on average, for files that say so in every frame."""
    places = np.asarray(motion.joint_translations, np.float64)[:, order]
    scale = motion.skeleton.centimetres_per_unit / skeleton.centimetres_per_unit
    known = np.isfinite(places).all(axis=(0, 2)) & (skeleton.parents >= 0) & bool(len(places))
    offsets = skeleton.offsets.copy()
    offsets[known] = places[:, known].mean(axis=0) * scale
    reach = np.ptp(places[:, known], axis=0).max(axis=1, initial=0) * scale
    longest = np.linalg.norm(offsets[skeleton.parents >= 0], axis=1).max(initial=0)
    moving = [skeleton.names[joint] for joint in np.flatnonzero(known)[reach > _MOVES * longest]]
    if moving:
        notes.append(
            f"{name}: joints that move in their parents are kept at their mean places: {listed(moving)}"
        )
    return Skeleton(
        skeleton.names,
        skeleton.parents,
        offsets,
        centimetres_per_unit=skeleton.centimetres_per_unit,
        end_sites=skeleton.end_sites,
    )


def _filled(rotations: Array, translation: Array, fps: float, max_gap: float) -> tuple[Array, Array, Mask]:
    """Fill short gaps between samples, and tell which frames are complete then."""
    known: Mask = np.logical_and.reduce(np.isfinite(rotations), axis=2)
    placed: Mask = np.logical_and.reduce(np.isfinite(translation), axis=1)
    if known.all() and placed.all():
        return rotations, translation, placed
    rotations, _ = fill_gaps(rotations, max_gap=max_gap, fps=fps)
    complete = np.isfinite(rotations).all(axis=2) & _between(known)
    usable: Mask = np.logical_and.reduce(complete, axis=1)
    longest = math.floor(max_gap * fps + _SAME_RATE)
    frames = np.arange(len(placed))
    if placed.any():
        bridged = [np.interp(frames, frames[placed], translation[placed, c]) for c in range(3)]
        translation = np.where(placed[:, None], translation, np.stack(bridged, axis=1))
    usable &= _between(placed[:, None])[:, 0] & ~_longer_gaps(placed, longest)
    return rotations, translation, usable


def _between(known: Mask) -> Mask:
    """Tell the frames between the first and the last that are known, for each joint: elsewhere nothing is to be filled."""
    before = np.logical_or.accumulate(known, axis=0)
    after = np.logical_or.accumulate(known[::-1], axis=0)[::-1]
    between: Mask = before & after
    return between


def _longer_gaps(known: Mask, longest: int) -> Mask:
    """Tell the frames of runs that are not known and longer than `longest`."""
    longer = np.zeros(len(known), bool)
    borders = np.flatnonzero(np.diff((~known).astype(np.int8), prepend=0, append=0))
    for start, stop in borders.reshape(-1, 2).tolist():
        longer[start:stop] = stop - start > longest
    return longer


def _take(name: str, skeleton: Skeleton, path: tuple[Array, Array], fps: float, how: How) -> Take:
    rotations, translation = path
    ratio = fps / how.fps
    whole = max(1, round(ratio))
    if abs(ratio / whole - 1) < _SAME_RATE:
        # New frames lie on old ones, which interpolation would give back.
        rotations, translation = rotations[::whole], translation[::whole]
    else:
        rotations = resample(rotations, fps=fps, new_fps=how.fps)
        times = np.arange(len(rotations)) * ratio
        frames = np.arange(len(translation))
        translation = np.stack([np.interp(times, frames, translation[:, c]) for c in range(3)], axis=1)
    poses = rotations.astype(np.float32)
    heading, rest = ops().split_heading(np.ascontiguousarray(poses[:, 0]), how.up)
    poses[:, 0] = rest
    return Take(name, skeleton, ops().continuous(poses), heading, translation.astype(np.float32))
