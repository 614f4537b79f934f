"""Interpolation in time: the core against the reference."""

import numpy as np
import tolerances
from drawn import same_samples, seeds, spoilt_clips
from hypothesis import given
from hypothesis import strategies as st
from quatfilt import _core, _reference


@given(q=spoilt_clips(), seed=seeds, count=st.sampled_from([0, 1, 2, 63, 64, 65, 300]), ordered=st.booleans())
def test_slerp(q, seed, count, ordered):
    rng = np.random.default_rng(seed)
    times = np.cumsum(rng.uniform(0.1, 2, len(q)))
    new_times = np.zeros(0)
    if len(q):
        # Samples themselves, both ends among them, and times between them.
        new_times = np.concatenate([rng.choice(times, count), rng.uniform(times[0], times[-1], count)])
        new_times = np.clip(np.concatenate([new_times, times[[0, -1]]]), times[0], times[-1])
    new_times = np.sort(new_times) if ordered else new_times
    result, expected = (backend.slerp(q, times, new_times) for backend in (_core, _reference))
    same_samples(result, expected, tolerances.filtered(q.dtype))
