"""The noise level: the core against the reference."""

import clips
import numpy as np
import pytest
import tolerances
from drawn import spoil, spoilt_clips
from hypothesis import given
from hypothesis import strategies as st
from quatfilt import _core, _reference


def agree(q):
    result, expected = _core.noise_level(q), _reference.noise_level(q)
    assert result.dtype == expected.dtype
    np.testing.assert_allclose(result, expected, rtol=0, atol=tolerances.filtered(q.dtype))


@given(q=spoilt_clips(missing=st.sampled_from([0.0, 0.02, 0.2, 0.5, 1.0])))
def test_noise_level(q):
    before = q.tobytes()
    agree(q)
    assert q.tobytes() == before, "the input was written"


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("frames", [8_192, 8_200, 40_001])
@pytest.mark.parametrize("share", [0.0, 0.03])
def test_long_clips(frames, share, dtype):
    rng = np.random.default_rng(0)
    q = clips.noisy(rng, clips.smooth(rng, frames, 5), 0.01)
    # The median of a joint that rests half of the time lies beside a gap in the values.
    q[: frames // 2, 1] = q[0, 1]
    q[:, 2] = q[0, 2]
    agree(spoil(rng, clips.flipped(rng, q), share).astype(dtype))


@pytest.mark.parametrize("period", [2, 3, 4, 5, 20])
def test_periodic_clips(period):
    rng = np.random.default_rng(1)
    q = clips.noisy(rng, clips.random_rotations(rng, 1, 2).repeat(period, axis=0), 0.3)
    agree(np.tile(q, (20_000 // period, 1, 1)))
