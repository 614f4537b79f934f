"""Karcher means: the core against the reference."""

import clips
import numpy as np
import pytest
import quatfilt as qf
import tolerances
from drawn import dtypes, joints, lengths, seeds, spoil, spoilt_clips
from hypothesis import given
from hypothesis import strategies as st
from layouts import LAYOUTS
from quatfilt import _core, _reference


def agree(q, weights=None):
    """Compare the means, which have ``w ≥ 0``; a mean half a turn from 1 may have either sign."""
    before = q.tobytes()
    result, expected = (backend.mean(q, weights) for backend in (_core, _reference))
    assert q.tobytes() == before, "the input was written"
    assert result.dtype == expected.dtype == q.dtype
    assert result.shape == expected.shape == q.shape[1:]
    defined = np.isfinite(expected).all(axis=-1)
    np.testing.assert_array_equal(np.isfinite(result).all(axis=-1), defined)
    assert np.isnan(result[~defined]).all()
    assert (result[defined, 0] >= 0).all()
    if defined.any():
        error = clips.angles(expected[defined], result[defined]).max()
        assert error <= tolerances.filtered(q.dtype)


@given(q=spoilt_clips())
def test_of_motion_with_missing_samples(q):
    agree(q)


@given(
    seed=seeds,
    frames=lengths,
    joints=joints,
    spread=st.sampled_from([0.0, 1e-6, 0.01, 0.5, 1.0]),
    share=st.sampled_from([0.0, 0.3]),
    dtype=dtypes,
)
def test_with_weights(seed, frames, joints, spread, share, dtype):
    rng = np.random.default_rng(seed)
    q = np.tile(clips.random_rotations(rng, joints), (frames, 1, 1))
    q = spoil(rng, clips.flipped(rng, clips.noisy(rng, q, spread)), share).astype(dtype)
    weights = clips.confidences(rng, frames, joints) * 10.0 ** rng.uniform(-3, 3, joints)
    # Of a few samples far apart there may be several means: none of the others has much of a say here.
    weights[:1] += 100 * weights.sum(axis=0, keepdims=True)
    agree(q, weights.astype(dtype))


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("frames", [511, 512, 513, 4096, 4097, 20_011])
def test_across_tasks_and_subsets(frames, dtype):
    rng = np.random.default_rng(frames)
    q = clips.flipped(rng, clips.noisy(rng, clips.smooth(rng, frames, 9), 0.1))
    # One joint is there only where a subset of every fifth frame does not look.
    q[:, 7] = np.nan
    q[1:3, 7] = clips.random_rotations(rng, 1)
    agree(q.astype(dtype))
    agree(q.astype(dtype), rng.random((frames, 9)).astype(dtype))


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("turns", [0.3, 0.6, 0.8])
def test_of_turning_joints(turns, dtype):
    rng = np.random.default_rng(1)
    agree(clips.turning(rng, 700, 3, turns=turns).astype(dtype))


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("layout", LAYOUTS)
def test_layouts(layout, dtype):
    rng = np.random.default_rng(2)
    plain = clips.noisy(rng, clips.smooth(rng, 90, 3), 0.1).astype(dtype)
    q = LAYOUTS[layout](plain)
    result = qf.mean(q)
    np.testing.assert_array_equal(result, qf.mean(plain))
    with qf.use_backend("numpy"):
        assert clips.angles(qf.mean(q), result).max() <= tolerances.filtered(dtype)
