"""Search from frame to frame: the nearest segments of one frame lie near those of the next.

Along a graph as in J. Chai and J. K. Hodgins, *Performance animation from low-dimensional control signals*,
SIGGRAPH 2005, but best first, as in algorithm 2 of Y. A. Malkov and D. A. Yashunin, *Efficient and robust approximate nearest
neighbor search using hierarchical navigable small world graphs*, 2020; without a graph, the exact search of every frame.
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
    breadth: int
    refresh: int
    ratio: float
    _ends: Indices = field(init=False)
    _before: list[int] = field(default_factory=list)
    _since: float = math.inf
    _least: float = 0.0

    def __post_init__(self) -> None:
        self._ends = candidates(self.starts, self.length, self.successors)
        self.breadth = self.k if self.graph is None else max(self.breadth, self.k)

    def next(self, query: Reals, first: int, last: int, /) -> tuple[NDArray[np.int64], Reals, bool]:
        """Find the segments nearest to `query`, `(length, dims)`, but for those from `first` to before `last`.

        Returns their numbers and distances, `(k,)`, and whether all segments were looked at.
        """
        if not np.isfinite(query).all():
            self._since = math.inf
            return self._written(np.zeros(0, np.intp)), np.full(self.k, np.inf, query.dtype), False
        found: tuple[Indices, Reals] = np.zeros(0, np.intp), np.zeros(0)
        kept = False
        if self.graph is not None and self._since < self.refresh:
            found = self._walk(self.graph, query, first, last)
            kept = len(found[0]) >= self.k and (
                math.isinf(self.ratio) or math.sqrt(found[1][self.k - 1]) <= self.ratio * self._least
            )
        if not kept:
            excluded = np.array([[first, last]])
            indices, _ = nearest_segments(
                self.features, self.starts, query[None], self.breadth, self.successors, excluded
            )
            ends = indices[0][indices[0] != NOBODY]
            found = ends, square_distances(self.features, ends, query)
        ends, squares = found
        if len(ends) >= self.k:
            last_of_them = math.sqrt(squares[self.k - 1])
            self._least = min(self._least, last_of_them) if kept else last_of_them
        self._since = self._since + 1 if kept else 0
        self._before = ends.tolist()
        distances = np.full(self.k, np.inf, query.dtype)
        distances[: len(ends)] = np.sqrt(squares[: self.k])
        return self._written(ends), distances, not kept

    def reset(self) -> None:
        """Forget the frames before."""
        self._since = math.inf

    def _walk(self, graph: NDArray[np.int32], query: Reals, first: int, last: int) -> tuple[Indices, Reals]:
        """Go out from the nearest before and their successors, from the nearest that is known to its neighbours."""
        allowed = np.zeros(len(graph) + 1, bool)
        allowed[self._ends] = True
        allowed[first:last] = False
        seen: set[int] = set()
        left: set[int] = set()
        nearest: list[tuple[float, int]] = []
        around = [end for before in self._before for end in (before, before + 1)]
        while True:
            fresh = sorted({end for end in around if end >= 0 and allowed[end]} - seen)
            seen.update(fresh)
            squares = square_distances(self.features, np.array(fresh, np.intp), query).tolist()
            finite = [pair for pair in zip(squares, fresh, strict=True) if math.isfinite(pair[0])]
            nearest = sorted([*nearest, *finite])[: self.breadth]
            centre = next((end for _, end in nearest if end not in left), None)
            if centre is None:
                break
            left.add(centre)
            around = [centre - 1, centre + 1, *graph[centre].tolist()]
        return np.array([end for _, end in nearest], np.intp), np.array([square for square, _ in nearest])

    def _written(self, ends: Indices) -> NDArray[np.int64]:
        indices = np.full(self.k, NOBODY, np.int64)
        indices[: len(ends)] = ends[: self.k]
        return indices


def segment_walk(
    features: Reals,
    starts: NDArray[np.int64],
    graph: NDArray[np.int32] | None,
    k: int,
    length: int,
    successors: int,
    breadth: int,
    refresh: int,
    ratio: float,
) -> SegmentWalk:
    """Make a search along a motion for the `k` nearest segments of `length` poses.

    Without a graph, each frame has all segments looked at; `breadth`, `refresh` and `ratio` do not matter then.

    With one, in the first frame, and where it says so below, all segments are looked at. Otherwise the `breadth` nearest of the frame
    before, at least `k`, and the poses after them are known at first, and a list holds the `breadth` nearest of what is known. Again and
    again the nearest of the list whose neighbours are not known yet makes them known: those in `graph`, `(poses, degree)`, the
    pose before it and that after it. The search ends where none is left in the list.

    All segments are looked at again after `refresh` frames, where there are fewer than `k` candidates, and where the
    last of the nearest is more than `ratio` times as far as it was at best since all were looked at.
    """
    return SegmentWalk(features, starts, graph, k, length, successors, breadth, refresh, ratio)
