"""The noise level: the core against the reference."""

import clips
import noise
import numpy as np
import pytest
import tolerances
from drawn import spoil, spoilt_clips
from hypothesis import given
from hypothesis import strategies as st
from quatfilt import _core, _reference


def agree(q):
    result, expected = _core.noise_level(q), _reference.noise_level(q)
    assert result.dtype == expected.dtype
    np.testing.assert_allclose(result, expected, rtol=0, atol=tolerances.filtered(q.dtype))


@given(q=spoilt_clips(missing=st.sampled_from([0.0, 0.02, 0.2, 0.5, 1.0])))
def test_noise_level(q):
    before = q.tobytes()
    agree(q)
    assert q.tobytes() == before, "the input was written"


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("frames", [8_192, 8_200, 40_001])
@pytest.mark.parametrize("share", [0.0, 0.03])
def test_long_clips(frames, share, dtype):
    rng = np.random.default_rng(0)
    q = clips.noisy(rng, clips.smooth(rng, frames, 5), 0.01)
    # The median of a joint that rests half of the time lies beside a gap in the values.
    q[: frames // 2, 1] = q[0, 1]
    q[:, 2] = q[0, 2]
    agree(spoil(rng, clips.flipped(rng, q), share).astype(dtype))


@pytest.mark.parametrize("period", [2, 3, 4, 5, 20])
def test_periodic_clips(period):
    rng = np.random.default_rng(1)
    q = clips.noisy(rng, clips.random_rotations(rng, 1, 2).repeat(period, axis=0), 0.3)
    agree(np.tile(q, (20_000 // period, 1, 1)))


@given(
    seed=st.integers(0, 2**32 - 1),
    frames=st.one_of(st.integers(0, 20), st.sampled_from([100, 1000])),
    sigma=st.sampled_from([0.2, 0.25, 0.3, 0.8, 1.5, 5.0]),
    missing=st.sampled_from([0.0, 0.1, 0.5]),
    dtype=st.sampled_from([np.float32, np.float64]),
)
def test_heavy_noise(seed, frames, sigma, missing, dtype):
    rng = np.random.default_rng(seed)
    q = spoil(rng, clips.noisy(rng, clips.smooth(rng, frames, 3), sigma), missing).astype(dtype)
    result, expected = (backend.noise_level(q) for backend in (_core, _reference))
    # Near the most noise a rounding of the coherence is one of the noise, squared.
    np.testing.assert_allclose(result, expected, rtol=0, atol=tolerances.filtered(dtype) ** 0.5)


@given(
    seed=st.integers(0, 2**32 - 1),
    frames=st.one_of(st.integers(0, 20), st.sampled_from([100, 8_200, 20_001])),
    dtype=st.sampled_from([np.float32, np.float64]),
    missing=st.sampled_from([0.0, 0.05, 0.5, 1.0]),
    size=st.sampled_from([1e-3, 1.0, 300.0]),
)
def test_noise_level_of_paths(seed, frames, dtype, missing, size):
    rng = np.random.default_rng(seed)
    path = size * (5 + clips.path(rng, frames) + rng.normal(0, 0.01, (frames, 3)))
    path[rng.random(frames) < missing] = np.nan
    path = path.astype(dtype)
    before = path.tobytes()
    result, expected = (noise.of_path(backend, path) for backend in (_core, _reference))
    assert path.tobytes() == before, "the input was written"
    largest = np.nanmax(np.abs(path), initial=0) if missing < 1 else 0
    assert abs(result - expected) <= tolerances.filtered(dtype) * largest
