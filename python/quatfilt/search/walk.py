"""Search along a motion, from frame to frame."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from quatfilt import _validation
from quatfilt._backend import ops
from quatfilt._typing import Array

_MOST = 100_000
"""Neighbours that are kept sorted."""

_LONGEST = 100_000
"""Poses, and frames: clips are hardly longer."""


class PoseSearch:
    """Find the nearest segments of a database for one frame of a motion after the other.

    Without a graph the search is exact: what is found is what `nearest_segments` finds. It is faster in sequence, for what was far
    from one frame cannot be near to the next, and is looked at again only when the motion has travelled far enough.

    With a graph it begins with the nearest of the frame before and the poses after them. From the nearest that it knows it goes on to
    the neighbours of that, in the graph and in time, and so forth, until it has been at all of the `breadth` nearest. All segments are
    looked at in the first frame, after every `refresh` frames, where there are fewer than `k` candidates, and where the last of the
    nearest is more than `ratio` times as far as it was at best since all were looked at. The distances are exact; what a search along
    the graph may miss are segments.

    Parameters
    ----------
    features : array_like, shape (poses, dims)
        Poses as vectors whose distances are those of the poses: `MotionDatabase.features`. A memory map is read in place.
    starts : array_like of int, shape (clips + 1,)
        The first pose of each clip, and the number of poses.
    graph : array_like of int32, shape (poses, degree), or None, default None
        Neighbours of each pose, −1 where there are fewer: what `neighbor_graph` returns, or `MotionDatabase.graph`. None: the
        search is exact, and `breadth`, `refresh` and `ratio` do not matter.
    k : int, default 64
        How many segments are found for each frame; from 1 to 100,000.
    length : int, poses, default 3
        Length of a segment.
    successors : int, poses, default 1
        How many poses of its clip must follow a segment that is found.
    breadth : int, default 256
        From how many of the nearest a search along the graph goes on to their neighbours; fewer than `k` count as `k`. More of them miss
        less, and take as much longer.
    refresh : int, frames, default 15
        Frames after which all segments are looked at again; 0 for every frame.
    ratio : float, default 1.5
        How many times as far as at best the last of the `k` may be before all are looked at; infinite: any distance will do.

    Raises
    ------
    ValueError, TypeError
        If an argument has another shape, type or range than stated; the message names it.

    See Also
    --------
    nearest_segments : An exact search for each query.
    neighbor_graph : The graph.

    Notes
    -----
    Cost of a frame along a graph: at most ``breadth·(degree + 4)`` segments; they overlap, and are fewer: on motions four times
    `breadth`. Without one: a bound for eight poses, and a few hundredths of the poses. Memory: 77 bytes for each pose, and 1 ms for
    a thousand poses to set it up, besides `features` and `graph`.

    References
    ----------
    .. [1] J. Chai and J. K. Hodgins, "Performance animation from low-dimensional control signals", SIGGRAPH 2005.
    .. [2] Y. A. Malkov and D. A. Yashunin, "Efficient and robust approximate nearest neighbor search using hierarchical navigable small
       world graphs", IEEE Transactions on Pattern Analysis and Machine Intelligence 42, 2020.

    Examples
    --------
    >>> import numpy as np, quatfilt as qf
    >>> features = np.sin(np.arange(400)[:, None] / [5.0, 7.0, 11.0])
    >>> search = qf.PoseSearch(features, [0, 400], k=2)
    >>> for frame in (100, 101):
    ...     indices, distances = search(features[frame - 2 : frame + 1] + 0.01)
    >>> indices
    array([101, 102])
    """

    __slots__ = ("_dtype", "_full", "_shape", "_walk")

    def __init__(
        self,
        features: ArrayLike,
        starts: ArrayLike,
        graph: ArrayLike | None = None,
        *,
        k: int = 64,
        length: int = 3,
        successors: int = 1,
        breadth: int = 256,
        refresh: int = 15,
        ratio: float = 1.5,
    ) -> None:
        poses = _validation.features(features, "features")
        steps = _validation.integer(length, "length", at_least=1, at_most=_LONGEST)
        self._walk = ops().segment_walk(
            poses,
            _validation.starts(starts, "starts", len(poses)),
            None if graph is None else _validation.graph(graph, "graph", len(poses)),
            _validation.integer(k, "k", at_least=1, at_most=_MOST),
            steps,
            _validation.integer(successors, "successors", at_least=0, at_most=_LONGEST),
            _validation.integer(breadth, "breadth", at_least=1, at_most=_MOST),
            _validation.integer(refresh, "refresh", at_least=0, at_most=_LONGEST),
            _validation.number(ratio, "ratio", at_least=1, infinite=True),
        )
        self._shape = steps, poses.shape[1]
        self._dtype = poses.dtype
        self._full = False

    @property
    def full(self) -> bool:
        """Whether all segments were looked at for the last frame, or passed over for certain."""
        return self._full

    def __call__(
        self, query: ArrayLike, *, exclude: ArrayLike | None = None
    ) -> tuple[NDArray[np.int64], Array]:
        """Find the segments nearest to the next frame's.

        Parameters
        ----------
        query : array_like, shape (length, dims)
            The last poses of the motion. One with a number that is not finite finds nothing, and all segments are looked at for the
            next.
        exclude : array_like of int, shape (2,), or None, default None
            Segments ``first ≤ e < last`` that are not found.

        Returns
        -------
        indices : ndarray of int64, shape (k,)
            The last poses of the segments, nearest first. −1 where there are fewer.
        distances : ndarray, shape (k,)
            Their distances; infinite where there are fewer.

        Raises
        ------
        ValueError, TypeError
            If an argument has another shape, type or range than stated; the message names it.
        """
        poses = _validation.floats(query, "query")
        if poses.shape != self._shape:
            raise ValueError(f"query: expected shape {self._shape}, got {poses.shape}")
        sought = np.require(poses, self._dtype, ("C_CONTIGUOUS", "ALIGNED"))
        first, last = (0, 0) if exclude is None else _validation.ranges(exclude, "exclude", 1)[0].tolist()
        indices, distances, self._full = self._walk.next(sought, first, last)
        return indices, distances

    def reset(self) -> None:
        """Forget the frames before: another motion begins."""
        self._walk.reset()


__all__ = ["PoseSearch"]
