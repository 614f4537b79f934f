"""Pose search: what holds for any matrix of poses."""

import itertools

import numpy as np
import pytest
import quatfilt as qf
from hypothesis import given
from hypothesis import strategies as st

STARTS = np.array([0, 120, 121, 121, 400, 640])


def motions(seed=0, dims=37, dtype=np.float64):
    """Return paths of poses, one after the other."""
    steps = np.random.default_rng(seed).standard_normal((STARTS[-1], dims))
    return (np.cumsum(steps, axis=0) / 10).astype(dtype)


def direct(features, query, ends):
    """Return the distances of segments, summed one by one."""
    m = len(query)
    return np.array([np.sqrt(((features[e + 1 - m : e + 1] - query) ** 2).sum()) for e in ends])


@pytest.mark.parametrize("length", [1, 2, 5])
def test_all_candidates_are_within_a_clip_and_have_successors(backend, length):
    features = motions()
    indices, distances = backend.nearest_segments(
        features, STARTS, features[None, 7 : 7 + length], 700, 2, None
    )
    expected = [e for first, last in itertools.pairwise(STARTS) for e in range(first + length - 1, last - 2)]
    found = indices[0][indices[0] >= 0]
    assert sorted(found) == expected
    np.testing.assert_allclose(distances[0, : len(found)], direct(features, features[7 : 7 + length], found))
    assert (np.diff(distances[0, : len(found)]) >= 0).all()
    assert (indices[0, len(found) :] == -1).all()
    assert np.isinf(distances[0, len(found) :]).all()


@pytest.mark.parametrize("number", [1, 9])
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_a_segment_finds_itself_at_distance_0(backend, number, dtype):
    features = motions(dtype=dtype)
    ends = np.linspace(130, 390, number).astype(int)
    queries = np.stack([features[e - 2 : e + 1] for e in ends])
    indices, distances = backend.nearest_segments(features, STARTS, queries, 3, 1, None)
    np.testing.assert_array_equal(indices[:, 0], ends)
    assert (distances[:, 0] == 0).all()
    assert (distances[:, 1] > 0).all()


@pytest.mark.parametrize("number", [1, 6])
def test_ties_go_to_the_lower_number(backend, number):
    features = np.tile(motions()[:32], (20, 1))
    queries = features[None, 40:43].repeat(number, axis=0)
    indices, distances = backend.nearest_segments(features, STARTS, queries, 6, 0, None)
    # Copies begin every 32 poses; those across a border of clips do not count.
    expected = [e for e in range(10, 640, 32) if e != 122][:6]
    for row in indices:
        np.testing.assert_array_equal(row, expected)
    assert (distances == 0).all()


def test_the_order_of_the_numbers_of_a_pose_does_not_matter(backend):
    features = motions()
    order = np.random.default_rng(1).permutation(features.shape[1])
    expected = backend.nearest_segments(features, STARTS, features[None, 50:53], 20, 1, None)
    shuffled = np.ascontiguousarray(features[:, order])
    result = backend.nearest_segments(shuffled, STARTS, shuffled[None, 50:53], 20, 1, None)
    np.testing.assert_array_equal(result[0], expected[0])
    np.testing.assert_allclose(result[1], expected[1])


@pytest.mark.parametrize("number", [1, 7])
def test_what_is_excluded_is_not_found(backend, number):
    features = motions()
    queries = features[None, 200:202].repeat(number, axis=0)
    excluded = np.array([[150, 260]]).repeat(number, axis=0)
    indices, _ = backend.nearest_segments(features, STARTS, queries, 640, 0, excluded)
    for row in indices:
        found = set(row[row >= 0].tolist())
        assert found.isdisjoint(range(150, 260))
        assert {149, 260} <= found


@pytest.mark.parametrize("value", [np.nan, np.inf])
@pytest.mark.parametrize("number", [1, 7])
def test_poses_that_are_not_finite_are_never_found_and_find_nothing(backend, number, value):
    features = motions()
    features[[10, 210, 211, 212, 300], [0, 36, 5, 5, 12]] = value
    queries = features[None, 205:207].repeat(number, axis=0)
    queries[-1] = features[209:211] if number > 1 else queries[-1]
    indices, distances = backend.nearest_segments(features, STARTS, queries, 640, 0, None)
    spoilt = {10, 11, 210, 211, 212, 213, 300, 301}
    found = set(indices[0][indices[0] >= 0].tolist())
    assert found.isdisjoint(spoilt)
    assert {209, 214, 299, 302} <= found
    if number > 1:
        assert (indices[-1] == -1).all()
        assert np.isinf(distances[-1]).all()


@given(
    seed=st.integers(0, 2**32 - 1),
    length=st.integers(1, 4),
    dims=st.sampled_from([1, 3, 31, 32, 33, 90]),
    noise=st.sampled_from([0.0, 0.1, 3.0]),
)
def test_many_queries_find_what_each_finds(backend, seed, length, dims, noise):
    rng = np.random.default_rng(seed)
    features = motions(seed, dims, np.float32)
    features += (noise * rng.standard_normal(features.shape)).astype(np.float32)
    first = rng.integers(0, len(features) - length, 8)
    queries = np.stack([features[i : i + length] for i in first])
    queries += np.float32(noise)
    k = int(rng.integers(1, 80))
    indices, distances = backend.nearest_segments(features, STARTS, queries, k, 1, None)
    for i, query in enumerate(queries):
        alone = backend.nearest_segments(features, STARTS, query[None], k, 1, None)
        np.testing.assert_array_equal(indices[i], alone[0][0])
        np.testing.assert_array_equal(distances[i], alone[1][0])


def test_no_candidates(backend):
    indices, distances = backend.nearest_segments(
        np.zeros((3, 2)), np.array([0, 3]), np.zeros((5, 4, 2)), 2, 0, None
    )
    assert (indices == -1).all()
    assert np.isinf(distances).all()


def test_nothing_is_sought(backend):
    indices, distances = backend.nearest_segments(motions(), STARTS, np.zeros((0, 2, 37)), 4, 0, None)
    assert indices.shape == distances.shape == (0, 4)


def test_a_memory_map_is_read_in_place(tmp_path):
    features = motions(dtype=np.float32)
    features.tofile(tmp_path / "features")
    mapped = np.memmap(tmp_path / "features", np.float32, "r", shape=features.shape)
    expected = qf.nearest_segments(features, STARTS, features[50:53], k=5)
    result = qf.nearest_segments(mapped, STARTS, mapped[50:53], k=5)
    np.testing.assert_array_equal(result, expected)


def test_a_graph_holds_the_nearest_but_for_those_near_in_time(backend):
    features = motions()
    indices, distances = backend.neighbor_graph(features, STARTS, 5, 2, 1, 4, 1)
    assert indices.dtype == np.int32
    assert (indices[[0, 119, 120, 121, 399, 639]] == -1).all()
    for e in (1, 60, 118, 250, 638):
        clip = np.searchsorted(STARTS, e, "right") - 1
        near = np.array([[max(STARTS[clip], e - 4), min(STARTS[clip + 1], e + 5)]])
        query = features[None, e - 1 : e + 1]
        expected = backend.nearest_segments(features, STARTS, query, 5, 1, near)
        np.testing.assert_array_equal(indices[e], expected[0][0])
        np.testing.assert_array_equal(distances[e], expected[1][0])


@pytest.mark.parametrize("spacing", [2, 8, 1000])
def test_neighbours_lie_apart_in_time(backend, spacing):
    features = motions()
    indices, distances = backend.neighbor_graph(features, STARTS, 7, 2, 1, 4, spacing)
    near = backend.neighbor_graph(features, STARTS, 639, 2, 1, 4, 1)
    clip = np.searchsorted(STARTS, np.arange(len(features)), "right")
    for e in (1, 60, 118, 250, 638):
        chosen: list[int] = []
        for other in near[0][e][near[0][e] >= 0].tolist():
            if all(abs(other - one) >= spacing or clip[one] != clip[other] for one in chosen):
                chosen.append(other)
        expected = np.array((chosen + [-1] * 7)[:7])
        np.testing.assert_array_equal(indices[e], expected)
        np.testing.assert_array_equal(np.isinf(distances[e]), expected < 0)


def along(backend, features, graph, path, refresh, ratio, k=4, breadth=4):
    """Return what a walk along a motion finds in each frame."""
    walk = backend.segment_walk(features, STARTS, graph, k, 3, 1, breadth, refresh, ratio)
    return [walk.next(path[t : t + 3], 0, 0) for t in range(len(path) - 2)]


def test_a_walk_that_trusts_nothing_is_exact(backend):
    features = motions()
    graph, _ = backend.neighbor_graph(features, STARTS, 4, 1, 1, 5, 2)
    path = features[200:240] + 0.03
    for t, (indices, distances, full) in enumerate(along(backend, features, graph, path, 0, np.inf)):
        expected = backend.nearest_segments(features, STARTS, path[None, t : t + 3], 4, 1, None)
        assert full
        np.testing.assert_array_equal(indices, expected[0][0])
        np.testing.assert_array_equal(distances, expected[1][0])


def test_a_walk_follows_a_motion_of_the_database(backend):
    features = motions()
    graph, _ = backend.neighbor_graph(features, STARTS, 4, 1, 1, 5, 2)
    found = along(backend, features, graph, features[200:260], 1000, np.inf)
    assert [full for _, _, full in found] == [True] + [False] * 57
    assert [indices[0] for indices, _, _ in found] == list(range(202, 260))


def test_a_wide_walk_finds_what_a_search_of_all_finds(backend):
    features = motions()
    graph, _ = backend.neighbor_graph(features, STARTS, 4, 1, 1, 5, 2)
    path = features[200:240] + 0.03
    for t, (indices, distances, full) in enumerate(
        along(backend, features, graph, path, 1000, np.inf, breadth=300)
    ):
        expected = backend.nearest_segments(features, STARTS, path[None, t : t + 3], 4, 1, None)
        assert full == (t == 0)
        np.testing.assert_array_equal(indices, expected[0][0])
        np.testing.assert_array_equal(distances, expected[1][0])


def test_a_wider_walk_misses_less(backend):
    features = motions()
    graph, _ = backend.neighbor_graph(features, STARTS, 2, 1, 1, 5, 8)
    path = np.random.default_rng(9).standard_normal((80, 37)).cumsum(axis=0) / 5
    truth = backend.nearest_segments(
        features, STARTS, np.stack([path[t : t + 3] for t in range(78)]), 8, 1, None
    )
    shares = []
    for breadth in (8, 24, 120):
        found = along(backend, features, graph, path, 1000, np.inf, k=8, breadth=breadth)
        shares.append(np.mean([np.isin(a, b[0]).mean() for a, b in zip(truth[0], found, strict=True)]))
    assert shares[0] < shares[1] < shares[2]
    assert shares[2] > 0.95


def test_a_walk_looks_at_all_after_some_frames_and_where_all_is_far(backend):
    features = motions()
    graph, _ = backend.neighbor_graph(features, STARTS, 4, 1, 1, 5, 2)
    path = features[200:220].copy()
    path[12:] += 5
    found = [full for _, _, full in along(backend, features, graph, path, 6, 3.0)]
    assert [t for t, full in enumerate(found) if full][:3] == [0, 7, 10]


def test_a_walk_begins_anew_after_a_pose_that_is_not_finite(backend):
    features = motions()
    graph, _ = backend.neighbor_graph(features, STARTS, 4, 1, 1, 5, 2)
    path = features[200:220].copy()
    path[8, 3] = np.nan
    found = along(backend, features, graph, path, 1000, np.inf)
    assert [full for _, _, full in found[:10]] == [True, *[False] * 8, True]
    assert (found[7][0] == -1).all()
    assert np.isinf(found[7][1]).all()


def test_what_is_excluded_is_not_found_along_a_graph(backend):
    features = motions()
    graph, _ = backend.neighbor_graph(features, STARTS, 4, 1, 1, 5, 2)
    walk = backend.segment_walk(features, STARTS, graph, 4, 3, 1, 16, 1000, np.inf)
    for t in range(200, 230):
        indices, _, _ = walk.next(features[t : t + 3], 121, 400)
        assert not ((indices >= 121) & (indices < 400)).any()


@pytest.mark.parametrize("speed", [0.001, 0.1, 20.0])
def test_a_search_without_a_graph_finds_in_each_frame_what_that_frame_alone_finds(backend, speed):
    features = motions(dtype=np.float32)
    steps = np.random.default_rng(3).standard_normal((200, features.shape[1]))
    path = (features[200] + speed * np.cumsum(steps, axis=0)).astype(np.float32)
    for t, (indices, distances, full) in enumerate(along(backend, features, None, path, 15, 1.5, k=16)):
        expected = backend.nearest_segments(features, STARTS, path[None, t : t + 3], 16, 1, None)
        assert full
        np.testing.assert_array_equal(indices, expected[0][0])
        np.testing.assert_array_equal(distances, expected[1][0])


def test_a_motion_that_stands_still_and_then_leaps_is_found(backend):
    features = motions()
    path = np.concatenate([np.repeat(features[130:131], 300, axis=0), features[500:520]])
    found = along(backend, features, None, path, 15, 1.5, k=4)
    assert [indices[0] for indices, _, _ in found[-18:]] == list(range(502, 520))


def test_what_was_excluded_is_found_when_it_is_not(backend):
    features = motions()
    walk = backend.segment_walk(features, STARTS, None, 4, 3, 1, 16, 15, 1.5)
    for t in range(200, 230):
        walk.next(features[t : t + 3], 121, 400)
    assert walk.next(features[230:233], 0, 0)[0][0] == 232
