"""What a database holds, as its users see it."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from quatfilt import _validation
from quatfilt.motion.skeleton import Skeleton
from quatfilt.reconstruction.database.contents import Contents


class Held:
    """Poses of many clips with their skeletons, to be looked at; `MotionDatabase` makes, saves and searches them.

    Parameters
    ----------
    contents : Contents
        What was put together.
    graph : array_like of int, shape (poses, degree), optional
        Neighbours of each pose; −1 where there are fewer.

    Raises
    ------
    ValueError
        If the graph does not fit the poses.
    """

    __slots__ = ("_contents", "_graph")

    def __init__(self, contents: Contents, *, graph: ArrayLike | None = None) -> None:
        self._contents = contents
        self._graph = contents.graph
        if graph is not None:
            self.graph = graph

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the joints."""
        return self._contents.clips.names

    @property
    def parents(self) -> NDArray[np.int64]:
        """Index of each joint's parent, −1 for the root, the first joint; shape (joints,)."""
        return self._contents.clips.parents

    @property
    def fps(self) -> float:
        """Frames per second of all clips."""
        return self._contents.clips.fps

    @property
    def up(self) -> int:
        """Axis of the vertical: 0, 1 or 2."""
        return self._contents.clips.up

    @property
    def skeleton(self) -> Skeleton:
        """The mean skeleton: each clip's offsets count as often as it has poses."""
        return self._contents.clips.skeleton

    @property
    def skeletons(self) -> tuple[Skeleton, ...]:
        """The different skeletons of the clips, in the order of joints and the unit of `skeleton`."""
        return self._contents.clips.skeletons

    @property
    def skeleton_indices(self) -> NDArray[np.int64]:
        """Which of the `skeletons` each clip has; shape (clips,)."""
        return self._contents.clips.skeleton_indices

    @property
    def clip_names(self) -> tuple[str, ...]:
        """Names of the clips; ``walk[30:200]`` for a piece (frames of the source), ``walk mirrored`` for a mirror image."""
        return self._contents.clips.clip_names

    @property
    def starts(self) -> NDArray[np.int64]:
        """First pose of each clip, and the number of poses; shape (clips + 1,)."""
        return self._contents.clips.starts

    @property
    def rotations(self) -> NDArray[np.float32]:
        """Rotation of each joint in its parent, that of the root without heading; shape (poses, joints, 4).

        Continuous in sign within each clip.
        """
        return self._contents.rotations

    @property
    def heading(self) -> NDArray[np.float32]:
        """Turn of the root about the vertical, without jumps within each clip; shape (poses,), radians."""
        return self._contents.clips.heading

    @property
    def translation(self) -> NDArray[np.float32]:
        """Positions of the root; shape (poses, 3), units of `skeleton`."""
        return self._contents.clips.translation

    @property
    def mean_rotations(self) -> NDArray[np.float64]:
        """Karcher mean of each joint over all poses; shape (joints, 4)."""
        return self._contents.mean_rotations

    @property
    def joint_weights(self) -> NDArray[np.float64]:
        """Weight of each joint in the distance of poses; shape (joints,)."""
        return self._contents.joint_weights

    @property
    def features(self) -> NDArray[np.float32]:
        """Poses as vectors ``√w · 2 log(mean⁻¹ q)``, whose distances are those of the poses; shape (poses, 3·joints), radians."""
        return self._contents.features

    @property
    def graph(self) -> NDArray[np.int32] | None:
        """Neighbours of each pose, shape (poses, degree), −1 where there are fewer; None where nobody looked for them."""
        return self._graph

    @graph.setter
    def graph(self, neighbors: ArrayLike | None) -> None:
        self._graph = None if neighbors is None else _validation.graph(neighbors, "graph", len(self))

    @property
    def notes(self) -> tuple[str, ...]:
        """What was repaired, assumed or left out when the database was made."""
        return self._contents.clips.notes

    def __len__(self) -> int:
        return len(self._contents.rotations)

    def __repr__(self) -> str:
        joints, clips = len(self.names), len(self.clip_names)
        return (
            f"{type(self).__name__}({len(self)} pose{'s' * (len(self) != 1)} of {joints} joint{'s' * (joints != 1)}, "
            f"{clips} clip{'s' * (clips != 1)}, {self.fps:g} fps)"
        )


__all__ = ["Held"]
