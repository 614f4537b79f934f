"""Exact repeats: the core against the reference."""

import numpy as np
from drawn import spoilt_clips
from hypothesis import given
from hypothesis import strategies as st
from quatfilt import _core, _reference


@given(
    q=spoilt_clips(missing=st.sampled_from([0.0, 0.2, 1.0])),
    seed=st.integers(0, 2**32 - 1),
    share=st.sampled_from([0.0, 0.5, 1.0]),
)
def test_find_repeats(q, seed, share):
    rng = np.random.default_rng(seed)
    for frame in range(1, len(q)):
        again = rng.random(q.shape[1]) < share
        q[frame, again] = rng.choice([-1, 1]) * q[frame - 1, again]
    before = q.tobytes()
    result = _core.find_repeats(q)
    np.testing.assert_array_equal(result, _reference.find_repeats(q))
    assert result.dtype == np.bool_
    assert q.tobytes() == before, "the input was written"
