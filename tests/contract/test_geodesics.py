"""What compression and segmentation refuse, word for word, and whose options are checked."""

import clips
import numpy as np
import pytest
import quatfilt as qf

Q = clips.smooth(np.random.default_rng(0), 30, 2)


def refused(kind, call, *arguments, **options):
    with pytest.raises(kind) as error:
        call(*arguments, **options)
    return str(error.value)


@pytest.mark.parametrize(
    ("options", "kind", "message"),
    [
        ({"tolerance": 0}, ValueError, "tolerance: expected a number above 0, got 0"),
        ({"tolerance": -0.1}, ValueError, "tolerance: expected a number above 0, got -0.1"),
        ({"tolerance": np.nan}, ValueError, "tolerance: expected a number above 0, got nan"),
        ({"tolerance": "0.1"}, TypeError, "tolerance: expected a number above 0, got str"),
        (
            {"tolerance": [0.1, 0.1, 0.1]},
            ValueError,
            "tolerance: expected a number or one per joint, shape (2,), got (3,)",
        ),
        ({"tolerance": [0.1, 0]}, ValueError, "tolerance[1]: expected a number above 0, got 0.0"),
        ({"tolerance": 0.1, "quantised": 1}, TypeError, "quantised: expected True or False, got int"),
    ],
)
def test_wrong_options_of_compress(options, kind, message):
    assert refused(kind, qf.compress, Q, **options) == message


@pytest.mark.parametrize(
    ("options", "kind", "message"),
    [
        (
            {"n_components": 0},
            ValueError,
            "n_components: expected an integer of at least 1 and at most 2, got 0",
        ),
        (
            {"n_components": 1.5},
            TypeError,
            "n_components: expected an integer of at least 1 and at most 2, got float",
        ),
        ({"window": 1}, ValueError, "window: expected at least 2 seconds, 2 frames at fps = 1, got 1"),
        (
            {"window": 0.1, "fps": 10},
            ValueError,
            "window: expected at least 0.2 seconds, 2 frames at fps = 10, got 0.1",
        ),
        (
            {"min_length": 0.01, "fps": 10},
            ValueError,
            "min_length: expected at least 0.1 seconds, 1 frame at fps = 10, got 0.01",
        ),
        ({"threshold": "none"}, ValueError, "threshold: expected one of 'auto', got 'none'"),
        ({"threshold": -1}, ValueError, "threshold: expected a number of at least 0, got -1"),
        ({"fps": 0}, ValueError, "fps: expected a number above 0, got 0"),
    ],
)
def test_wrong_options_of_segment(options, kind, message):
    assert refused(kind, qf.segment, Q, **options) == message


@pytest.mark.parametrize("call", [lambda q: qf.compress(q, tolerance=0.1), qf.segment])
def test_wrong_clips(call):
    assert refused(ValueError, call, np.ones((3, 2, 2, 4))) == (
        "q: expected shape (frames, joints, 4) or (frames, 4), got (3, 2, 2, 4)"
    )
    assert refused(ValueError, call, 2 * Q).startswith("q: expected unit quaternions, got norm 2 at frame ")


def test_inputs_are_not_written_and_need_no_layout():
    expected = qf.compress(Q, tolerance=0.01)
    for layout in (np.asfortranarray(Q), Q[::-1].copy()[::-1], Q.astype(">f8")):
        layout.flags.writeable = False
        assert qf.compress(layout, tolerance=0.01) == expected


def test_one_series_is_one_joint():
    small = qf.compress(Q[:, 0], tolerance=0.01)
    assert small.joints == 1
    assert small.decompress().shape == (30, 4)
    np.testing.assert_array_equal(
        small.decompress(), qf.compress(Q[:, :1], tolerance=0.01).decompress()[:, 0]
    )
    np.testing.assert_array_equal(qf.segment(Q[:, 0], window=5), qf.segment(Q[:, :1], window=5))
