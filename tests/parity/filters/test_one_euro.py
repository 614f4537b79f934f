"""The 1€ filter: the core against the reference."""

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

DTYPES = [np.float32, np.float64]


def noisy(rng, frames, joints, sigma=0.05):
    """A clip with random signs to filter."""
    return clips.flipped(rng, clips.noisy(rng, clips.smooth(rng, frames, joints, swing=2), sigma))


def agree(q, *, translation=None, confidence=None, min_cutoff=0.01, beta=0.1, derivative_cutoff=0.01):
    numbers = [
        np.broadcast_to(x, q.shape[1]).astype(np.float64).copy()
        for x in (min_cutoff, beta, derivative_cutoff)
    ]
    translation = None if translation is None else np.require(translation, q.dtype, "C")
    arguments = (q, translation, confidence, *numbers)
    before = [x.tobytes() for x in arguments if x is not None]
    (result, moved), (expected, path) = (backend.one_euro(*arguments) for backend in (_core, _reference))
    assert [x.tobytes() for x in arguments if x is not None] == before, "an input was written"
    assert result.dtype == expected.dtype == q.dtype
    tolerance = tolerances.filtered(q.dtype)
    same_samples(result, expected, tolerance)
    if path is None:
        assert moved is None
    else:
        assert moved.dtype == path.dtype
        np.testing.assert_allclose(moved, path, rtol=0, atol=tolerance)


@given(
    seed=seeds,
    frames=st.one_of(st.integers(0, 5), st.integers(6, 90)),
    joints=st.sampled_from([0, 1, 7, 8, 9, 17]),
    dtype=drawn.dtypes,
    min_cutoff=st.sampled_from([1e-300, 1e-3, 0.1, 10.0, np.inf]),
    beta=st.sampled_from([0.0, 0.1, 1e9]),
    derivative_cutoff=st.sampled_from([1e-6, 0.01, np.inf]),
    along=st.booleans(),
    trusted=st.booleans(),
)
def test_any_options(seed, frames, joints, dtype, min_cutoff, beta, derivative_cutoff, along, trusted):
    rng = np.random.default_rng(seed)
    agree(
        np.ascontiguousarray(noisy(rng, frames, max(joints, 1), 0.1)[:, :joints], dtype),
        translation=clips.path(rng, frames) if along else None,
        confidence=clips.confidences(rng, frames, joints).astype(dtype) if trusted else None,
        min_cutoff=min_cutoff * rng.uniform(0.5, 2, joints),
        beta=beta * rng.uniform(0.5, 2, joints),
        derivative_cutoff=derivative_cutoff * rng.uniform(0.5, 2, joints),
    )


@pytest.mark.parametrize("dtype", DTYPES)
def test_long_gaps_and_joints_that_begin_late_or_never(dtype):
    rng = np.random.default_rng(1)
    q = noisy(rng, 200, 5).astype(dtype)
    confidence = np.ones((200, 5), dtype)
    confidence[50:110, 1] = 0
    confidence[:30, 0] = 0
    confidence[150:, 2] = 0
    confidence[:, 3] = 0
    agree(q, confidence=confidence, translation=clips.path(rng, 200))
    agree(q[:, 3:].copy(), confidence=confidence[:, 3:].copy(), translation=clips.path(rng, 200))


@pytest.mark.parametrize("dtype", DTYPES)
@pytest.mark.parametrize("frames", [1023, 1024, 1025, 4096, 4097])
def test_around_the_ends_of_stretches(frames, dtype):
    agree(noisy(np.random.default_rng(frames), frames, 2).astype(dtype))


@pytest.mark.parametrize("dtype", DTYPES)
@pytest.mark.parametrize("layout", LAYOUTS)
def test_layouts(layout, dtype):
    plain = noisy(np.random.default_rng(4), 80, 3).astype(dtype)
    result = qf.one_euro(LAYOUTS[layout](plain), fps=120)
    assert result.dtype == dtype
    np.testing.assert_array_equal(result, qf.one_euro(plain, fps=120))


@given(
    q=drawn.spoilt_clips(lengths=st.integers(0, 60), joints=st.sampled_from([1, 3, 5])),
    gaps=st.sampled_from(["fill", "keep"]),
    max_gap=st.sampled_from([None, 0, 1, 3, 1000]),
)
def test_missing_samples(q, gaps, max_gap):
    options = {"gaps": gaps, "max_gap": max_gap, "min_cutoff": 0.02, "beta": 0.1}
    result = qf.one_euro(q, **options)
    with qf.use_backend("numpy"):
        expected = qf.one_euro(q, **options)
    same_samples(result, expected, tolerances.filtered(result.dtype))
