"""Samples of confidence 0 are missing samples, in every filter."""

import clips
import numpy as np
import pytest
import quatfilt as qf
import tolerances

FILTERS = {
    "bilateral": {},
    "butterworth": {"cutoff": 0.1},
    "despike": {},
    "gaussian": {"sigma": 2.0},
    "kalman": {},
    "nonlocal_pose_means": {"search_radius": 10},
    "one_euro": {},
    "orientation_filter": {"mask": [1, 2, 1]},
    "savgol": {"window_length": 9},
    "smooth": {},
    "wavelet": {},
    "weighted_moving_mean": {"iterations": 2},
}


def sample():
    """Return a noisy clip with nonsense in it, and its confidences."""
    rng = np.random.default_rng(2)
    q = clips.noisy(rng, clips.smooth(rng, 90, 2), 0.01)
    trust = np.ones(q.shape[:2])
    # Longer than the masks of the filters; single; at an end; beside a sample of little confidence.
    for frames, joint in ((slice(30, 60), 0), (slice(70, 71), 1), (slice(86, 90), 0), (slice(12, 15), 1)):
        trust[frames, joint] = 0
    q[trust == 0] = clips.random_rotations(rng, int((trust == 0).sum()))
    trust[11, 1] = 0.4
    return q, trust


@pytest.mark.usefixtures("backend")
@pytest.mark.parametrize("name", FILTERS)
def test_confidence_0_is_missing(name):
    q, trust = sample()
    gone = np.where(trust[..., None] == 0, np.nan, q)
    result = qf.denoise(q, method=name, confidence=trust, **FILTERS[name])
    expected = qf.denoise(gone, method=name, confidence=trust, **FILTERS[name])
    assert clips.angles(result, expected).max() < tolerances.ALGEBRA


@pytest.mark.usefixtures("backend")
@pytest.mark.parametrize("name", FILTERS)
def test_results_begin_in_the_hemisphere_of_the_first_frame(name):
    rng = np.random.default_rng(3)
    q = clips.smooth(rng, 60, 1)
    q[1:] *= -1
    trust = np.ones(60)
    trust[0] = 0
    result = qf.denoise(q, method=name, confidence=trust, **FILTERS[name])
    assert (np.sum(result[0] * q[0], axis=-1) > 0).all()
