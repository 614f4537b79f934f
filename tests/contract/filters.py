"""What the filters have in common, for tests of what they take and refuse."""

import clips
import numpy as np
import pytest
import quatfilt as qf

FILTERS = {
    "bilateral": qf.bilateral,
    "butterworth": lambda q, *more, cutoff=0.1, **options: qf.butterworth(q, *more, cutoff=cutoff, **options),
    "denoise": lambda q, *more, **options: qf.denoise(q, *more, method="nonlocal_pose_means", **options),
    "despike": qf.despike,
    "gaussian": lambda q, *more, sigma=2.0, **options: qf.gaussian(q, *more, sigma=sigma, **options),
    "kalman": qf.kalman,
    "nonlocal_pose_means": qf.nonlocal_pose_means,
    "one_euro": qf.one_euro,
    "orientation_filter": lambda q, *more, **options: qf.orientation_filter(
        q, [1, 2, 4, 2, 1], *more, **options
    ),
    "savgol": lambda q, *more, window_length=7, **options: qf.savgol(
        q, *more, window_length=window_length, **options
    ),
    "smooth": qf.smooth,
    "wavelet": qf.wavelet,
    "weighted_moving_mean": qf.weighted_moving_mean,
}
"""From clip to clip, with the options that all filters have in common."""

OPTIONS = {
    "bilateral": qf.bilateral.__kwdefaults__,
    "butterworth": {"cutoff": None, **qf.butterworth.__kwdefaults__},
    "denoise": qf.nonlocal_pose_means.__kwdefaults__,
    "despike": qf.despike.__kwdefaults__,
    "gaussian": {"sigma": None, **qf.gaussian.__kwdefaults__},
    "kalman": qf.kalman.__kwdefaults__,
    "nonlocal_pose_means": qf.nonlocal_pose_means.__kwdefaults__,
    "one_euro": qf.one_euro.__kwdefaults__,
    "orientation_filter": qf.orientation_filter.__kwdefaults__,
    "savgol": {"window_length": None, **qf.savgol.__kwdefaults__},
    "smooth": qf.smooth.__kwdefaults__,
    "wavelet": qf.wavelet.__kwdefaults__,
    "weighted_moving_mean": qf.weighted_moving_mean.__kwdefaults__,
}
"""The options of each filter."""

every_filter = pytest.mark.parametrize("name", FILTERS)

every_filter_of_all_samples = pytest.mark.parametrize("name", sorted(set(FILTERS) - {"despike"}))
"""Those that leave no sample as it came."""

FRAMES = 90


def clip(joints=3, frames=FRAMES, seed=0):
    """A noisy clip, continuous in sign."""
    rng = np.random.default_rng(seed)
    return qf.continuous(clips.noisy(rng, clips.smooth(rng, frames, joints), 0.03))


def refused(kind, call, *arguments, **options):
    """Return the message with which a call is refused, and see that nothing was written."""
    arrays = [x for x in (*arguments, *options.values()) if isinstance(x, np.ndarray)]
    before = [x.tobytes() for x in arrays]
    with pytest.raises(kind) as caught:
        call(*arguments, **options)
    assert [x.tobytes() for x in arrays] == before
    return str(caught.value)
