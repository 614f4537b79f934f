"""Pose search: what is refused, in which words; single queries; orders in memory."""

import numpy as np
import pytest
import quatfilt as qf

FEATURES = np.random.default_rng(0).standard_normal((60, 6)).astype(np.float32)

STARTS = [0, 20, 60]

QUERY = FEATURES[10:12]

NEAREST = [
    (
        {"features": FEATURES[0]},
        ValueError,
        "features: expected shape (poses, dims), got (6,)",
    ),
    (
        {"features": FEATURES[:, :0]},
        ValueError,
        "features: expected shape (poses, dims), got (60, 0)",
    ),
    (
        {"starts": [0, 20]},
        ValueError,
        "starts: expected indices that increase from 0 to 60, the number of poses, got 0 to 20",
    ),
    ({"starts": []}, ValueError, "starts: expected shape (clips + 1,), got (0,)"),
    (
        {"starts": [0, 30, 20, 60]},
        ValueError,
        "starts: expected indices that increase from 0 to 60, the number of poses, got 20 after 30",
    ),
    ({"starts": 60}, ValueError, "starts: expected shape (clips + 1,), got ()"),
    ({"starts": [0.0, 60.0]}, TypeError, "starts: expected integers, got dtype float64"),
    (
        {"queries": QUERY[:, :5]},
        ValueError,
        "queries: expected shape (queries, m, 6) or (m, 6), got (2, 5)",
    ),
    ({"queries": QUERY[0]}, ValueError, "queries: expected shape (queries, m, 6) or (m, 6), got (6,)"),
    ({"queries": QUERY[:0]}, ValueError, "queries: expected shape (queries, m, 6) or (m, 6), got (0, 6)"),
    ({"k": 0}, ValueError, "k: expected an integer of at least 1 and at most 100000, got 0"),
    ({"k": 2.0}, TypeError, "k: expected an integer of at least 1 and at most 100000, got float"),
    (
        {"successors": -1},
        ValueError,
        "successors: expected an integer of at least 0 and at most 100000, got -1",
    ),
    ({"exclude": [1, 2, 3]}, ValueError, "exclude: expected shape (2,) or (1, 2), got (3,)"),
    ({"exclude": [0.5, 2]}, TypeError, "exclude: expected integers, got dtype float64"),
]


@pytest.mark.parametrize(("wrong", "error", "message"), NEAREST)
def test_nearest_segments_refuses(wrong, error, message):
    arguments = {"features": FEATURES, "starts": STARTS, "queries": QUERY} | wrong
    with pytest.raises(error) as caught:
        qf.nearest_segments(
            arguments.pop("features"), arguments.pop("starts"), arguments.pop("queries"), **arguments
        )
    assert str(caught.value) == message


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"degree": 0}, "degree: expected an integer of at least 1 and at most 1000, got 0"),
        ({"length": 0}, "length: expected an integer of at least 1 and at most 100000, got 0"),
        ({"exclusion": -1}, "exclusion: expected an integer of at least 0 and at most 100000, got -1"),
        ({"spacing": 0}, "spacing: expected an integer of at least 1 and at most 1000, got 0"),
    ],
)
def test_neighbor_graph_refuses(wrong, message):
    with pytest.raises(ValueError) as caught:
        qf.neighbor_graph(FEATURES, STARTS, **wrong)
    assert str(caught.value) == message


GRAPH = np.tile(np.arange(60, dtype=np.int32)[:, None], (1, 2))


@pytest.mark.parametrize(
    ("wrong", "error", "message"),
    [
        ({"graph": GRAPH[:59]}, ValueError, "graph: expected shape (60, degree), got (59, 2)"),
        ({"graph": GRAPH + 1}, ValueError, "graph: expected indices from −1 to 59, got 1 to 60"),
        ({"graph": GRAPH + 0.5}, TypeError, "graph: expected integers, got dtype float64"),
        ({"breadth": 0}, ValueError, "breadth: expected an integer of at least 1 and at most 100000, got 0"),
        (
            {"refresh": -1},
            ValueError,
            "refresh: expected an integer of at least 0 and at most 100000, got -1",
        ),
        ({"ratio": 0.5}, ValueError, "ratio: expected a number of at least 1, got 0.5"),
    ],
)
def test_pose_search_refuses(wrong, error, message):
    arguments = {"graph": GRAPH} | wrong
    with pytest.raises(error) as caught:
        qf.PoseSearch(FEATURES, STARTS, arguments.pop("graph"), **arguments)
    assert str(caught.value) == message


def test_a_query_of_another_shape_is_refused():
    search = qf.PoseSearch(FEATURES, STARTS, GRAPH, k=2, length=2)
    with pytest.raises(ValueError) as caught:
        search(FEATURES[:3])
    assert str(caught.value) == "query: expected shape (2, 6), got (3, 6)"


def test_a_single_query_is_a_batch_of_one():
    single = qf.nearest_segments(FEATURES, STARTS, QUERY, k=4)
    batch = qf.nearest_segments(FEATURES, STARTS, QUERY[None], k=4)
    assert single[0].shape == (4,)
    for one, many in zip(single, batch, strict=True):
        np.testing.assert_array_equal(one, many[0])


@pytest.mark.parametrize("dtype", [np.float16, np.int16])
def test_other_numbers_become_floats(dtype):
    features = (100 * FEATURES).astype(dtype)
    indices, distances = qf.nearest_segments(features, STARTS, features[10:12], k=1)
    assert indices[0] == 11
    assert distances.dtype == (np.float32 if dtype is np.float16 else np.float64)


def test_any_order_in_memory_gives_the_same():
    expected = qf.nearest_segments(FEATURES, STARTS, QUERY, k=4)
    result = qf.nearest_segments(np.asfortranarray(FEATURES), STARTS, QUERY[:, ::-1][:, ::-1], k=4)
    np.testing.assert_array_equal(result, expected)


def test_more_neighbours_than_candidates_and_an_empty_database():
    indices, distances = qf.nearest_segments(FEATURES, STARTS, QUERY, k=100)
    assert (indices >= 0).sum() == np.isfinite(distances).sum() == 60 - 2 * 2
    search = qf.PoseSearch(FEATURES, STARTS, GRAPH, k=100, length=2)
    np.testing.assert_array_equal(search(QUERY)[0], indices)
    empty = np.zeros((0, 6), np.float32)
    indices, _ = qf.nearest_segments(empty, [0], QUERY, k=3)
    assert (indices == -1).all()
    assert qf.neighbor_graph(empty, [0])[0].shape == (0, 16)
