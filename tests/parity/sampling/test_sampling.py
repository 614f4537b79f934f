"""The clock of the source: the core against the reference."""

import clips
import numpy as np
import pytest
import tolerances
from drawn import spoil, spoilt_clips
from hypothesis import given
from hypothesis import strategies as st
from quatfilt import _core, _reference
from sources import held, interpolated, video

DTYPES = pytest.mark.parametrize("dtype", [np.float32, np.float64])


def agree(result, expected, atol):
    assert result.dtype == expected.dtype
    np.testing.assert_allclose(result, expected, rtol=0, atol=atol)


@DTYPES
@pytest.mark.parametrize("make", [held, interpolated, video])
def test_sampling(make, dtype):
    rng = np.random.default_rng(0)
    q = make(rng, clips.noisy(rng, clips.walk(rng, 500, 6), 0.01)).astype(dtype)
    q[100:140] = q[100]
    found, expected = _core.sampling(q, 120.0), _reference.sampling(q, 120.0)
    assert found[0] == expected[0]
    # A knot lies where the bends of all joints balance: roundings of float32 move it.
    agree(found[1], expected[1], 1e-9)
    np.testing.assert_array_equal(found[2], expected[2])
    assert found[2].sum() >= 40


@given(q=spoilt_clips(missing=st.sampled_from([0.0, 0.2, 1.0])), fps=st.sampled_from([1.0, 30.0, 120.0]))
def test_sampling_of_any_clip(q, fps):
    before = q.tobytes()
    for found, expected in zip(_core.sampling(q, fps), _reference.sampling(q, fps), strict=True):
        np.testing.assert_array_equal(found, expected)
    assert q.tobytes() == before, "the input was written"


@DTYPES
@pytest.mark.parametrize("missing", [0.0, 0.1])
def test_knots_and_splines(missing, dtype):
    rng = np.random.default_rng(1)
    q = spoil(rng, clips.walk(rng, 80, 4), missing).astype(dtype)
    times = np.unique(np.concatenate([[0.0, 79.0], rng.uniform(0, 79, 40), rng.integers(0, 79, 10)]))
    knots = _core.knots(q, times)
    agree(knots, _reference.knots(q, times), tolerances.filtered(q.dtype))
    new = np.sort(np.concatenate([np.arange(80.0), times[3:9], [-2.0, 81.5]]))
    for cutoff in (0.0, 0.05, 0.3):
        agree(
            _core.spline(knots, times, new, cutoff),
            _reference.spline(knots, times, new, cutoff),
            tolerances.filtered(q.dtype),
        )


@DTYPES
@pytest.mark.parametrize("count", [1, 2, 3, 5])
def test_splines_of_few_samples_and_of_positions(count, dtype):
    rng = np.random.default_rng(2)
    times = np.cumsum(rng.uniform(0.5, 2, count))
    new = np.linspace(times[0] - 1, times[-1] + 1, 9)
    for values in (clips.walk(rng, count, 2), rng.normal(size=(count, 2, 3))):
        q = values.astype(dtype)
        agree(
            _core.spline(q, times, new, 0.2),
            _reference.spline(q, times, new, 0.2),
            tolerances.filtered(q.dtype),
        )
        agree(
            _core.knots(q, np.arange(count) * 0.9),
            _reference.knots(q, np.arange(count) * 0.9),
            tolerances.filtered(q.dtype),
        )


@DTYPES
@pytest.mark.parametrize("fps", [25.0, 30.0, 59.94, 120.0])
@pytest.mark.parametrize("missing", [0.0, 0.001])
def test_tracker_noise(fps, missing, dtype):
    rng = np.random.default_rng(3)
    q = spoil(rng, video(rng, clips.walk(rng, round(6 * fps), 5)), missing).astype(dtype)
    found = _core.tracker_noise(q, fps)
    # Medians are single values of the clip: roundings do not choose among them.
    np.testing.assert_allclose(found, _reference.tracker_noise(q, fps), rtol=1e-9)
    assert found[2] > 0


@DTYPES
def test_short_clips_say_nothing_about_jitter(dtype):
    q = clips.walk(np.random.default_rng(4), 20, 3).astype(dtype)
    np.testing.assert_array_equal(_core.tracker_noise(q, 30.0), np.zeros(6))
    np.testing.assert_array_equal(_reference.tracker_noise(q, 30.0), np.zeros(6))


@DTYPES
@pytest.mark.parametrize("frames", [0, 1, 2, 3, 4, 90])
@pytest.mark.parametrize("weighed", [False, True])
def test_low_pass(frames, weighed, dtype):
    rng = np.random.default_rng(5)
    q = clips.noisy(rng, clips.walk(rng, frames, 3), 0.05).astype(dtype)
    trust = rng.integers(0, 3, (frames, 3)).astype(dtype) / 2 if weighed else None
    path = rng.normal(size=(frames, 3)).astype(dtype)
    arguments = (q, path, trust, np.full(3, 2.0), 0.7)
    for found, expected in zip(_core.low_pass(*arguments), _reference.low_pass(*arguments), strict=True):
        agree(found, expected, 10 * tolerances.filtered(q.dtype))
