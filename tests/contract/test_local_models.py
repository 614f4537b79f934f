"""Which arguments `predict_pose` refuses, and in which words; what it returns."""

import math

import clips
import numpy as np
import pytest
import quatfilt as qf
from local_models import examples

SEGMENTS, STEPS, RECENT = examples(np.random.default_rng(0), 6, 2, 3)


def call(**options):
    return qf.predict_pose(**{"segments": SEGMENTS, "recent": RECENT, **options})


def lengthened(q):
    q = q.copy()
    q[0, 1, 2] *= 2
    return q


def spoilt(q):
    q = q.copy()
    q[1, 0] = np.nan
    return q


REFUSED = [
    (
        {"segments": RECENT},
        ValueError,
        "segments: expected shape (K, m + 1, joints, 4) with at least one example of two poses, got (2, 3, 4)",
    ),
    (
        {"segments": SEGMENTS[:0]},
        ValueError,
        "segments: expected shape (K, m + 1, joints, 4) with at least one example of two poses, got (0, 3, 3, 4)",
    ),
    (
        {"segments": SEGMENTS[:, :1]},
        ValueError,
        "segments: expected shape (K, m + 1, joints, 4) with at least one example of two poses, got (6, 1, 3, 4)",
    ),
    ({"segments": SEGMENTS[..., :3]}, ValueError, "segments: expected shape (..., 4), got (6, 3, 3, 3)"),
    ({"segments": spoilt(SEGMENTS)}, ValueError, "segments: expected no missing samples, got 3"),
    (
        {"segments": lengthened(SEGMENTS)},
        ValueError,
        "segments: expected unit quaternions, got norm 2 at frame 1, joint 2",
    ),
    (
        {"recent": RECENT[1:]},
        ValueError,
        "recent: expected shape (2, 3, 4), that of the first poses of segments, got (1, 3, 4)",
    ),
    (
        {"recent": RECENT[:, 1:]},
        ValueError,
        "recent: expected shape (2, 3, 4), that of the first poses of segments, got (2, 2, 4)",
    ),
    ({"recent": spoilt(RECENT)}, ValueError, "recent: expected no missing samples, got 1"),
    ({"root_steps": STEPS[1:]}, ValueError, "root_steps: expected shape (6, n), got (5, 4)"),
    ({"root_steps": STEPS[0]}, ValueError, "root_steps: expected shape (6, n), got (4,)"),
    ({"root_steps": math.inf * np.ones((6, 1))}, ValueError, "root_steps: expected finite numbers, got inf"),
    ({"joint_weights": [1, 1]}, ValueError, "joint_weights: expected shape (3,), got (2,)"),
    (
        {"joint_weights": [1, -1, 1]},
        ValueError,
        "joint_weights: expected finite numbers of at least 0, got -1.0",
    ),
    (
        {"model": "gpdm"},
        ValueError,
        "model: expected one of 'local_regression', 'local_pcr', 'local_pca', 'nearest', 'mean_pose', got 'gpdm'",
    ),
    (
        {"direction": "main"},
        ValueError,
        "direction: expected one of 'least_squares', 'partial_least_squares', got 'main'",
    ),
    ({"target": "speed"}, ValueError, "target: expected one of 'pose', 'change', got 'speed'"),
    (
        {"deviation": "both"},
        ValueError,
        "deviation: expected one of 'predictive', 'leave_one_out', got 'both'",
    ),
    ({"bandwidth": 0}, ValueError, "bandwidth: expected a number of at least 1e-06, got 0"),
    ({"bandwidth": "wide"}, ValueError, "bandwidth: expected 'auto' or a number, got 'wide'"),
    ({"ridge": 0}, ValueError, "ridge: expected a number of at least 1e-09 and at most 1e+06, got 0"),
    (
        {"ridge": None},
        TypeError,
        "ridge: expected a number of at least 1e-09 and at most 1e+06, got NoneType",
    ),
    ({"variance": 1.5}, ValueError, "variance: expected a number above 0 and at most 1, got 1.5"),
]


@pytest.mark.parametrize(("options", "error", "message"), REFUSED)
def test_refused(options, error, message):
    with pytest.raises(error) as caught:
        call(**options)
    assert str(caught.value) == message


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_what_comes_back(dtype):
    result = call(segments=SEGMENTS.astype(dtype), recent=RECENT.astype(dtype), root_steps=STEPS)
    assert result.pose.dtype == dtype
    assert result.pose.shape == result.chart.shape == (3, 4)
    assert result.root_step.shape == (4,)
    assert result.mean.shape == result.deviation.shape == (13,)
    assert result.axes.shape == (13, 0)
    turned = clips.from_vectors(result.mean[:9].reshape(3, 3))
    assert clips.angles(clips.product(result.chart, turned), result.pose).max() < 1e-6
    np.testing.assert_array_equal(result.root_step, result.mean[9:])


def test_the_order_of_components():
    last = [np.roll(q, -1, axis=-1) for q in (SEGMENTS, RECENT)]
    result = call(segments=last[0], recent=last[1], scalar_first=False)
    np.testing.assert_array_equal(np.roll(result.pose, 1, axis=-1), call().pose)
    np.testing.assert_array_equal(np.roll(result.chart, 1, axis=-1), call().chart)


def test_directions_and_models_differ():
    means = [
        call(**options).mean
        for options in (
            {},
            {"direction": "partial_least_squares"},
            {"model": "local_pcr"},
            {"model": "local_pca"},
            {"model": "nearest"},
            {"target": "change"},
            {"bandwidth": 0.1},
            {"ridge": 1.0},
        )
    ]
    for i, a in enumerate(means):
        assert all(np.abs(a - b).max() > 1e-6 for b in means[:i])
