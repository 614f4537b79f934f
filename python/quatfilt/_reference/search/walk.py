"""Search from frame to frame: the nearest segments of one frame lie near those of the next.

Along a graph as in J. Chai and J. K. Hodgins, *Performance animation from low-dimensional control signals*,
SIGGRAPH 2005; without one, the exact search of every frame.
"""

import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from quatfilt._reference._arrays import Indices, Reals
from quatfilt._reference.search.poses import NOBODY, candidates, nearest_segments, square_distances


@dataclass
class SegmentWalk:
    """A search along a motion; see :func:`segment_walk`."""

    features: Reals
    starts: NDArray[np.int64]
    graph: NDArray[np.int32] | None
    k: int
    length: int
    successors: int
    refresh: int
    ratio: float
    _ends: Indices = field(init=False)
    _before: list[int] = field(default_factory=list)
    _since: float = math.inf
    _least: float = 0.0

    def __post_init__(self) -> None:
        self._ends = candidates(self.starts, self.length, self.successors)

    def next(self, query: Reals, first: int, last: int, /) -> tuple[NDArray[np.int64], Reals, bool]:
        """Find the segments nearest to `query`, `(length, dims)`, but for those from `first` to before `last`.

        Returns their numbers and distances, `(k,)`, and whether all segments were looked at.
        """
        if not np.isfinite(query).all():
            self._since = math.inf
            return self._written(np.zeros(0, np.intp)), np.full(self.k, np.inf, query.dtype), False
        found: tuple[Indices, Reals] = np.zeros(0, np.intp), np.zeros(0)
        trusted = False
        if self.graph is not None and self._since < self.refresh:
            found = self._walk(self.graph, query, first, last)
            trusted = len(found[0]) == self.k and (
                math.isinf(self.ratio) or math.sqrt(found[1][-1]) <= self.ratio * self._least
            )
        if not trusted:
            excluded = np.array([[first, last]])
            indices, _ = nearest_segments(
                self.features, self.starts, query[None], self.k, self.successors, excluded
            )
            ends = indices[0][indices[0] != NOBODY]
            found = ends, square_distances(self.features, ends, query)
        ends, squares = found
        if len(ends) == self.k:
            last_of_them = math.sqrt(squares[-1])
            self._least = min(self._least, last_of_them) if trusted else last_of_them
        self._since = self._since + 1 if trusted else 0
        self._before = ends.tolist()
        distances = np.full(self.k, np.inf, query.dtype)
        distances[: len(ends)] = np.sqrt(squares)
        return self._written(ends), distances, not trusted

    def reset(self) -> None:
        """Forget the frames before."""
        self._since = math.inf

    def _walk(self, graph: NDArray[np.int32], query: Reals, first: int, last: int) -> tuple[Indices, Reals]:
        """Find the nearest of the nearest before, their successors, and the neighbours of both."""
        near = [end for before in self._before for end in (before, before + 1) if end < len(graph)]
        ends = np.intersect1d(np.concatenate([near, graph[near].ravel()]).astype(np.intp), self._ends)
        ends = ends[(ends < first) | (ends >= last)]
        squares = square_distances(self.features, ends, query)
        ends, squares = ends[np.isfinite(squares)], squares[np.isfinite(squares)]
        order = np.argsort(squares, kind="stable")[: self.k]
        return ends[order], squares[order]

    def _written(self, ends: Indices) -> NDArray[np.int64]:
        indices = np.full(self.k, NOBODY, np.int64)
        indices[: len(ends)] = ends
        return indices


def segment_walk(
    features: Reals,
    starts: NDArray[np.int64],
    graph: NDArray[np.int32] | None,
    k: int,
    length: int,
    successors: int,
    refresh: int,
    ratio: float,
) -> SegmentWalk:
    """Make a search along a motion for the `k` nearest segments of `length` poses.

    Without a graph, each frame has all segments looked at; `refresh` and `ratio` do not matter then.

    With one, in the first frame, and where it says so below, all segments are looked at. Otherwise the candidates are the nearest of the
    frame before, the poses after them, and the neighbours of both in `graph`, `(poses, degree)`.

    All segments are looked at again after `refresh` frames, where there are fewer than `k` candidates, and where the
    last of the nearest is more than `ratio` times as far as it was at best since all were looked at.
    """
    return SegmentWalk(features, starts, graph, k, length, successors, refresh, ratio)
