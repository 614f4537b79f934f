"""Patch search: shapes, orders, options, messages word for word."""

import clips
import numpy as np
import pytest
import quatfilt as qf


def clip(frames=40, joints=3, seed=0):
    return clips.smooth(np.random.default_rng(seed), frames, joints)


def doubled():
    q = clip()
    q[7, 1] *= 2
    return q


def equal(found, expected):
    for a, b in zip(found, expected, strict=True):
        np.testing.assert_array_equal(a, b)


def test_a_single_series_is_one_joint():
    q = clip(joints=1)
    equal(qf.patch_neighbors(q[:, 0]), qf.patch_neighbors(q))
    equal(qf.patch_neighbors(q[:, 0], library=q[:, 0]), qf.patch_neighbors(q, library=q))


def test_scalar_last():
    q, other = clip(), clip(seed=1)
    last = [np.roll(x, -1, axis=-1) for x in (q, other)]
    equal(
        qf.patch_neighbors(last[0], library=last[1], scalar_first=False), qf.patch_neighbors(q, library=other)
    )


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_shapes_and_types(dtype):
    q = clip().astype(dtype)
    before = q.tobytes()
    indices, distances = qf.patch_neighbors(q, k=7, library=[clip(9), clip(seed=4).astype(np.float32)])
    assert indices.shape == distances.shape == (40, 7)
    assert indices.dtype == np.int64
    assert distances.dtype == dtype
    assert q.tobytes() == before
    assert indices.max() < 49


def test_defaults():
    q = clip(60)
    equal(qf.patch_neighbors(q), qf.patch_neighbors(q, patch_radius=5, k=16, exclusion=5))
    equal(qf.patch_neighbors(q, patch_radius=3), qf.patch_neighbors(q, patch_radius=3, exclusion=3))
    equal(qf.patch_neighbors(q), qf.patch_neighbors(q, joint_weights=[2, 2, 2]))
    equal(qf.patch_neighbors(q, library=q), qf.patch_neighbors(q, library=[q]))


def test_where_there_are_fewer_it_says_so():
    for q in (np.ones((0, 3, 4)) / 2, clip(1), clip(5)):
        indices, distances = qf.patch_neighbors(q, k=3)
        assert (indices == -1).all()
        assert np.isinf(distances).all()
        assert indices.shape == (len(q), 3)
    indices, distances = qf.patch_neighbors(clip(8), k=3, patch_radius=1, exclusion=4)
    np.testing.assert_array_equal((indices >= 0).sum(axis=1), [3, 2, 1, 0, 0, 1, 2, 3])
    np.testing.assert_array_equal(np.isinf(distances), indices < 0)
    nothing = qf.patch_neighbors(clip(4), library=[np.ones((0, 3, 4))])
    assert (nothing[0] == -1).all()
    assert (qf.patch_neighbors(np.ones((9, 0, 4)))[0] == -1).all()


@pytest.mark.parametrize(
    ("options", "error", "message"),
    [
        ({"patch_radius": -1}, ValueError, "patch_radius: expected an integer of at least 0 and at most 100000, got -1"),
        ({"patch_radius": 1.0}, TypeError, "patch_radius: expected an integer of at least 0 and at most 100000, got float"),
        ({"k": 0}, ValueError, "k: expected an integer of at least 1 and at most 100000, got 0"),
        ({"exclusion": -2}, ValueError, "exclusion: expected an integer of at least 0 and at most 1e+09, got -2"),
        (
            {"exclusion": 4, "library": [clip()]},
            ValueError,
            "exclusion: expected None with a library, whose frames are not near in time, got 4",
        ),
        ({"library": []}, ValueError, "library: expected a clip or a list of clips, got an empty list"),
        ({"library": [clip(), clip(joints=2)]}, ValueError, "library[1]: expected 3 joints as in the clip, got 2"),
        ({"library": clip(joints=2)}, ValueError, "library: expected 3 joints as in the clip, got 2"),
        (
            {"library": [clip(), doubled()]},
            ValueError,
            "library[1]: expected unit quaternions, got norm 2 at frame 7, joint 1",
        ),
        ({"library": [[1.0, 0, 0, 0]]}, ValueError, "library[0]: expected shape (frames, joints, 4) or (frames, 4), got (4,)"),
        (
            {"joint_weights": [1, 2]},
            ValueError,
            "joint_weights: expected a number or one per joint, shape (3,), got (2,)",
        ),
        ({"joint_weights": [1, -1, 1]}, ValueError, "joint_weights[1]: expected a number of at least 0, got -1.0"),
        ({"joint_weights": [0, 0, 0]}, ValueError, "joint_weights: expected a weight above 0, got none"),
    ],
)  # fmt: skip
def test_what_does_not_fit_is_named(options, error, message):
    with pytest.raises(error) as caught:
        qf.patch_neighbors(clip(), **options)
    assert str(caught.value) == message


def test_what_is_no_clip_of_rotations_is_refused():
    with pytest.raises(ValueError) as caught:
        qf.patch_neighbors(np.ones((5, 3)))
    assert str(caught.value) == "q: expected shape (..., 4), got (5, 3)"
