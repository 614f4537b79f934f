"""What a database holds, and how it comes together from takes."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from quatfilt._backend import ops
from quatfilt.motion.skeleton import EndSite, Skeleton
from quatfilt.reconstruction.database.body import Body
from quatfilt.reconstruction.database.doubts import Doubts
from quatfilt.reconstruction.database.takes import How, Take
from quatfilt.reconstruction.database.weights import joint_weights

POSES_AT_ONCE = 16 * 1024
"""Poses whose features are computed before they are written: a few megabytes."""


@dataclass(frozen=True)
class EndSites:
    """The ends of the last bones of several skeletons, in one table.

    Parameters
    ----------
    places : ndarray of float64, shape (sites, 5)
        Skeleton, joint and offset of each.
    names : tuple of str or None
        What files call them.
    """

    places: NDArray[np.float64]
    names: tuple[str | None, ...]

    @classmethod
    def of(cls, skeletons: Sequence[Skeleton]) -> "EndSites":
        """Return those of some skeletons."""
        sites = [(number, site) for number, skeleton in enumerate(skeletons) for site in skeleton.end_sites]
        rows = [(number, site.joint, *site.offset) for number, site in sites]
        return cls(np.array(rows, np.float64).reshape(-1, 5), tuple(site.name for _, site in sites))

    def at(self, skeleton: int) -> list[EndSite]:
        """Return those of one skeleton."""
        return [
            EndSite(int(self.places[row, 1]), tuple(self.places[row, 2:].tolist()), self.names[row])
            for row in np.flatnonzero(self.places[:, 0] == skeleton).tolist()
        ]


@dataclass(frozen=True)
class Clips:
    """All of a database but its rotations, and what follows from them.

    Parameters
    ----------
    names, parents, centimetres_per_unit, fps, up
        As the database's.
    offsets : ndarray of float64, shape (skeletons + 1, joints, 3)
        Those of the skeletons, and of their mean.
    end_sites : EndSites
        Likewise.
    skeleton_indices, clip_names, starts, heading, translation
        As the database's.
    notes : tuple of str
        What was repaired, assumed or left out.
    """

    names: tuple[str, ...]
    parents: NDArray[np.int64]
    centimetres_per_unit: float
    fps: float
    up: int
    offsets: NDArray[np.float64]
    end_sites: EndSites
    skeleton_indices: NDArray[np.int64]
    clip_names: tuple[str, ...]
    starts: NDArray[np.int64]
    heading: NDArray[np.float32]
    translation: NDArray[np.float32]
    notes: tuple[str, ...]

    @cached_property
    def skeletons(self) -> tuple[Skeleton, ...]:
        """The different skeletons of the clips."""
        return tuple(self._skeleton(number) for number in range(len(self.offsets) - 1))

    @cached_property
    def skeleton(self) -> Skeleton:
        """The mean skeleton."""
        return self._skeleton(len(self.offsets) - 1)

    def _skeleton(self, number: int) -> Skeleton:
        return Skeleton(
            self.names,
            self.parents,
            self.offsets[number],
            centimetres_per_unit=self.centimetres_per_unit,
            end_sites=self.end_sites.at(number),
        )


@dataclass(frozen=True)
class Contents:
    """Everything that a database holds.

    Parameters
    ----------
    clips : Clips
        The clips and their skeletons.
    rotations, mean_rotations, joint_weights, features, graph
        As the database's.
    """

    clips: Clips
    rotations: NDArray[np.float32]
    mean_rotations: NDArray[np.float64]
    joint_weights: NDArray[np.float64]
    features: NDArray[np.float32]
    graph: NDArray[np.int32] | None = None


@dataclass
class Gathering:
    """Takes as they come in, without their rotations: those go where the caller wants them.

    Parameters
    ----------
    body : Body
        The joints.
    how : How
        Frame rate and vertical.
    """

    body: Body
    how: How
    _doubts: Doubts = field(init=False)
    _skeletons: dict[tuple[bytes, tuple[EndSite, ...]], int] = field(default_factory=dict)
    _bodies: list[Skeleton] = field(default_factory=list)
    _takes: list[tuple[str, int, int]] = field(default_factory=list)
    _heading: list[NDArray[np.float32]] = field(default_factory=list)
    _translation: list[NDArray[np.float32]] = field(default_factory=list)

    def __post_init__(self) -> None:
        self._doubts = Doubts(self.how.up)

    def __len__(self) -> int:
        return len(self._takes)

    def add(self, take: Take) -> None:
        """Take note of a take."""
        key = (take.skeleton.offsets.tobytes(), take.skeleton.end_sites)
        number = self._skeletons.setdefault(key, len(self._bodies))
        if number == len(self._bodies):
            self._bodies.append(take.skeleton)
        self._takes.append((take.name, number, len(take.rotations)))
        self._doubts.look(take)
        self._heading.append(take.heading)
        self._translation.append(take.translation)

    def clips(self, notes: Iterable[str]) -> Clips:
        """Return what came in."""
        indices = np.array([number for _, number, _ in self._takes], np.int64)
        frames = np.array([frames for _, _, frames in self._takes], np.int64)
        shares = np.bincount(indices, frames, len(self._bodies)) / frames.sum()
        skeletons = [*self._bodies, _mean_skeleton(self._bodies, shares)]
        return Clips(
            self.body.names,
            self.body.parents,
            self.body.centimetres_per_unit,
            self.how.fps,
            self.how.up,
            np.stack([skeleton.offsets for skeleton in skeletons]),
            EndSites.of(skeletons),
            indices,
            tuple(name for name, _, _ in self._takes),
            np.concatenate([[0], np.cumsum(frames)]),
            np.concatenate(self._heading),
            np.concatenate(self._translation),
            (*notes, *self._doubts.notes(self.body.names[0])),
        )


def _mean_skeleton(skeletons: Sequence[Skeleton], shares: NDArray[np.float64]) -> Skeleton:
    """Return the skeleton of mean offsets, and of mean end sites where all have the same ones, else those of the first."""
    sites = skeletons[0].end_sites
    if all([s.joint for s in one.end_sites] == [s.joint for s in sites] for one in skeletons):
        ends = np.array([[site.offset for site in one.end_sites] for one in skeletons], np.float64)
        means = np.tensordot(shares, ends.reshape(len(skeletons), -1, 3), 1).tolist()
        sites = tuple(EndSite(s.joint, tuple(mean), s.name) for s, mean in zip(sites, means, strict=True))
    return Skeleton(
        skeletons[0].names,
        skeletons[0].parents,
        np.tensordot(shares, np.stack([skeleton.offsets for skeleton in skeletons]), 1),
        centimetres_per_unit=skeletons[0].centimetres_per_unit,
        end_sites=sites,
    )


def measured(
    clips: Clips,
    rotations: NDArray[np.float32],
    weights: NDArray[np.float64] | None,
    add: Callable[[NDArray[np.float32]], None],
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return means and weights of the joints, and hand out the features of all poses, some at a time."""
    means = ops().mean(rotations, None).astype(np.float64)
    if weights is None:
        weights = joint_weights(clips.skeleton)
    for start in range(0, len(rotations), POSES_AT_ONCE):
        add(ops().pose_features(rotations[start : start + POSES_AT_ONCE], means, weights))
    return means, weights
