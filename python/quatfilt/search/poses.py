"""Pose search: segments of poses in a database that are nearest to others."""

from typing import cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from quatfilt import _validation
from quatfilt._backend import ops
from quatfilt._typing import Array

_MOST = 100_000
"""Neighbours that are kept sorted."""

_HIGHEST_DEGREE = 1_000
"""Neighbours of a pose: a search along the graph looks at all of them."""

_WIDEST_SPACING = 1_000
"""Poses: the cost grows with it."""

_LONGEST = 100_000
"""Poses: clips are hardly longer."""


def nearest_segments(
    features: ArrayLike,
    starts: ArrayLike,
    queries: ArrayLike,
    *,
    k: int = 64,
    successors: int = 1,
    exclude: ArrayLike | None = None,
) -> tuple[NDArray[np.int64], Array]:
    """Find the segments of poses in a database that are nearest to others.

    A segment is `m` poses in sequence within one clip, known by the number ``e`` of its last pose. Its distance to a query ``Q``
    is the root of ``Σ |features[e − i] − Q[m − 1 − i]|²`` over ``i = 0 … m − 1``. The search is exact.

    Parameters
    ----------
    features : array_like, shape (poses, dims)
        Poses as vectors whose distances are those of the poses: `MotionDatabase.features`. A memory map is read in place. A segment
        with a number that is not finite is never found.
    starts : array_like of int, shape (clips + 1,)
        The first pose of each clip, and the number of poses.
    queries : array_like, shape (queries, m, dims) or (m, dims)
        Segments whose neighbours are sought, such as the last `m` poses of a motion.
    k : int, default 64
        How many are found for each query; from 1 to 100,000.
    successors : int, poses, default 1
        How many poses of its clip must follow a segment that is found.
    exclude : array_like of int, shape (2,) or (queries, 2), or None, default None
        Segments ``first ≤ e < last`` that are not found, for all queries or each of them: those of the clip that a query comes
        from, for example.

    Returns
    -------
    indices : ndarray of int64, shape (queries, k) or (k,)
        The last poses of the segments, nearest first, of two that are as near the lower number first. −1 where there are fewer.
    distances : ndarray, shape (queries, k) or (k,)
        Their distances, of the type of `features`; infinite where there are fewer.

    Raises
    ------
    ValueError, TypeError
        If an argument has another shape, type or range than stated; the message names it.

    Notes
    -----
    Cost: at most ``queries · poses · m · dims``. Queries of fewer than ten poses together measure all segments, and read the poses once;
    more of them make an index first, that of `PoseSearch`, with which a query of real motions takes a tenth of the time or less. Memory
    of the index: 76 bytes for each pose in float32. Distances in float32 are exact to 1e-6 of themselves; numbers that differ by less
    than 1e-19 (float64: 1.5e-154) count as equal.

    Examples
    --------
    >>> import numpy as np, quatfilt as qf
    >>> features = np.sin(np.arange(200)[:, None] / [5.0, 7.0, 11.0])
    >>> indices, distances = qf.nearest_segments(features, [0, 120, 200], features[48:51], k=2)
    >>> indices
    array([50, 51])
    >>> distances.round(3)
    array([0.   , 0.353])
    """
    poses = _validation.features(features, "features")
    borders = _validation.starts(starts, "starts", len(poses))
    sought, single = _validation.queries(queries, "queries", poses)
    found = ops().nearest_segments(
        poses,
        borders,
        sought,
        _validation.integer(k, "k", at_least=1, at_most=_MOST),
        _validation.integer(successors, "successors", at_least=0, at_most=_LONGEST),
        None if exclude is None else _validation.ranges(exclude, "exclude", len(sought)),
    )
    indices, distances = cast("tuple[NDArray[np.int64], Array]", found)
    return (indices[0], distances[0]) if single else (indices, distances)


def neighbor_graph(
    features: ArrayLike,
    starts: ArrayLike,
    *,
    degree: int = 16,
    length: int = 1,
    successors: int = 1,
    exclusion: int = 15,
    spacing: int = 8,
) -> tuple[NDArray[np.int32], Array]:
    """Find the nearest segments of every segment of a database that lie apart: the graph that `PoseSearch` goes along.

    The graph is exact, and the same for any number of threads.

    Parameters
    ----------
    features : array_like, shape (poses, dims)
        Poses as vectors whose distances are those of the poses: `MotionDatabase.features`. A memory map is read in place.
    starts : array_like of int, shape (clips + 1,)
        The first pose of each clip, and the number of poses.
    degree : int, default 16
        How many neighbours each has; from 1 to 1,000.
    length : int, poses, default 1
        Length of the segments that are compared.
    successors : int, poses, default 1
        How many poses of its clip must follow a neighbour.
    exclusion : int, poses, default 15
        Poses of the same clip that are at most so far away in time are no neighbours: they are much the same, and a search comes to
        them by itself.
    spacing : int, poses, default 8
        Of poses that lie less than so far apart in a clip only the nearest is a neighbour, for the same reason: neighbours then lie in as
        many passages, and a search along the graph finds more of them. 1: any may be neighbours.

    Returns
    -------
    indices : ndarray of int32, shape (poses, degree)
        The last poses of the neighbours, nearest first. −1 where there are fewer, and in the row of a pose that ends no segment.
    distances : ndarray, shape (poses, degree)
        Their distances, of the type of `features`; infinite where there are fewer.

    Raises
    ------
    ValueError, TypeError
        If an argument has another shape, type or range than stated; the message names it.

    See Also
    --------
    nearest_segments : The nearest segments of others than those of the database.

    Notes
    -----
    Cost: that of one query of `nearest_segments` for each pose, with ``k = degree·spacing``, so it grows with the square of the number
    of poses. Memory while it works: 80 bytes for each pose, besides the result of ``8·degree``.

    References
    ----------
    .. [1] J. Chai and J. K. Hodgins, "Performance animation from low-dimensional control signals", SIGGRAPH 2005.

    Examples
    --------
    >>> import numpy as np, quatfilt as qf
    >>> features = np.sin(np.arange(200)[:, None] / [5.0, 7.0, 11.0])
    >>> indices, distances = qf.neighbor_graph(features, [0, 120, 200], degree=2)
    >>> indices[50]
    array([185, 177], dtype=int32)
    """
    poses = _validation.features(features, "features")
    found = ops().neighbor_graph(
        poses,
        _validation.starts(starts, "starts", len(poses)),
        _validation.integer(degree, "degree", at_least=1, at_most=_HIGHEST_DEGREE),
        _validation.integer(length, "length", at_least=1, at_most=_LONGEST),
        _validation.integer(successors, "successors", at_least=0, at_most=_LONGEST),
        _validation.integer(exclusion, "exclusion", at_least=0, at_most=_LONGEST),
        _validation.integer(spacing, "spacing", at_least=1, at_most=_WIDEST_SPACING),
    )
    return cast("tuple[NDArray[np.int32], Array]", found)


__all__ = ["nearest_segments", "neighbor_graph"]
