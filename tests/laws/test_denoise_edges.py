"""Laws of `denoise` and `noise_model` on clips that are unlike motion."""

import numpy as np
import pytest
import quatfilt as qf
from scipy.spatial.transform import Rotation

FPS = 120
SIGMA = 0.03
FRAMES = 240


def still(frames=FRAMES, joints=3):
    return np.tile([1.0, 0, 0, 0], (frames, joints, 1))


def swing(frames=FRAMES, joints=3):
    angle = 0.5 * np.sin(2 * np.pi * np.arange(frames)[:, None] / FPS + np.arange(joints))
    return qf.exp(angle[..., None] * np.array([0.3, 0.0, 0.4]))


def error(truth, q):
    return np.degrees(qf.geodesic_distance(truth, q))


def test_joints_that_are_missing_throughout():
    q = qf.add_gaussian_noise(swing(), sigma=SIGMA, rng=0)
    alone = qf.denoise(q[:, 1:], fps=FPS)
    q[:, 0] = np.nan
    result = qf.denoise(q, fps=FPS)
    assert np.isnan(result[:, 0]).all()
    assert error(swing()[:, 1:], result[:, 1:]).mean() < error(swing()[:, 1:], q[:, 1:]).mean() / 2
    assert error(alone, result[:, 1:]).mean() < 0.2
    nothing = np.full_like(q, np.nan)
    assert np.isnan(qf.denoise(nothing, fps=FPS)).all()
    assert (qf.noise_model(nothing, fps=FPS).level == 0).all()


@pytest.mark.parametrize("frames", [1, 2, 3])
def test_a_few_frames_stay(frames):
    q = qf.add_gaussian_noise(swing(frames), sigma=SIGMA, rng=0)
    assert error(q, qf.denoise(q, fps=FPS)).max() < 1e-5


def test_one_joint_alone_and_as_a_series():
    q = qf.add_gaussian_noise(swing(joints=1), sigma=SIGMA, rng=0)
    result = qf.denoise(q, fps=FPS)
    assert error(swing(joints=1), result).mean() < error(swing(joints=1), q).mean() / 2
    np.testing.assert_array_equal(qf.denoise(q[:, 0], fps=FPS), result[:, 0])
    np.testing.assert_array_equal(qf.noise_model(q[:, 0], fps=FPS).level, qf.noise_model(q, fps=FPS).level)


def test_constant_clips_stay():
    q = np.broadcast_to(qf.exp(np.array([[0.1, 0.2, 0.3], [0, 0, 1.0]])), (FRAMES, 2, 4)).copy()
    assert error(q, qf.denoise(q, fps=FPS)).max() < 1e-5
    model = qf.noise_model(q, fps=FPS)
    assert (model.level == 0).all()
    assert not model.repeated.any()


def test_pure_noise_becomes_still():
    q = qf.add_gaussian_noise(still(600), sigma=SIGMA, rng=0)
    assert error(still(600), qf.denoise(q, fps=FPS)).mean() < error(still(600), q).mean() / 5


@pytest.mark.parametrize("step", [1, 2])
def test_angles_in_steps_do_not_get_worse(step):
    clean = swing()
    angles = Rotation.from_quat(clean.reshape(-1, 4), scalar_first=True).as_euler("ZXY", degrees=True)
    q = Rotation.from_euler("ZXY", np.round(angles / step) * step, degrees=True).as_quat(scalar_first=True)
    q = q.reshape(clean.shape)
    assert error(clean, qf.denoise(q, fps=FPS)).mean() < error(clean, q).mean()


def test_every_second_frame_repeated():
    noisy = qf.add_gaussian_noise(swing(2 * FRAMES)[::2], sigma=SIGMA, rng=0)
    q = np.repeat(noisy, 2, axis=0)
    model = qf.noise_model(q, fps=FPS)
    np.testing.assert_array_equal(model.repeated, np.tile([[False], [True]], (FRAMES, 3)))
    assert np.allclose(model.joint_level, SIGMA, rtol=0.2)
    assert error(swing(2 * FRAMES), qf.denoise(q, fps=FPS)).mean() < error(swing(2 * FRAMES), q).mean() / 2


def test_a_seam_stays_where_it_is():
    clean = swing(2 * FRAMES)
    clean[FRAMES:] = qf.multiply(qf.exp(np.array([0.3, 0.5, 0.0])), clean[FRAMES:])
    q = qf.add_gaussian_noise(clean, sigma=SIGMA, rng=0)
    assert np.allclose(qf.noise_model(q, fps=FPS).joint_level, SIGMA, rtol=0.15)
    result = qf.denoise(q, fps=FPS)
    away = np.abs(np.arange(2 * FRAMES) - FRAMES) > FPS // 6
    assert error(clean, result)[away].mean() < error(clean, q)[away].mean() / 2
    jump = error(clean[FRAMES - 1], clean[FRAMES])
    assert (error(result[FRAMES - 10], result[FRAMES + 10]) > 0.7 * jump).all()


def test_noise_that_changes_at_a_cut():
    clean = swing(2 * FRAMES)
    q = qf.add_gaussian_noise(clean, sigma=SIGMA / 10, rng=0)
    q[FRAMES:] = qf.add_gaussian_noise(clean[FRAMES:], sigma=SIGMA, rng=1)
    result = qf.denoise(q, fps=FPS)
    for part in (slice(FRAMES), slice(FRAMES, None)):
        assert error(clean, result)[part].mean() < error(clean, q)[part].mean()
    along = qf.noise_model(q, fps=FPS).along_time
    assert np.median(along[FRAMES:]) > 3 * np.median(along[:FRAMES])


def test_without_a_frame_rate_the_automatic_method_runs_and_a_preset_in_hertz_asks():
    q = qf.add_gaussian_noise(swing(), sigma=SIGMA, rng=0)
    assert error(swing(), qf.denoise(q)).mean() < error(swing(), q).mean() / 2
    with pytest.raises(ValueError, match="fps"):
        qf.denoise(q, preset="video")


def test_infinite_strengths_are_refused():
    with pytest.raises(ValueError, match="strength"):
        qf.denoise(swing(), fps=FPS, strength=np.inf)
