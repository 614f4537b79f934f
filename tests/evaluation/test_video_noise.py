"""The preset "video" beside the fixed cut-off that came before it, on clips of 30 frames per second that nothing was tuned on."""

import numpy as np
import pytest
import quatfilt as qf
from quatfilt.evaluation.clips import load, thinned
from quatfilt.evaluation.robust_denoising import versions
from quatfilt.motion.metrics import angle_error, peak_velocity_kept, psnr

NAMES = ("02_06", "07_03", "16_13")


@pytest.fixture(scope="module", name="recordings")
def all_recordings(data_dir):
    return [thinned(clip, 4) for clip in load(data_dir, dict.fromkeys(NAMES, ""), longest=720)]


def fixed(motion):
    steps = ["despike", "nonlocal_pose_means", "butterworth"]
    return qf.denoise(motion, method=steps, nonlocal_pose_means={"weights": "joint"}, cutoff=6.0)


@pytest.mark.parametrize("level", [0.02, 0.05, 0.1])
def test_noise_of_estimators(recordings, level):
    """Better in the mean; weak noise is taken by the fixed filter a little better on single clips, 07_03 by 0.2 dB."""
    margins = []
    for clip in recordings:
        (noisy,) = versions(clip, "estimates", level, 1)
        found = [
            np.mean(psnr(clip.steady_rotations, motion.rotations[:, clip.steady]))
            for motion in (qf.denoise(noisy, preset="video"), fixed(noisy), noisy)
        ]
        assert found[1] > found[2]
        margins.append(found[0] - found[1])
    assert min(margins) > -0.5
    assert np.mean(margins) > 0


@pytest.mark.parametrize("preset", ["optical", "inertial", "video"])
def test_clean_motion(recordings, preset):
    """In degrees; the predecessor of "video" changes these clips by 0.4 to 0.55, and keeps .67 to .8 of the peaks."""
    for clip in recordings:
        before = clip.steady_rotations
        after = qf.denoise(clip.motion, preset=preset).rotations[:, clip.steady]
        assert np.mean(angle_error(before, after, per="sample")) < 0.05
        assert peak_velocity_kept(before, after) > 0.95
