"""The Kalman filter and smoother: the core against the reference."""

import clips
import drawn
import numpy as np
import pytest
import quatfilt as qf
import tolerances
from drawn import same_samples, seeds
from hypothesis import given
from hypothesis import strategies as st
from layouts import LAYOUTS
from quatfilt import _core, _reference
from quatfilt.filters.kalman import with_translation

DTYPES = [np.float32, np.float64]


def noisy(rng, frames, joints, sigma=0.05):
    """A clip with random signs to filter."""
    return clips.flipped(rng, clips.noisy(rng, clips.smooth(rng, frames, joints, swing=2), sigma))


def agree(q, *, process_noise=0.01, measurement_noise=0.05, lookahead=-1, confidence=None):
    noises = [
        np.broadcast_to(x, q.shape[1]).astype(np.float64).copy() for x in (process_noise, measurement_noise)
    ]
    arguments = (q, confidence, *noises, lookahead)
    before = [x.tobytes() for x in arguments[:4] if x is not None]
    result, expected = (backend.kalman(*arguments) for backend in (_core, _reference))
    assert [x.tobytes() for x in arguments[:4] if x is not None] == before, "an input was written"
    assert result.dtype == expected.dtype == q.dtype
    same_samples(result, expected, tolerances.filtered(q.dtype))


@given(
    seed=seeds,
    frames=st.one_of(st.integers(0, 5), st.integers(6, 60)),
    joints=st.sampled_from([0, 1, 7, 8, 9, 17]),
    dtype=drawn.dtypes,
    process=st.sampled_from([0.0, 1e-6, 1e-3, 0.1, 3.0]),
    measurement=st.sampled_from([1e-3, 0.05, 1.0]),
    lookahead=st.sampled_from([-1, 0, 1, 5, 100]),
    trusted=st.booleans(),
)
def test_any_options(seed, frames, joints, dtype, process, measurement, lookahead, trusted):
    rng = np.random.default_rng(seed)
    q = np.ascontiguousarray(noisy(rng, frames, max(joints, 1), 0.1)[:, :joints], dtype)
    agree(
        q,
        process_noise=process * rng.uniform(0.5, 2, joints),
        measurement_noise=measurement * rng.uniform(0.5, 2, joints),
        lookahead=lookahead,
        confidence=clips.confidences(rng, frames, joints).astype(dtype) if trusted else None,
    )


@pytest.mark.parametrize("dtype", DTYPES)
@pytest.mark.parametrize("lookahead", [-1, 0, 20])
def test_long_gaps_and_joints_that_begin_late_or_never(lookahead, dtype):
    rng = np.random.default_rng(1)
    q = noisy(rng, 200, 5).astype(dtype)
    confidence = np.ones((200, 5), dtype)
    confidence[50:110, 0] = 0
    confidence[:30, 1] = 0
    confidence[150:, 2] = 0
    confidence[:, 3] = 0
    agree(q, lookahead=lookahead, confidence=confidence)


@pytest.mark.parametrize("frames", [4097, 8193])
def test_around_the_ends_of_stretches(frames):
    agree(noisy(np.random.default_rng(frames), frames, 2))


@pytest.mark.parametrize("measurement", [1e-12, 1e-6, 1e9])
@pytest.mark.parametrize("process", [0.0, 1e-9, 1e9])
def test_extreme_noises(process, measurement):
    q = noisy(np.random.default_rng(3), 120, 3)
    agree(q, process_noise=process, measurement_noise=measurement)
    agree(q, process_noise=process, measurement_noise=measurement, lookahead=0)


@given(
    seed=seeds,
    frames=st.integers(0, 40),
    joints=st.sampled_from([1, 3]),
    dtype=drawn.dtypes,
    sigma=st.sampled_from([0.001, 0.05, 0.3]),
    block=st.sampled_from([10, 25, 100]),
    lookahead=st.sampled_from([-1, 0, 5]),
    trusted=st.booleans(),
)
def test_the_automatic_process_noise(seed, frames, joints, dtype, sigma, block, lookahead, trusted):
    rng = np.random.default_rng(seed)
    q = noisy(rng, max(frames, 1), joints, sigma)[:frames].astype(dtype)
    confidence = clips.confidences(rng, frames, joints).astype(dtype) if trusted else None
    arguments = (q, confidence, np.full(joints, sigma), block, lookahead)
    result, expected = (backend.kalman_process_noise(*arguments) for backend in (_core, _reference))
    assert result.shape == (joints,)
    np.testing.assert_allclose(result, expected, rtol=tolerances.RATIO)


@given(
    seed=seeds,
    frames=st.integers(0, 60),
    columns=st.sampled_from([1, 3]),
    dtype=drawn.dtypes,
    ratio=st.sampled_from([1e-9, 1e-4, 1.0, 300.0]),
    lookahead=st.sampled_from([-1, 0, 3, 100]),
)
def test_numbers(seed, frames, columns, dtype, ratio, lookahead):
    rng = np.random.default_rng(seed)
    x = np.cumsum(rng.standard_normal((frames, columns)), axis=0).astype(dtype)
    arguments = (x, ratio * rng.uniform(0.5, 2, columns), lookahead)
    result, expected = (backend.kalman_vectors(*arguments) for backend in (_core, _reference))
    assert result.dtype == expected.dtype == dtype
    np.testing.assert_allclose(result, expected, rtol=0, atol=10 * tolerances.filtered(dtype))


@given(
    seed=seeds, frames=st.integers(0, 60), block=st.sampled_from([10, 25, 100]), lookahead=st.integers(-1, 1)
)
def test_the_ratio_of_numbers(seed, frames, block, lookahead):
    rng = np.random.default_rng(seed)
    x = np.sin(np.arange(frames)[:, None] / 9 + np.arange(3)) + 0.1 * rng.standard_normal((frames, 3))
    result, expected = (backend.kalman_vectors_ratio(x, block, lookahead) for backend in (_core, _reference))
    np.testing.assert_allclose(result, expected, rtol=tolerances.RATIO)


@pytest.mark.parametrize("dtype", DTYPES)
@pytest.mark.parametrize("layout", LAYOUTS)
def test_layouts(layout, dtype):
    plain = noisy(np.random.default_rng(4), 80, 3).astype(dtype)
    result = qf.kalman(LAYOUTS[layout](plain))
    assert result.dtype == dtype
    np.testing.assert_array_equal(result, qf.kalman(plain))


@given(
    q=drawn.spoilt_clips(lengths=st.integers(0, 40), joints=st.sampled_from([1, 3])),
    gaps=st.sampled_from(["fill", "keep"]),
    max_gap=st.sampled_from([None, 0, 1, 3, 1000]),
    lookahead=st.sampled_from([None, 0, 4]),
)
def test_missing_samples(q, gaps, max_gap, lookahead):
    options = {"gaps": gaps, "max_gap": max_gap, "lookahead": lookahead, "process_noise": 0.01}
    result = qf.kalman(q, measurement_noise=0.03, **options)
    with qf.use_backend("numpy"):
        expected = qf.kalman(q, measurement_noise=0.03, **options)
    same_samples(result, expected, tolerances.filtered(result.dtype))


@pytest.mark.parametrize(("frames", "smooth"), [(300, True), (300, False), (5000, True)])
def test_automatic_noises(frames, smooth):
    """Of a clip with gaps, the longer of them in blocks; and of its translation."""
    rng = np.random.default_rng(5)
    q = clips.noisy(rng, clips.smooth(rng, frames, 2), 0.02)
    q[40:45, 0] = np.nan
    q[200:280, 1] = np.nan
    path = clips.path(rng, frames)
    options = {**qf.kalman.__kwdefaults__, "smooth": smooth, "max_gap": 30.0}
    result, moved = with_translation(q, path, **options)
    with qf.use_backend("numpy"):
        expected, along = with_translation(q, path, **options)
    # The ratio of the noises agrees within `RATIO`.
    same_samples(result, expected, tolerances.RATIO)
    np.testing.assert_allclose(moved, along, rtol=0, atol=tolerances.RATIO)
