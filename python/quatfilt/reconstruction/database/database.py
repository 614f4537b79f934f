"""Databases of poses."""

import os
from collections.abc import Iterable, Sequence
from typing import Any, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from quatfilt import _validation
from quatfilt._backend import ops
from quatfilt._typing import Array
from quatfilt.motion.motion import Motion
from quatfilt.reconstruction.database import building, file
from quatfilt.reconstruction.database.body import JointsError
from quatfilt.reconstruction.database.folders import Folders
from quatfilt.reconstruction.database.held import Held
from quatfilt.reconstruction.database.takes import Axis, How
from quatfilt.search.poses import nearest_segments, neighbor_graph

PathLike = str | os.PathLike[str]


class MotionDatabase(Held):
    """Poses of many clips: what motion is reconstructed from.

    `from_motions` makes one of motions, `from_folders` of files, and `open` of a file that `save` wrote, without reading it.
    All clips have the same joints, matched by name, and one frame rate; the heading of the root, its rotation about the vertical,
    is kept apart, so that a body that walks north and one that walks east are in the same pose. Nothing of a database changes
    but its `graph`.

    Parameters
    ----------
    contents : Contents
        What the class methods put together.
    graph : array_like of int, shape (poses, degree), optional
        Neighbours of each pose, for a search that goes from neighbour to neighbour; −1 where there are fewer.

    Raises
    ------
    ValueError
        If the graph does not fit the poses.

    See Also
    --------
    Motion, read_motion

    References
    ----------
    .. [1] C. Mousas, P. Newbury, C.-N. Anagnostopoulos, "Data-driven motion reconstruction using local regression models",
       AIAI 2014.

    Examples
    --------
    >>> import numpy as np, quatfilt as qf
    >>> arm = qf.Skeleton(["shoulder", "elbow"], [-1, 0], [[0.0, 0, 0], [0, -30, 0]])
    >>> swing = qf.exp(np.sin(np.arange(240) / 20)[:, None, None] * [[0.5, 0, 0], [0.2, 0, 0]])
    >>> db = qf.MotionDatabase.from_motions([qf.Motion(swing, fps=120, skeleton=arm)], fps=60)
    >>> db
    MotionDatabase(120 poses of 2 joints, 1 clip, 60 fps)
    >>> db.motion(0)
    Motion(120 frames of 2 joints, 60 fps, 2 s, float32)
    """

    __slots__ = ()

    @classmethod
    def from_motions(
        cls,
        motions: Iterable[Motion],
        *,
        fps: float = 60.0,
        mirror: bool = False,
        up: Axis = "y",
        clip_names: Sequence[str] | None = None,
        joint_weights: ArrayLike | None = None,
        max_gap: float = 0.1,
        min_length: float = 0.5,
    ) -> Self:
        """Make a database of motions.

        Parameters
        ----------
        motions : iterable of Motion
            Clips of the same joints, in any order of the joints, at any frame rate and in any unit.
        fps : float, hertz, default 60
            Frame rate of the database, at most a hundred times that of a clip.
        mirror : bool, default False
            Whether the mirror image of every clip is added: left and right joints, told by their names, change places.
        up : {"x", "y", "z"}, default "y"
            The vertical: ``"y"`` in CMU's recordings and most BVH files, ``"z"`` in AMASS.
        clip_names : sequence of str, optional
            Names of the clips; by default their numbers.
        joint_weights : array_like, shape (joints,), optional
            Weights in the distance of poses, in the order of the first clip's joints; by default in proportion to the length of
            the chain below each joint.
        max_gap : float, seconds, default 0.1
            Longest run of missing samples that is filled; clips are cut at longer ones.
        min_length : float, seconds, default 0.5
            Shorter clips, and pieces of clips, are left out.

        Returns
        -------
        MotionDatabase
            In memory, 884 bytes for each pose of 31 joints. Its `notes` say what was left out.

        Raises
        ------
        ValueError
            If the joints differ, the frame rate is too high, nothing is left, or with ``mirror=True`` left and right are not to be found.
        TypeError
            If one of the motions is none, or an option is of another type.
        """
        if not isinstance(motions, Iterable):
            raise TypeError(f"motions: expected a sequence of Motions, got {type(motions).__name__}")
        given = list(motions)
        for number, motion in enumerate(given):
            if not isinstance(motion, Motion):
                raise TypeError(f"motions[{number}]: expected a Motion, got {type(motion).__name__}")
        if not given:
            raise ValueError("motions: expected at least one, got none")
        if clip_names is None:
            names = [str(number) for number in range(len(given))]
        elif isinstance(clip_names, str) or not isinstance(clip_names, Iterable):
            raise TypeError(f"clip_names: expected a sequence of names, got {type(clip_names).__name__}")
        else:
            names = [str(name) for name in clip_names]
        if len(names) != len(given):
            raise ValueError(f"clip_names: expected one for each of {len(given)} motions, got {len(names)}")
        how = How.checked(fps=fps, up=up, max_gap=max_gap, min_length=min_length)
        weights = _weights(joint_weights, len(given[0].skeleton))
        builder = building.Builder(how, mirror=_validation.switch(mirror, "mirror"), weights=weights)
        for motion, name in zip(given, names, strict=True):
            try:
                builder.add(motion, name)
            except JointsError as error:
                raise ValueError(f"motions: {error}") from None
        return cls(builder.in_memory())

    @classmethod
    def from_folders(
        cls,
        folders: PathLike | Iterable[PathLike],
        *,
        path: PathLike | None = None,
        fps: float = 60.0,
        mirror: bool = False,
        up: Axis = "y",
        source_fps: float | None = None,
        skip_others: bool = False,
        max_gap: float = 0.1,
        min_length: float = 0.5,
        workers: int | None = None,
    ) -> Self:
        """Make a database of all motion files of some folders.

        Parameters
        ----------
        folders : path or iterable of paths
            Folders, searched at any depth for ``.bvh``, ``.amc`` and ``.npz`` files, and such files.
        path : path, optional
            Where the database is written, clip by clip, and opened again: memory then holds a few clips at a time. By default it
            stays in memory.
        fps, mirror, up, max_gap, min_length
            As in `from_motions`.
        source_fps : float, hertz, optional
            Frame rate of the files, instead of what they say.
        skip_others : bool, default False
            Whether files of other joints than most are left out; by default they are refused.
        workers : int, optional
            How many files are read at once; by default one per processor.

        Returns
        -------
        MotionDatabase
            Its `notes` say what was left out: files that cannot be read are.

        Raises
        ------
        ValueError
            As in `from_motions`, or if there is no motion file.
        FileAccessError
            If a folder does not exist, or `path` cannot be written.
        """
        how = How.checked(fps=fps, up=up, max_gap=max_gap, min_length=min_length)
        single = isinstance(folders, (str, os.PathLike)) or not isinstance(folders, Iterable)
        given: Iterable[Any] = [folders] if single else folders  # type: ignore[assignment]
        places = [_validation.path(place, "folders") for place in given]
        target = None if path is None else _validation.path(path, "path")
        source = Folders(
            places,
            source_fps=None if source_fps is None else _validation.number(source_fps, "source_fps", above=0),
            skip_others=_validation.switch(skip_others, "skip_others"),
            workers=None if workers is None else _validation.integer(workers, "workers", at_least=1),
        )
        if target is None:
            return cls(building.in_memory(source, how, mirror=_validation.switch(mirror, "mirror")))
        building.to_file(source, how, target, mirror=_validation.switch(mirror, "mirror"))
        return cls.open(target)

    @classmethod
    def open(cls, path: PathLike, *, verify: bool = False) -> Self:
        """Open the file of a database.

        Its arrays are maps of the file: what is used is read when it is used.

        Parameters
        ----------
        path : str or path
            What `save` wrote.
        verify : bool, default False
            Whether the whole file is read and compared with its check sums, the arrays with a row for each pose too.

        Returns
        -------
        MotionDatabase
            With read-only arrays.

        Raises
        ------
        FileFormatError
            If it is no database, a damaged one, or one of a newer version.
        FileAccessError
            If it cannot be read.
        """
        return cls(file.read(_validation.path(path, "path"), verify=_validation.switch(verify, "verify")))

    def save(self, path: PathLike) -> None:
        """Write the database to a file.

        The file is written under a temporary name and renamed, so that an interrupted run leaves an older file as it was. The
        same database gives the same bytes.

        Parameters
        ----------
        path : str or path
            The file; any name will do.

        Raises
        ------
        FileAccessError
            If it cannot be written.
        """
        file.write(_validation.path(path, "path"), self._contents, self._graph)

    def nearest(
        self,
        queries: ArrayLike,
        *,
        k: int = 64,
        successors: int = 1,
        exclude: ArrayLike | None = None,
    ) -> tuple[NDArray[np.int64], Array]:
        """Find the segments of poses that are nearest to others, exactly: `nearest_segments` on `features` and `starts`.

        Parameters
        ----------
        queries, k, successors, exclude
            As there.

        Returns
        -------
        indices : ndarray of int64, shape (queries, k) or (k,)
            The last poses of the segments, nearest first; −1 where there are fewer.
        distances : ndarray of float32, shape (queries, k) or (k,)
            Their distances; infinite where there are fewer.

        Raises
        ------
        ValueError, TypeError
            As there.
        """
        return nearest_segments(
            self.features, self.starts, queries, k=k, successors=successors, exclude=exclude
        )

    def build_graph(self, *, degree: int = 16, exclusion: float = 0.25, spacing: float = 2 / 15) -> None:
        """Find the neighbours of each pose, for `PoseSearch`: sets `graph` to what `neighbor_graph` finds.

        Parameters
        ----------
        degree : int, default 16
            How many neighbours each pose has.
        exclusion : float, seconds, default 0.25
            Poses of the same clip that are at most so far away in time are no neighbours.
        spacing : float, seconds, default 2/15
            Of poses that lie less than so far apart in a clip only the nearest is a neighbour.

        Raises
        ------
        ValueError, TypeError
            As there.
        """
        frames = round(_validation.number(exclusion, "exclusion", at_least=0) * self.fps)
        apart = max(1, round(_validation.number(spacing, "spacing", at_least=0) * self.fps))
        self.graph, _ = neighbor_graph(
            self.features, self.starts, degree=degree, exclusion=frames, spacing=apart
        )

    def motion(self, clip: int) -> Motion:
        """Return a clip as a motion again, with its heading and its own skeleton.

        Parameters
        ----------
        clip : int
            Number of the clip; negative ones count from the end.

        Returns
        -------
        Motion
            float32, in the order of joints, the unit and at the frame rate of the database.

        Raises
        ------
        ValueError
            If there is no such clip.
        """
        clips = len(self.clip_names)
        number = _validation.integer(clip, "clip", at_least=-clips, at_most=clips - 1) % clips
        poses = slice(int(self.starts[number]), int(self.starts[number + 1]))
        rotations = self.rotations[poses].copy()
        turns = np.zeros((len(rotations), 3))
        turns[:, self.up] = self.heading[poses] / 2
        roots = np.ascontiguousarray(rotations[:, 0], np.float64)
        rotations[:, 0] = ops().multiply(ops().exp(turns), roots)
        return Motion(
            rotations,
            self.translation[poses],
            fps=self.fps,
            skeleton=self.skeletons[int(self.skeleton_indices[number])],
        )


def _weights(value: ArrayLike | None, joints: int) -> NDArray[np.float64] | None:
    if value is None:
        return None
    weights = _validation.per_joint(np.asarray(value), "joint_weights", joints, at_least=0)
    if not weights.any():
        raise ValueError("joint_weights: expected a weight above 0, got none")
    return weights


__all__ = ["MotionDatabase"]
