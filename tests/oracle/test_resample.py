"""Interpolation in time against SciPy's Slerp."""

import clips
import numpy as np
import pytest
import tolerances
from scipy.spatial.transform import Slerp


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_slerp(backend, dtype):
    rng = np.random.default_rng(0)
    q = clips.flipped(rng, clips.random_rotations(rng, 20, 3)).astype(dtype)
    times = np.cumsum(rng.uniform(0.1, 2, 20))
    new_times = np.concatenate([times, rng.uniform(times[0], times[-1], 200)])
    result = backend.slerp(q, times, new_times)
    assert result.dtype == dtype
    for joint in range(3):
        expected = Slerp(times, clips.rotation(q[:, joint]))(new_times)
        error = (clips.rotation(result[:, joint]).inv() * expected).magnitude()
        assert error.max() < tolerances.filtered(dtype)
