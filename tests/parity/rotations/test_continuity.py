"""Sign continuity: the core against the reference."""

import clips
import numpy as np
import pytest
from drawn import spoil, spoilt_clips
from hypothesis import given
from quatfilt import _core, _reference


@given(q=spoilt_clips())
def test_continuous(q):
    before = q.tobytes()
    np.testing.assert_array_equal(_core.continuous(q), _reference.continuous(q))
    assert q.tobytes() == before, "the input was written"


@pytest.mark.parametrize("share", [0.0, 0.01, 0.9])
@pytest.mark.parametrize("joints", [1, 7])
def test_across_tiles(joints, share):
    rng = np.random.default_rng(0)
    q = spoil(rng, clips.flipped(rng, clips.smooth(rng, 100_003, joints)), share)
    np.testing.assert_array_equal(_core.continuous(q), _reference.continuous(q))


def test_a_tile_without_valid_samples():
    rng = np.random.default_rng(1)
    q = clips.flipped(rng, clips.smooth(rng, 120_000, 1))
    q[20_000:110_000] = np.nan
    np.testing.assert_array_equal(_core.continuous(q), _reference.continuous(q))
