"""The scan of a clip: the core against the reference."""

import numpy as np
import pytest
import tolerances
from drawn import dtypes, lengths, seeds, spoilt_clips
from hypothesis import given
from hypothesis import strategies as st
from quatfilt import _core, _reference


def agree(q):
    """Compare the scans; of samples that are equally bad up to roundings either may be the worst."""
    missing, worst, index = _core.scan(q)
    expected_missing, expected_worst, expected_index = _reference.scan(q)
    assert missing == expected_missing
    tolerance = tolerances.algebra(q.dtype)
    np.testing.assert_allclose(worst, expected_worst, rtol=tolerance, atol=tolerance)
    if index != expected_index:
        norm = np.linalg.norm(q.reshape(-1, 4)[index].astype(np.float64))
        np.testing.assert_allclose(abs(norm - 1), expected_worst, rtol=tolerance, atol=tolerance)


@given(q=spoilt_clips())
def test_scan(q):
    before = q.tobytes()
    agree(q)
    assert q.tobytes() == before, "the input was written"


@given(seed=seeds, frames=lengths, dtype=dtypes, low=st.booleans(), high=st.booleans())
def test_one_bad_sample(seed, frames, dtype, low, high):
    rng = np.random.default_rng(seed)
    q = rng.standard_normal((frames, 3, 4))
    q /= np.linalg.norm(q, axis=-1, keepdims=True)
    flat = q.reshape(-1, 4)
    for present, scale in ((low, 0.8), (high, 1.3)):
        if present and frames:
            flat[rng.integers(len(flat))] *= scale
    q = q.astype(dtype)
    agree(q)
    if (low or high) and frames:
        assert _core.scan(q)[2] == _reference.scan(q)[2]


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("where", [0, 1, 65_536, 199_999])
@pytest.mark.parametrize("odd", [[0, 0, 0, 1.5], [np.nan, 0, 0, 1], [0, 0, 0, 0], [np.inf, 0, 0, 0]])
def test_across_tiles(dtype, where, odd):
    q = np.zeros((200_000, 1, 4), dtype)
    q[..., 2] = 1
    q[where] = odd
    assert _core.scan(q) == _reference.scan(q)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("size", [1e-30, 1e-200, 1e25, 1e30, 1e200])
def test_squares_that_overflow_or_vanish(dtype, size):
    with np.errstate(over="ignore"):
        q = np.tile(np.array([0, 0.6, 0, 0.8]), (100, 1, 1)).astype(dtype)
        q[[37, 63]] = np.array([[size / 2, 0, 0, 0], [0, size, 0, 0]])[:, None].astype(dtype)
    agree(q)
