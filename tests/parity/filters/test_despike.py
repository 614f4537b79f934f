"""The search for spikes: the core against the reference."""

import clips
import drawn
import numpy as np
import pytest
import quatfilt as qf
import tolerances
from drawn import same_samples, seeds
from hypothesis import given, settings
from hypothesis import strategies as st
from layouts import LAYOUTS
from quatfilt import _core, _reference

DTYPES = [np.float32, np.float64]


def spoilt(rng, frames, joints, share=0.05):
    """Return a clip with random signs, a little noise, spikes of up to half a turn, and jumps."""
    q = clips.noisy(rng, clips.smooth(rng, frames, joints), 0.003)
    hit = rng.random(q.shape[:2]) < share
    q[hit] = clips.product(q[hit], clips.from_vectors(rng.standard_normal((hit.sum(), 3))))
    jumps = rng.random(frames) < share / 5
    turns = clips.from_vectors(
        np.cumsum(jumps[:, None, None] * rng.uniform(-1, 1, (frames, joints, 3)), axis=0)
    )
    return clips.flipped(rng, clips.product(q, turns))


def agree(x, *, confidence=None, smallest=0.1, radius=3, threshold=4.0, longest=0):
    noise = np.asarray(_reference.noise_level(x), np.float64)
    limits = np.full(x.shape[1], float(smallest))
    before = x.tobytes()
    result, expected = (
        backend.find_spikes(x, confidence, noise, limits, radius, threshold, longest)
        for backend in (_core, _reference)
    )
    assert x.tobytes() == before, "the input was written"
    assert result.dtype == np.bool_
    np.testing.assert_array_equal(result, expected)
    return result


@given(
    seed=seeds,
    frames=st.one_of(st.integers(0, 8), st.integers(9, 60)),
    joints=st.sampled_from([0, 1, 2]),
    dtype=drawn.dtypes,
    radius=st.sampled_from([2, 3, 4, 9]),
    threshold=st.sampled_from([0.5, 4.0, 10.0]),
    smallest=st.sampled_from([0.0, 0.1]),
    trusted=st.booleans(),
)
def test_any_options(seed, frames, joints, dtype, radius, threshold, smallest, trusted):
    rng = np.random.default_rng(seed)
    q = np.ascontiguousarray(spoilt(rng, frames, max(joints, 1))[:, :joints], dtype)
    confidence = clips.confidences(rng, frames, joints).astype(dtype) if trusted else None
    agree(q, confidence=confidence, radius=radius, threshold=threshold, smallest=smallest)


@pytest.mark.parametrize("dtype", DTYPES)
def test_long_clips(dtype):
    rng = np.random.default_rng(1)
    assert agree(spoilt(rng, 2_000, 2, share=0.02).astype(dtype)).sum() > 50


@settings(max_examples=8)
@given(
    seed=seeds,
    dtype=drawn.dtypes,
    radius=st.sampled_from([2, 3]),
    longest=st.sampled_from([3, 11, 45]),
    trusted=st.booleans(),
)
def test_bursts_and_swaps(seed, dtype, radius, longest, trusted):
    rng = np.random.default_rng(seed)
    q = clips.noisy(rng, clips.smooth(rng, 90, 3), 0.003)
    for joint in range(3):
        for start in rng.integers(1, 80, 2):
            run = slice(start, start + rng.integers(1, 14))
            q[run, joint] = clips.product(q[run, joint], clips.from_vectors(0.6 * rng.standard_normal(3)))
    for start in rng.integers(1, 78, 2):
        run = slice(start, start + rng.integers(1, 12))
        q[run, :2] = q[run, 1::-1]
    q[50:70] = np.repeat(q[50:70:4], 4, axis=0)
    q = np.ascontiguousarray(clips.flipped(rng, q), dtype)
    confidence = clips.confidences(rng, 90, 3).astype(dtype) if trusted else None
    agree(q, confidence=confidence, radius=radius, longest=longest)
    options = (np.full(3, 0.003), np.full(3, 0.1), 4.0, longest)
    result, expected = (backend.find_swaps(q, confidence, *options) for backend in (_core, _reference))
    np.testing.assert_array_equal(result, expected)


@pytest.mark.parametrize("dtype", DTYPES)
def test_positions(dtype):
    rng = np.random.default_rng(2)
    path = np.cumsum(rng.standard_normal((400, 2, 3)), axis=0) / 10
    path += 5 * rng.standard_normal(path.shape) * (rng.random((400, 2, 1)) < 0.03)
    path[100:140] = path[100]
    assert agree(path.astype(dtype), smallest=0.0).sum() > 10


@pytest.mark.parametrize("dtype", DTYPES)
@pytest.mark.parametrize("frames", [0, 1, 5, 9, 400, 5000])
def test_noise_of_positions(frames, dtype):
    rng = np.random.default_rng(3)
    path = (np.cumsum(clips.path(rng, frames), axis=0)[:, None] + rng.normal(0, 0.1, (frames, 2, 3))).astype(
        dtype
    )
    result, expected = (backend.noise_level(path) for backend in (_core, _reference))
    assert result.dtype == dtype
    np.testing.assert_allclose(result, expected, rtol=0, atol=tolerances.filtered(dtype))
    if frames >= 400:
        assert result == pytest.approx(0.1, rel=0.2)


@pytest.mark.parametrize("dtype", DTYPES)
@pytest.mark.parametrize("layout", LAYOUTS)
def test_layouts(layout, dtype):
    plain = spoilt(np.random.default_rng(4), 80, 3).astype(dtype)
    result = qf.despike(LAYOUTS[layout](plain))
    assert result.dtype == dtype
    np.testing.assert_array_equal(result, qf.despike(plain))


@given(
    q=drawn.spoilt_clips(lengths=st.integers(0, 60), joints=st.sampled_from([1, 3])),
    gaps=st.sampled_from(["fill", "keep"]),
    max_gap=st.sampled_from([None, 0, 1, 3, 1000]),
    smallest=st.sampled_from([0.0, 0.105]),
)
def test_missing_samples(q, gaps, max_gap, smallest):
    result = qf.despike(q, gaps=gaps, max_gap=max_gap, smallest=smallest)
    with qf.use_backend("numpy"):
        expected = qf.despike(q, gaps=gaps, max_gap=max_gap, smallest=smallest)
    same_samples(result, expected, tolerances.filtered(result.dtype))
