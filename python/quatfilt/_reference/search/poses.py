"""Pose search: segments of poses in a database that are nearest to others."""

import itertools

import numpy as np
from numpy.typing import NDArray

from quatfilt._reference._arrays import Indices, Reals

NOBODY = -1
"""What stands for a neighbour that does not exist; its distance is infinite."""


def nearest_segments(
    features: Reals,
    starts: NDArray[np.int64],
    queries: Reals,
    k: int,
    successors: int,
    excluded: NDArray[np.int64] | None,
) -> tuple[NDArray[np.int64], Reals]:
    """Find the `k` nearest segments of `m` poses to each query.

    A segment is known by the number `e` of its last pose. Its distance to a query `Q` is

        `d(e, Q)² = Σ_{i<m} |f[e−i] − Q[m−1−i]|²`.

    The cost is `queries · poses · m · dims`.

    Parameters
    ----------
    features : array (poses, dims)
        Poses, the distances of which are Euclidean. Segments with a number that is not finite are no candidates.
    starts : array (clips + 1,)
        The first pose of each clip, and the number of poses.
    queries : array (queries, m, dims)
        The segments whose neighbours are sought. One with a number that is not finite has none.
    k : int
        How many.
    successors : int
        How many poses of its clip must follow a candidate.
    excluded : array (queries, 2) or None
        Candidates `first ≤ e < last` that do not count.

    Returns
    -------
    indices : array (queries, k)
        Nearest first; of two that are as near, the one of the lower number. −1 where there are fewer.
    distances : array (queries, k)
        Infinite where there are fewer.
    """
    ends = candidates(starts, queries.shape[1], successors)
    indices = np.full((len(queries), k), NOBODY, np.int64)
    distances = np.full((len(queries), k), np.inf, features.dtype)
    for i, query in enumerate(queries):
        squares = square_distances(features, ends, query)
        counting = np.isfinite(squares)
        if excluded is not None:
            counting &= (ends < excluded[i, 0]) | (ends >= excluded[i, 1])
        order = np.argsort(squares[counting], kind="stable")[:k]
        indices[i, : len(order)] = ends[counting][order]
        distances[i, : len(order)] = np.sqrt(squares[counting][order])
    return indices, distances


def candidates(starts: NDArray[np.int64], length: int, successors: int) -> Indices:
    """Return the last poses of all segments of `length` poses within a clip that `successors` poses follow."""
    return np.concatenate(
        [
            np.zeros(0, np.intp),
            *(np.arange(first + length - 1, last - successors) for first, last in itertools.pairwise(starts)),
        ]
    )


def square_distances(features: Reals, ends: Indices, query: Reals) -> Reals:
    """Return the squared distances of the segments that end at `ends` to a query `(m, dims)`, in float64."""
    squares = np.zeros(len(ends))
    with np.errstate(over="ignore", invalid="ignore"):
        for i in range(len(query)):
            difference = features[ends - i].astype(np.float64) - query[-1 - i].astype(np.float64)
            squares += np.sum(difference**2, axis=-1)
    return squares


def neighbor_graph(
    features: Reals,
    starts: NDArray[np.int64],
    degree: int,
    length: int,
    successors: int,
    exclusion: int,
    spacing: int,
) -> tuple[NDArray[np.int32], Reals]:
    """Find the `degree` nearest segments to each segment that lie apart from it and from each other.

    Parameters
    ----------
    features : array (poses, dims)
        Poses.
    starts : array (clips + 1,)
        The first pose of each clip, and the number of poses.
    degree : int
        How many.
    length : int, poses
        The length of a segment.
    successors : int
        How many poses of its clip must follow a candidate.
    exclusion : int, poses
        Segments of the same clip so near in time are no neighbours, nor is the segment itself.
    spacing : int, poses
        Of segments that lie less than so far apart in a clip only the nearest is a neighbour.

    Returns
    -------
    indices : array (poses, degree)
        As of :func:`nearest_segments`; −1 in the row of a pose at which no candidate ends.
    distances : array (poses, degree)
    """
    indices = np.full((len(features), degree), NOBODY, np.int32)
    distances = np.full((len(features), degree), np.inf, features.dtype)
    clip = np.searchsorted(starts, np.arange(len(features)), side="right")
    for first, last in itertools.pairwise(starts):
        for end in range(first + length - 1, last - successors):
            near = np.array([[max(end - exclusion, first), min(end + exclusion + 1, last)]])
            query = features[None, end + 1 - length : end + 1]
            found = nearest_segments(features, starts, query, len(features), successors, near)
            chosen = _apart(found[0][0], clip, spacing, degree)
            indices[end, : len(chosen)] = found[0][0, chosen]
            distances[end, : len(chosen)] = found[1][0, chosen]
    return indices, distances


def _apart(ends: NDArray[np.int64], clip: Indices, spacing: int, count: int) -> list[int]:
    """Return the places of the first `count` that are not less than `spacing` poses from one before them in a clip."""
    chosen: list[int] = []
    free = np.ones(len(clip), bool)
    for place, end in enumerate(ends):
        if end != NOBODY and free[end] and len(chosen) < count:
            chosen.append(place)
            near = slice(max(0, int(end) - spacing + 1), int(end) + spacing)
            free[near] &= clip[near] != clip[end]
    return chosen
