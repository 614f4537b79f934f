"""Gaps: the core against the reference."""

import clips
import numpy as np
import tolerances
from drawn import same_samples, spoil, spoilt_clips
from hypothesis import given
from hypothesis import strategies as st
from quatfilt import _core, _reference


def agree(q, max_gap):
    (result, filled), (expected, where) = (backend.fill_gaps(q, max_gap) for backend in (_core, _reference))
    assert filled.dtype == np.bool_
    np.testing.assert_array_equal(filled, where)
    same_samples(result, expected, tolerances.filtered(q.dtype))
    np.testing.assert_array_equal(np.isnan(result), np.isnan(expected))


@given(q=spoilt_clips(), max_gap=st.sampled_from([-1, 0, 1, 2, 5, 10_000]))
def test_fill_gaps(q, max_gap):
    before = q.tobytes()
    agree(q, max_gap)
    assert q.tobytes() == before, "the input was written"


def test_across_tiles():
    rng = np.random.default_rng(0)
    q = spoil(rng, clips.flipped(rng, clips.smooth(rng, 50_000, 2)), 0.3)
    q[10_000:40_000, 1] = np.nan
    agree(q, -1)
    agree(q, 6)
