"""Gaps: the core against the reference."""

import clips
import numpy as np
import pytest
import tolerances
from drawn import same_samples, spoil, spoilt_clips
from hypothesis import given
from hypothesis import strategies as st
from quatfilt import _core, _reference

METHODS = ["slerp", "squad"]
methods = st.sampled_from(METHODS)


def agree(q, max_gap, method):
    (result, filled), (expected, where) = (
        backend.fill_gaps(q, max_gap, method) for backend in (_core, _reference)
    )
    assert filled.dtype == np.bool_
    np.testing.assert_array_equal(filled, where)
    same_samples(result, expected, tolerances.filtered(q.dtype))
    np.testing.assert_array_equal(np.isnan(result), np.isnan(expected))


@given(q=spoilt_clips(), max_gap=st.sampled_from([-1, 0, 1, 2, 5, 10_000]), method=methods)
def test_fill_gaps(q, max_gap, method):
    before = q.tobytes()
    agree(q, max_gap, method)
    assert q.tobytes() == before, "the input was written"


@pytest.mark.parametrize("method", METHODS)
def test_across_tiles(method):
    rng = np.random.default_rng(0)
    q = spoil(rng, clips.flipped(rng, clips.smooth(rng, 50_000, 2)), 0.3)
    q[10_000:40_000, 1] = np.nan
    agree(q, -1, method)
    agree(q, 6, method)
