"""Pose search: the core against the reference."""

import numpy as np
import pytest
import tolerances
from hypothesis import given
from hypothesis import strategies as st
from quatfilt import _core, _reference
from quatfilt._reference.search.poses import square_distances


def walks(rng, poses, dims, roughness, dtype):
    """Return paths of poses."""
    steps = np.cumsum(rng.standard_normal((poses, dims)), axis=0) / 10
    steps += roughness * rng.standard_normal((poses, dims))
    return steps.astype(dtype)


def borders(rng, poses):
    """Return the borders of some clips, one of which is empty."""
    inner = np.sort(rng.integers(0, poses + 1, 3))
    return np.array([0, *inner, inner[-1], poses], np.int64)


def agree(result, expected, features, query_of):
    """Compare neighbours: where two are nearly as near, either may come first."""
    (indices, distances), (others, expected_distances) = result, expected
    assert indices.dtype == others.dtype
    assert distances.dtype == expected_distances.dtype
    np.testing.assert_array_equal(indices < 0, others < 0)
    np.testing.assert_allclose(distances, expected_distances, rtol=tolerances.distance(features.dtype))
    for i, e in np.argwhere(indices != others):
        square = square_distances(features, indices[i, e : e + 1], query_of(i))
        np.testing.assert_allclose(
            np.sqrt(square), expected_distances[i, e], rtol=tolerances.distance(features.dtype)
        )


@given(
    seed=st.integers(0, 2**32 - 1),
    poses=st.sampled_from([1, 5, 40, 700]),
    dims=st.sampled_from([1, 5, 32, 93]),
    length=st.integers(1, 4),
    number=st.sampled_from([1, 3, 12]),
    roughness=st.sampled_from([0.0, 0.3, 3.0]),
    dtype=st.sampled_from([np.float32, np.float64]),
)
def test_nearest_segments(seed, poses, dims, length, number, roughness, dtype):
    rng = np.random.default_rng(seed)
    features = walks(rng, poses, dims, roughness, dtype)
    features[rng.random(poses) < 0.01] = np.nan
    starts = borders(rng, poses)
    queries = walks(rng, number * length, dims, roughness, dtype).reshape(number, length, dims)
    excluded = np.sort(rng.integers(0, poses + 1, (number, 2))) if seed % 2 else None
    k, successors = int(rng.integers(1, 50)), int(rng.integers(0, 3))
    before = features.tobytes(), queries.tobytes()
    arguments = features, starts, queries, k, successors, excluded
    agree(
        _core.nearest_segments(*arguments),
        _reference.nearest_segments(*arguments),
        features,
        lambda i: queries[i],
    )
    assert (features.tobytes(), queries.tobytes()) == before, "the input was written"


# One measures everything, and so do a few poses; more make an index first.
@pytest.mark.parametrize(("number", "length"), [(1, 1), (1, 3), (7, 1), (5, 3), (24, 1), (1, 17)])
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_many_poses(number, length, dtype):
    rng = np.random.default_rng(0)
    features = walks(rng, 40_000, 30, 0.0, dtype)
    starts = borders(rng, 40_000)
    queries = features[rng.integers(0, 39_000, (number, 1)) + np.arange(length)] + dtype(0.01)
    features[rng.random(40_000) < 0.01] = np.nan
    excluded = np.sort(rng.integers(0, 40_000, (number, 2)))
    arguments = features, starts, queries, 64, 1, excluded
    agree(
        _core.nearest_segments(*arguments),
        _reference.nearest_segments(*arguments),
        features,
        lambda i: queries[i],
    )


@pytest.mark.parametrize("number", [1, 30])
@pytest.mark.parametrize(("dtype", "tiny"), [(np.float32, 1e-22), (np.float64, 1e-160)])
def test_numbers_whose_squares_lose_digits(number, dtype, tiny):
    rng = np.random.default_rng(0)
    features = walks(rng, 20_000, 40, 0.0, dtype)
    # What logarithms of rotations leave that never change.
    features[:, 5:20] = tiny * rng.standard_normal((20_000, 15))
    features[:, 20:] = 0
    queries = features[rng.integers(0, 20_000, number), None] + dtype(0.01)
    arguments = features, np.array([0, 20_000]), queries, 16, 0, None
    agree(
        _core.nearest_segments(*arguments),
        _reference.nearest_segments(*arguments),
        features,
        lambda i: queries[i],
    )


@given(
    seed=st.integers(0, 2**32 - 1),
    poses=st.sampled_from([1, 20, 150]),
    length=st.integers(1, 3),
    degree=st.sampled_from([1, 6, 40]),
    exclusion=st.sampled_from([0, 3, 500]),
    spacing=st.sampled_from([1, 2, 7, 500]),
    dtype=st.sampled_from([np.float32, np.float64]),
)
def test_neighbor_graph(seed, poses, length, degree, exclusion, spacing, dtype):
    rng = np.random.default_rng(seed)
    features = walks(rng, poses, 20, 0.1, dtype)
    features[rng.random(poses) < 0.02] = np.nan
    arguments = features, borders(rng, poses), degree, length, 1, exclusion, spacing
    agree(
        _core.neighbor_graph(*arguments),
        _reference.neighbor_graph(*arguments),
        features,
        lambda i: features[i + 1 - length : i + 1],
    )


@given(
    seed=st.integers(0, 2**32 - 1),
    length=st.integers(1, 3),
    degree=st.sampled_from([1, 4]),
    breadth=st.sampled_from([1, 6, 20, 300]),
    refresh=st.sampled_from([0, 5, 1000]),
    ratio=st.sampled_from([1.0, 1.2, np.inf]),
)
def test_walk(seed, length, degree, breadth, refresh, ratio):
    rng = np.random.default_rng(seed)
    features = walks(rng, 400, 12, 0.0, np.float64)
    starts = borders(rng, 400)
    graph, _ = _core.neighbor_graph(features, starts, degree, 1, 1, 5, 3)
    ours, theirs = (
        backend.segment_walk(features, starts, graph, 6, length, 1, breadth, refresh, ratio)
        for backend in (_core, _reference)
    )
    path = walks(rng, 60, 12, 0.0, np.float64)
    path[rng.random(60) < 0.02] = np.nan
    for t in range(60 - length):
        if t == 40:
            ours.reset()
            theirs.reset()
        query = path[t : t + length]
        result, expected = (walk.next(query, t, t + 10) for walk in (ours, theirs))
        np.testing.assert_array_equal(result[0], expected[0])
        np.testing.assert_allclose(result[1], expected[1], rtol=tolerances.distance(np.float64))
        assert result[2] == expected[2]


@given(
    seed=st.integers(0, 2**32 - 1),
    length=st.integers(1, 3),
    dims=st.sampled_from([1, 20]),
    speed=st.sampled_from([0.0, 0.02, 1.0, 1e4]),
    dtype=st.sampled_from([np.float32, np.float64]),
)
def test_along_a_motion_without_a_graph(seed, length, dims, speed, dtype):
    rng = np.random.default_rng(seed)
    features = walks(rng, 900, dims, 0.0, dtype)
    features[rng.random(900) < 0.01] = np.nan
    starts = borders(rng, 900)
    path = (speed * walks(rng, 60, dims, 0.0, np.float64)).astype(dtype)
    path[rng.random(60) < 0.02] = np.nan
    k = int(rng.integers(1, 70))
    ours, theirs = (
        backend.segment_walk(features, starts, None, k, length, 1, 1, 0, 1.0)
        for backend in (_core, _reference)
    )
    for t in range(60 - length):
        if t == 40:
            ours.reset()
            theirs.reset()
        query = path[t : t + length]
        # What is left out changes from frame to frame.
        result, expected = (walk.next(query, 10 * (t % 7), 300) for walk in (ours, theirs))
        agree(
            (result[0][None], result[1][None]),
            (expected[0][None], expected[1][None]),
            features,
            lambda _, query=query: query,
        )
        assert result[2] == expected[2]
        # To the last bit what a search of this frame alone finds.
        alone = _core.nearest_segments(features, starts, query[None], k, 1, np.array([[10 * (t % 7), 300]]))
        np.testing.assert_array_equal(result[0], alone[0][0])
        np.testing.assert_array_equal(result[1], alone[1][0])
