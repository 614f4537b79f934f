"""A database is searched."""

import numpy as np
import quatfilt as qf


def database():
    t = np.arange(240) / 20
    bones = qf.Skeleton(["shoulder", "elbow"], [-1, 0], [[0.0, 0, 0], [0, -30, 0]])
    motions = [
        qf.Motion(
            qf.exp(np.sin(rate * t)[:, None, None] * [[0.5, 0, 0], [0.2, 0, 0.1]]), fps=60, skeleton=bones
        )
        for rate in (1.0, 1.3)
    ]
    return qf.MotionDatabase.from_motions(motions, fps=60)


def test_nearest_is_that_of_the_features():
    db = database()
    found = db.nearest(db.features[30:33], k=5)
    expected = qf.nearest_segments(db.features, db.starts, db.features[30:33], k=5)
    np.testing.assert_array_equal(found[0], expected[0])
    np.testing.assert_array_equal(found[1], expected[1])
    assert found[0][0] == 32


def test_a_graph_is_built_kept_and_searched(tmp_path):
    db = database()
    assert db.graph is None
    db.build_graph(degree=4, exclusion=0.1)
    expected, _ = qf.neighbor_graph(db.features, db.starts, degree=4, exclusion=6)
    np.testing.assert_array_equal(db.graph, expected)
    db.save(tmp_path / "db")
    opened = qf.MotionDatabase.open(tmp_path / "db")
    search = qf.PoseSearch(opened.features, opened.starts, opened.graph, k=3)
    for t in range(100, 110):
        indices, _ = search(opened.features[t - 2 : t + 1])
        assert indices[0] == t
