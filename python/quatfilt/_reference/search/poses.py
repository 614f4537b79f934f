"""Pose search: the segments of poses in a database that are nearest to a query."""

import itertools

import numpy as np
from numpy.typing import NDArray

from quatfilt._reference._arrays import Indices, Reals

NO_NEIGHBOR = -1
"""Index of a missing neighbour; its distance is infinite."""


def nearest_segments(
    features: Reals,
    starts: NDArray[np.int64],
    queries: Reals,
    k: int,
    successors: int,
    excluded: NDArray[np.int64] | None,
) -> tuple[NDArray[np.int64], Reals]:
    """Find the `k` nearest segments of `m` poses to each query.

    A segment is identified by the index `e` of its last pose. Its distance to a query `Q` is

        `d(e, Q)² = Σ_{i<m} |f[e−i] − Q[m−1−i]|²`.

    The cost is `queries · poses · m · dims`.

    Parameters
    ----------
    features : array (poses, dims)
        Poses; their distances are Euclidean. Segments with values that are not finite are not candidates.
    starts : array (clips + 1,)
        The first pose of each clip, followed by the number of poses.
    queries : array (queries, m, dims)
        Segments; one with values that are not finite has no neighbours.
    k : int
        Number of neighbours per query.
    successors : int
        Number of poses of its clip that must follow a candidate.
    excluded : array (queries, 2) or None
        Candidates `first ≤ e < last` that are left out.

    Returns
    -------
    indices : array (queries, k)
        Nearest first; ties go to the lower index. −1 for missing entries.
    distances : array (queries, k)
        Infinite for missing entries.
    """
    ends = candidates(starts, queries.shape[1], successors)
    indices = np.full((len(queries), k), NO_NEIGHBOR, np.int64)
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
    """Find the `degree` nearest segments to each segment, with minimum distances in time.

    Parameters
    ----------
    features : array (poses, dims)
        Poses.
    starts : array (clips + 1,)
        The first pose of each clip, followed by the number of poses.
    degree : int
        Number of neighbours per segment.
    length : int, poses
        The length of a segment.
    successors : int
        Number of poses of its clip that must follow a candidate.
    exclusion : int, poses
        Segments of the same clip at most this many poses away are not neighbours.
    spacing : int, poses
        Minimum distance between two neighbours of the same clip; the nearer one is kept.

    Returns
    -------
    indices : array (poses, degree)
        As of :func:`nearest_segments`; −1 in the row of a pose that ends no candidate.
    distances : array (poses, degree)
    """
    indices = np.full((len(features), degree), NO_NEIGHBOR, np.int32)
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
    """Return the indices of the first `count` ends that are at least `spacing` poses from earlier ones in their clip."""
    chosen: list[int] = []
    free = np.ones(len(clip), bool)
    for index, end in enumerate(ends):
        if end != NO_NEIGHBOR and free[end] and len(chosen) < count:
            chosen.append(index)
            near = slice(max(0, int(end) - spacing + 1), int(end) + spacing)
            free[near] &= clip[near] != clip[end]
    return chosen
