"""Segmentation: the core against the reference."""

import clips
import numpy as np
import pytest
import tolerances
from drawn import spoilt_clips
from hypothesis import given
from hypothesis import strategies as st
from plugins.properties import examples
from quatfilt import _core, _reference


def agree(q, *options):
    before = q.tobytes()
    (cuts, growth, limit), (expected_cuts, expected_growth, expected_limit) = (
        backend.segment(q, *options) for backend in (_core, _reference)
    )
    assert q.tobytes() == before, "the input was written"
    assert cuts.dtype == expected_cuts.dtype
    np.testing.assert_array_equal(cuts, expected_cuts)
    np.testing.assert_allclose(growth, expected_growth, rtol=0, atol=tolerances.MOMENTS)
    np.testing.assert_allclose(limit, expected_limit, rtol=0, atol=tolerances.MOMENTS)
    return cuts


@examples(25)
@given(
    q=spoilt_clips(joints=st.sampled_from([1, 2, 5]), missing=st.sampled_from([0.0, 0.02, 1.0])),
    components=st.sampled_from([1, 2]),
    window=st.sampled_from([2, 10, 60]),
    min_length=st.sampled_from([1, 30]),
    lag=st.sampled_from([1, 7]),
)
def test_of_motion_with_missing_samples(q, components, window, min_length, lag):
    agree(q, components, window, min_length, lag, 2.5)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_across_blocks(dtype):
    rng = np.random.default_rng(3)
    q = np.concatenate([clips.walk(rng, frames, 4) for frames in (700, 300, 1100)])
    assert len(agree(q.astype(dtype), 1, 100, 50, 25, 3.0)) >= 2
