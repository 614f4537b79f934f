"""Headings: the core against the reference."""

import clips
import numpy as np
import pytest
import tolerances
from drawn import dtypes, lengths, missing, seeds, spoil
from hypothesis import given
from hypothesis import strategies as st
from quatfilt import _core, _reference


def agree(roots, up):
    before = roots.tobytes()
    for result, expected in zip(
        _core.split_heading(roots, up), _reference.split_heading(roots, up), strict=True
    ):
        assert result.dtype == expected.dtype
        scale = max(1, np.nanmax(np.abs(expected), initial=1))
        np.testing.assert_allclose(result, expected, rtol=0, atol=scale * tolerances.filtered(roots.dtype))
    assert roots.tobytes() == before, "the input was written"


@given(seed=seeds, frames=lengths, up=st.integers(0, 2), share=missing, dtype=dtypes)
def test_split_heading(seed, frames, up, share, dtype):
    rng = np.random.default_rng(seed)
    roots = clips.flipped(rng, clips.smooth(rng, frames, 1, swing=4.0))
    agree(np.ascontiguousarray(spoil(rng, roots, share)[:, 0].astype(dtype)), up)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("up", [0, 1, 2])
def test_a_thousand_turns(up, dtype):
    vectors = np.zeros((20_000, 3))
    vectors[:, up] = np.linspace(0, 1000 * 2 * np.pi, 20_000)
    agree(clips.from_vectors(vectors).astype(dtype), up)


def test_an_axis_that_is_none():
    with pytest.raises(ValueError, match=r"^up: expected 0, 1 or 2$"):
        _core.split_heading(np.ones((2, 4)), 3)
