"""Pose search against scikit-learn's brute force on stacked poses."""

import itertools

import numpy as np
import pytest
import quatfilt as qf

neighbors = pytest.importorskip("sklearn.neighbors")

STARTS = np.array([0, 700, 705, 2000])

DIMS = 31


def motions(dtype, seed=0):
    """Return paths of poses, one after the other."""
    steps = np.random.default_rng(seed).standard_normal((STARTS[-1], DIMS))
    return (np.cumsum(steps, axis=0) / 10).astype(dtype)


def brute_force(features, queries, k, successors):
    """Return the last poses of the nearest segments, and their distances, by another library in float64."""
    m = queries.shape[1]
    ends = [e for first, last in itertools.pairwise(STARTS) for e in range(first + m - 1, last - successors)]
    stacked = np.stack([features[e + 1 - m : e + 1].ravel() for e in ends]).astype(np.float64)
    search = neighbors.NearestNeighbors(n_neighbors=k, algorithm="brute").fit(stacked)
    distances, found = search.kneighbors(queries.reshape(len(queries), -1).astype(np.float64))
    return np.asarray(ends)[found], distances


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("length", [1, 3])
@pytest.mark.parametrize("number", [1, 50])
def test_nearest_segments(dtype, length, number):
    features, path = motions(dtype), motions(dtype, seed=1)
    queries = np.stack([path[t : t + length] for t in np.linspace(0, 1900, number).astype(int)])
    indices, distances = qf.nearest_segments(features, STARTS, queries, k=20, successors=2)
    expected, expected_distances = brute_force(features, queries, 20, 2)
    np.testing.assert_array_equal(indices, expected)
    np.testing.assert_allclose(distances, expected_distances, rtol=2e-6 if dtype is np.float32 else 1e-10)


def test_along_a_motion():
    features, path = motions(np.float64), motions(np.float64, seed=1)
    search = qf.PoseSearch(features, STARTS, k=20, successors=2)
    queries = np.stack([path[t : t + 3] for t in range(300)])
    found = [search(query)[0] for query in queries]
    np.testing.assert_array_equal(found, brute_force(features, queries, 20, 2)[0])


def test_the_graph():
    features = motions(np.float64)
    indices, distances = qf.neighbor_graph(features, STARTS, degree=8, exclusion=0, spacing=1)
    ends = np.flatnonzero(indices[:, 0] >= 0)
    expected, expected_distances = brute_force(features, features[ends, None], 9, 1)
    # The other library finds each pose itself first.
    np.testing.assert_array_equal(expected[:, 0], ends)
    np.testing.assert_array_equal(indices[ends], expected[:, 1:])
    np.testing.assert_allclose(distances[ends], expected_distances[:, 1:], rtol=1e-10)
