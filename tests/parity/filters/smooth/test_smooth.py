"""Automatic smoothing: the core against the reference."""

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
from plugins.properties import examples
from quatfilt import _core, _reference

DTYPES = [np.float32, np.float64]

LENGTHS = st.one_of(
    st.integers(0, 40),
    st.sampled_from([63, 64, 65, 127, 128, 129, 255, 256, 257]),
    st.sampled_from([511, 512, 513, 767, 768, 769, 1023, 1024, 1025, 1100]),
)
"""Around powers of two, and around sums of half blocks of 512 frames."""

NOISE = 0.1


def noisy(rng, frames, joints, *, swing=2.0, sigma=NOISE):
    """A clip with random signs to smooth."""
    return clips.flipped(rng, clips.noisy(rng, clips.smooth(rng, frames, joints, swing=swing), sigma))


def agree(q, noise, *, translation=None, confidence=None, translation_noise=0.05):
    translation, confidence = (
        None if x is None else np.require(x, q.dtype, "C") for x in (translation, confidence)
    )
    noise = np.broadcast_to(noise, q.shape[1]).astype(np.float64)
    arguments = (q, translation, confidence, noise, translation_noise)
    arrays = [x for x in arguments if isinstance(x, np.ndarray)]
    before = [x.tobytes() for x in arrays]
    (result, moved), (expected, path) = (backend.smooth(*arguments) for backend in (_core, _reference))
    assert [x.tobytes() for x in arrays] == before, "an input was written"
    tolerance = tolerances.principal_axes(q.dtype, len(q))
    same_samples(result, expected, tolerance)
    if translation is None:
        assert moved is None
        assert path is None
    else:
        assert moved.dtype == path.dtype == q.dtype
        size = max(1, np.abs(translation).max(initial=0))
        np.testing.assert_allclose(moved, path, rtol=0, atol=tolerance * size)


@given(
    seed=seeds,
    frames=LENGTHS,
    joints=st.sampled_from([0, 1, 2, 3, 5]),
    dtype=drawn.dtypes,
    swing=st.sampled_from([0.0, 0.02, 0.6, 2.0]),
    taken=st.sampled_from([0.0, 0.1, 1.0, 5.0]),
    trusting=st.booleans(),
    along=st.booleans(),
)
@examples(120)
def test_any_clip(seed, frames, joints, dtype, swing, taken, trusting, along):
    """`taken` is by how much more noise is taken for granted than there is."""
    rng = np.random.default_rng(seed)
    q = noisy(rng, frames, max(joints, 1), swing=swing)[:, :joints]
    agree(
        np.ascontiguousarray(q, dtype),
        taken * NOISE,
        translation=clips.path(rng, frames) if along else None,
        # Without any confidence, which is filled in before, the reference path may have no direction in short clips.
        confidence=np.maximum(clips.confidences(rng, frames, joints), 0.05) if trusting else None,
    )


@pytest.mark.parametrize("dtype", DTYPES)
@pytest.mark.parametrize("frames", [70, 600])
def test_samples_without_confidence(frames, dtype):
    rng = np.random.default_rng(frames)
    trust = clips.confidences(rng, frames, 4)
    trust[20:60, 1] = 0
    trust[:, 2] = 0
    agree(noisy(rng, frames, 4).astype(dtype), NOISE, translation=clips.path(rng, frames), confidence=trust)


@pytest.mark.parametrize("dtype", DTYPES)
def test_many_joints_some_of_them_still(dtype):
    rng = np.random.default_rng(0)
    q = noisy(rng, 90, 70)
    q[:, 3] = q[0, 3]
    q[:, 30:34] = noisy(rng, 90, 4, swing=0)
    noise = np.full(70, NOISE)
    noise[::9] = 0
    agree(q.astype(dtype), noise)


@pytest.mark.parametrize("dtype", DTYPES)
def test_turns_about_one_axis(dtype):
    """Beside it nothing moves: two of the axes are chance, and what lies along them is rounding."""
    angle = 0.05 * np.arange(300) + np.sin(np.arange(300) / 15)
    angle += np.random.default_rng(1).normal(0, 0.1, 300)
    q = clips.from_vectors(angle[:, None, None] * np.array([2.0, -1, 2]) / 3)
    agree(q.astype(dtype), NOISE)


@pytest.mark.parametrize("dtype", DTYPES)
def test_fast_turns_and_much_noise(dtype):
    rng = np.random.default_rng(2)
    q = clips.noisy(rng, clips.turning(rng, 700, 2, turns=9), 0.5)
    agree(clips.flipped(rng, q).astype(dtype), [0.5, 0.5])


@pytest.mark.parametrize("dtype", DTYPES)
@pytest.mark.parametrize("sigma", [0.3, 0.8, 1.2, 1.6])
@pytest.mark.parametrize("trusting", [False, True])
def test_noise_that_wraps(sigma, trusting, dtype):
    rng = np.random.default_rng(5)
    q = clips.noisy(rng, clips.smooth(rng, 600, 3), sigma)
    q[:, 1] = clips.noisy(rng, clips.smooth(rng, 600, 1), 0.05)[:, 0]
    trust = np.maximum(clips.confidences(rng, 600, 3), 0.05) if trusting else None
    agree(clips.flipped(rng, q).astype(dtype), [sigma, 0.05, sigma], confidence=trust)


@pytest.mark.parametrize("dtype", DTYPES)
@pytest.mark.parametrize("noise", [1e-12, 1e-6, 1e3, 1e90, 1e-99, 1e-101])
def test_far_too_little_and_far_too_much_noise(noise, dtype):
    rng = np.random.default_rng(3)
    q = noisy(rng, 100, 2).astype(dtype)
    agree(q, noise, translation=clips.path(rng, 100), translation_noise=noise)
    for backend in (_core, _reference):
        assert np.isfinite(backend.smooth(q, None, None, np.full(2, noise), 0.0)[0]).all()


@pytest.mark.parametrize("dtype", DTYPES)
@pytest.mark.parametrize("layout", LAYOUTS)
def test_layouts(layout, dtype):
    plain = noisy(np.random.default_rng(4), 80, 3).astype(dtype)
    result = qf.smooth(LAYOUTS[layout](plain))
    assert result.dtype == dtype
    np.testing.assert_array_equal(result, qf.smooth(plain))


@given(
    q=drawn.spoilt_clips(lengths=st.integers(0, 60), joints=st.sampled_from([1, 3, 5])),
    gaps=st.sampled_from(["fill", "keep"]),
    max_gap=st.sampled_from([None, 0, 1, 3, 1000]),
    strength=st.sampled_from([0, 0.5, 1, 2]),
)
def test_missing_samples(q, gaps, max_gap, strength):
    options = {"gaps": gaps, "max_gap": max_gap, "strength": strength}
    result = qf.smooth(q, **options)
    with qf.use_backend("numpy"):
        expected = qf.smooth(q, **options)
    same_samples(result, expected, tolerances.principal_axes(result.dtype, 0))
