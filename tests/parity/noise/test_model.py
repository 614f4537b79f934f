"""What is known of noise besides its level: the core against the reference."""

import clips
import numpy as np
import pytest
import tolerances
from drawn import dtypes, seeds, spoil
from hypothesis import given, settings
from hypothesis import strategies as st
from quatfilt import _core, _reference
from scipy.signal import lfilter

FRAMES = st.sampled_from([0, 1, 2, 7, 63, 64, 65, 83, 84, 130, 300])


def noisy(seed, frames, joints, dtype, missing=0.0, rho=0.0):
    """Return motion with noise that is coloured, unsteady and unlike in its directions."""
    rng = np.random.default_rng(seed)
    noise = rng.normal(0, 0.02, (frames, joints, 3)) * [0.3, 1, 3]
    noise *= np.where(np.arange(frames) // 50 % 2, 4, 1)[:, None, None]
    if frames:
        noise = lfilter([1], [1, -rho], noise, axis=0)
    q = clips.product(clips.smooth(rng, frames, joints), clips.from_vectors(noise))
    return spoil(rng, clips.flipped(rng, q), missing).astype(dtype)


def loose(dtype):
    """Differences of order 6 take the roundings of the increments times 16."""
    return 100 * tolerances.filtered(dtype)


@settings(max_examples=30)
@given(
    seed=seeds,
    frames=FRAMES,
    joints=st.sampled_from([1, 3, 6]),
    dtype=dtypes,
    missing=st.sampled_from([0.0, 0.02, 0.5, 1.0]),
)
def test_along_time_and_evidence(seed, frames, joints, dtype, missing):
    q = noisy(seed, frames, joints, dtype, missing)
    before = q.tobytes()
    level = _reference.noise_level(q)
    for name in ("noise_along_time", "noise_over_motion"):
        result, expected = (getattr(backend, name)(q, level) for backend in (_core, _reference))
        np.testing.assert_allclose(result, expected, rtol=loose(dtype), atol=loose(dtype))
    assert q.tobytes() == before, "the input was written"


@settings(max_examples=20)
@given(
    seed=seeds,
    frames=FRAMES,
    joints=st.sampled_from([1, 5]),
    dtype=dtypes,
    missing=st.sampled_from([0.0, 0.02, 1.0]),
    rho=st.sampled_from([0.0, 0.5, 0.9]),
)
def test_colour(seed, frames, joints, dtype, missing, rho):
    q = noisy(seed, frames, joints, dtype, missing, rho)
    result, expected = (backend.noise_colour(q) for backend in (_core, _reference))
    assert abs(result - expected) <= loose(dtype)


@settings(max_examples=20)
@given(
    seed=seeds,
    frames=FRAMES,
    joints=st.sampled_from([1, 5]),
    dtype=dtypes,
    missing=st.sampled_from([0.0, 0.02, 1.0]),
)
def test_axes(seed, frames, joints, dtype, missing):
    q = noisy(seed, frames, joints, dtype, missing)
    (spread, axes), (expected, expected_axes) = (backend.noise_axes(q) for backend in (_core, _reference))
    np.testing.assert_allclose(spread, expected, rtol=0, atol=loose(dtype))
    # Axes have no sign, and none is told from another where the spread is alike.
    one, other = (
        np.einsum("jik,jk,jlk->jil", v, s**2, v) for v, s in ((axes, spread), (expected_axes, expected))
    )
    np.testing.assert_allclose(one, other, rtol=0, atol=loose(dtype))


@settings(max_examples=20)
@given(
    seed=seeds,
    frames=st.sampled_from([1, 2, 50]),
    joints=st.sampled_from([1, 4]),
    dtype=dtypes,
    colour=st.sampled_from([0.0, 0.5, 0.9]),
)
def test_whitening(seed, frames, joints, dtype, colour):
    rng = np.random.default_rng(seed)
    q = noisy(seed, frames, joints, dtype)
    developed = _reference.develop(q, None, np.full(joints, 3.0))
    spread = rng.uniform(0.3, 2, (joints, 3))
    axes = np.linalg.qr(rng.normal(size=(joints, 3, 3)))[0]
    result, expected = (b.whiten(*developed, colour, spread, axes) for b in (_core, _reference))
    for one, other in zip(result, expected, strict=True):
        np.testing.assert_allclose(one, other, rtol=0, atol=tolerances.FLOAT64 * 100)
    path, flat, _ = expected
    vectors = [b.unwhiten(q, path, flat, colour, spread, axes) for b in (_core, _reference)]
    np.testing.assert_allclose(*vectors, rtol=0, atol=tolerances.FLOAT64 * 1e4)


@given(seed=seeds, frames=st.sampled_from([0, 1, 40]), dtype=dtypes)
def test_drawn_towards(seed, frames, dtype):
    rng = np.random.default_rng(seed)
    q, estimate = noisy(seed, frames, 3, dtype), noisy(seed + 1, frames, 3, dtype)
    share = rng.choice([0.0, 0.3, 1.0], frames)
    result, expected = (backend.drawn_towards(q, estimate, share) for backend in (_core, _reference))
    assert result.dtype == dtype
    # Near half a turn from the estimate either way is the shorter one.
    far = np.abs(np.sum(q * estimate, axis=-1)) < 1e-3
    np.testing.assert_allclose(result[~far], expected[~far], rtol=0, atol=tolerances.filtered(dtype))


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_joints_at_rest(dtype):
    q = np.tile(np.array([0.5, 0.5, 0.5, 0.5], dtype), (200, 2, 1))
    for backend in (_core, _reference):
        assert backend.noise_colour(q) == 0
        assert (backend.noise_axes(q)[0] == 1).all()
        assert (backend.noise_along_time(q, backend.noise_level(q)) == 1).all()
        assert backend.noise_over_motion(q, backend.noise_level(q)) == 0
