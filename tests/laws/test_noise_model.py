"""What must hold for measured noise, on clips whose noise is known."""

import numpy as np
import pytest
import quatfilt as qf
from quatfilt.evaluation.synthetic import walk
from scipy.signal import lfilter
from scipy.spatial.transform import Rotation

FPS = 120
SIGMA = 0.03


@pytest.fixture(scope="module")
def clean():
    return np.ascontiguousarray(walk(seconds=8).rotations[:, :12])


def coloured(rng, shape, rho):
    white = rng.normal(0, np.sqrt(1 - rho**2), (shape[0] + 100, *shape[1:]))
    return lfilter([1], [1, -rho], white, axis=0)[100:]


def noise(kind, shape, seed=0):
    """Return rotation vectors of one kind of noise with the deviation `SIGMA`."""
    rng = np.random.default_rng(seed)
    vectors = rng.normal(size=shape)
    time = np.arange(shape[0])
    if kind.startswith("ar"):
        vectors = coloured(rng, shape, float(kind[2:]))
    if kind == "unsteady":
        vectors *= np.where(time // 150 % 3 == 2, 2.0, 0.133)[:, None, None]
    if kind == "axis":
        vectors *= [0.3, 0.3, 3.0]
    return SIGMA * vectors


def noisy(clean, kind, seed=0):
    vectors = noise(kind, (*clean.shape[:2], 3), seed)
    return qf.multiply(clean, qf.exp(vectors / 2)), vectors


def psnr(clean, q):
    return float(qf.metrics.psnr(clean, q))


KINDS = ["white", "ar0.5", "ar0.7", "unsteady", "axis"]


@pytest.mark.parametrize("kind", KINDS)
def test_the_level_is_the_root_mean_square_over_time(clean, kind):
    q, vectors = noisy(clean, kind)
    truth = np.sqrt(np.mean(vectors**2, axis=(0, 2)))
    ratio = qf.noise_level(q) / truth
    assert 0.9 < np.median(ratio) < 1.1
    model = qf.noise_model(q, fps=FPS)
    np.testing.assert_allclose(model.joint_level, qf.noise_level(q), rtol=1e-6)


def test_repeats_do_not_hide_the_level(clean):
    q, _ = noisy(clean, "white")
    frozen = q.copy()
    frozen[:500] = frozen[0]
    held = q[np.arange(len(q)) // 4 * 4]
    one = q.copy()
    one[200:500, 3] = one[199, 3]
    for clip in (frozen, held, one):
        assert 0.9 < np.median(qf.noise_level(clip)) / SIGMA < 1.15
    assert qf.noise_model(frozen).repeated[1:500].all()
    assert 0.74 < qf.noise_model(held).repeated.mean() < 0.76
    assert np.flatnonzero(qf.noise_model(one).repeated.any(axis=0)).tolist() == [3]


@pytest.mark.parametrize(
    ("kind", "least", "most"), [("ar0.5", 0.4, 0.6), ("ar0.7", 0.58, 0.8), ("white", 0, 0)]
)
def test_colour(clean, kind, least, most):
    assert least <= qf.noise_model(noisy(clean, kind)[0]).colour <= most


def test_level_along_time(clean):
    q, _ = noisy(clean, "unsteady")
    model = qf.noise_model(q)
    bad = np.arange(len(q)) // 150 % 3 == 2
    assert np.median(model.along_time[bad]) > 6 * np.median(model.along_time[~bad])
    assert np.isclose(np.mean(model.along_time**2), 1)
    assert qf.noise_model(noisy(clean, "white")[0]).steady


def test_axes(clean):
    model = qf.noise_model(noisy(clean, "axis")[0])
    assert (model.level[:, 2] > 5 * model.level[:, 0]).all()
    assert np.median(np.abs(model.axes[:, 2, 2])) > 0.98


def test_signs_the_frame_of_the_world_and_missing_samples(clean):
    q, _ = noisy(clean, "ar0.5")
    model = qf.noise_model(q)
    rng = np.random.default_rng(1)
    signs = rng.choice([-1.0, 1.0], q.shape[:2])[..., None]
    turned = qf.multiply(np.tile(qf.exp(np.array([0.3, -0.5, 0.2])), (*q.shape[:2], 1)), signs * q)
    other = qf.noise_model(turned)
    np.testing.assert_allclose(other.level, model.level, rtol=1e-6)
    assert abs(other.colour - model.colour) < 1e-6
    gaps = q.copy()
    gaps[300:330, 2] = np.nan
    with_gaps = qf.noise_model(gaps)
    assert not with_gaps.repeated.any()
    np.testing.assert_allclose(with_gaps.joint_level, model.joint_level, rtol=0.2)


def test_a_motion_knows_its_frame_rate(clean):
    motion = (
        qf.Motion(
            rotations=clean, translation=np.zeros((len(clean), 3)), fps=FPS, skeleton=walk(seconds=8).skeleton
        )
        if clean.shape[1] == len(walk(seconds=1).skeleton.names)
        else walk(seconds=2)
    )
    assert qf.noise_model(motion).fps == motion.fps
    np.testing.assert_array_equal(qf.noise_level(motion), qf.noise_level(motion.rotations))
    with pytest.raises(TypeError, match="scalar_first"):
        qf.noise_level(motion, scalar_first=False)


# ---- edges


@pytest.mark.parametrize("frames", [0, 1, 2, 3])
def test_a_few_frames_have_no_noise(frames):
    model = qf.noise_model(np.tile([1.0, 0, 0, 0], (frames, 2, 1)))
    assert (model.level == 0).all()
    assert model.along_time.shape == (frames,)
    assert "white" in repr(model)


def test_missing_joints_constant_joints_and_one_joint(clean):
    q, _ = noisy(clean, "white")
    q[:, 1] = np.nan
    q[:, 2] = q[0, 2]
    level = qf.noise_level(q)
    assert level[1] == 0
    assert level[2] == 0
    assert not qf.noise_model(q).repeated[:, 2].any()
    assert 0.9 < level[0] / SIGMA < 1.1
    assert 0.9 < qf.noise_level(q[:, 0]) / SIGMA < 1.1
    result = qf.smooth(q, noise="measured", joints="together")
    assert np.isfinite(np.delete(result, 1, axis=1)).all()


def test_pure_noise_and_a_seam():
    rng = np.random.default_rng(0)
    still = np.tile([1.0, 0, 0, 0], (900, 4, 1))
    noise = qf.exp(rng.normal(0, SIGMA / 2, (900, 4, 3)))
    assert np.allclose(qf.noise_level(noise), SIGMA, rtol=0.15)
    seam = noise.copy()
    seam[450:] = qf.multiply(np.tile(qf.exp(np.array([0.5, 0, 0])), (450, 4, 1)), noise[450:])
    assert np.allclose(qf.noise_level(seam), SIGMA, rtol=0.15)
    cut = noise.copy()
    cut[:450] = qf.multiply(still[:450], qf.exp(rng.normal(0, 0.004 / 2, (450, 4, 3))))
    along = qf.noise_model(cut).along_time
    assert np.median(along[450:]) > 5 * np.median(along[:450])


# ---- smoothing by the model


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_white_noise_is_smoothed_as_before(clean, dtype):
    q = noisy(clean, "white")[0].astype(dtype)
    for joints in ("apart", "together"):
        np.testing.assert_array_equal(
            qf.smooth(q, joints=joints, noise="measured"), qf.smooth(q, joints=joints)
        )


def test_weak_white_noise_is_noise_where_the_frame_rate_is_known(clean):
    q = qf.add_gaussian_noise(clean, sigma=0.002, rng=3)
    assert qf.noise_model(clean, fps=FPS).evidence == 0
    assert qf.noise_model(q).evidence < 1
    assert qf.noise_model(q, fps=FPS).evidence == 1
    np.testing.assert_array_equal(
        qf.smooth(q, joints="together", noise="measured", fps=FPS), qf.smooth(q, joints="together")
    )


def test_bursts_of_noise_are_noise_where_the_rest_is_not(clean):
    q = qf.add_gaussian_noise(clean[::4], sigma=0.004, rng=5)
    vectors = np.random.default_rng(4).normal(0, SIGMA, (40, clean.shape[1], 3))
    q[100:140] = qf.multiply(q[100:140], qf.exp(vectors / 2))
    model = qf.noise_model(q, fps=FPS / 4)
    assert model.evidence == 1
    along = model.along_time
    assert np.median(along[105:135]) > 4 * np.median(along[150:])
    assert (
        psnr(clean[::4], qf.smooth(q, noise="measured", fps=FPS / 4)) > psnr(clean[::4], qf.kalman(q)) - 0.5
    )


@pytest.mark.parametrize(("kind", "gain"), [("ar0.5", 3), ("ar0.7", 2), ("unsteady", 2), ("axis", 2)])
def test_other_noise_is_smoothed_better_than_by_a_low_pass(clean, kind, gain):
    q, _ = noisy(clean, kind)
    result = psnr(clean, qf.denoise(q, fps=FPS))
    assert result > psnr(clean, qf.butterworth(q, cutoff=6, fps=FPS)) + gain
    assert result > psnr(clean, qf.kalman(q, fps=FPS)) - 0.5


def test_a_frozen_half_does_not_hide_the_noise_of_the_other(clean):
    q, _ = noisy(clean, "white")
    half = len(q) // 2
    q[:half] = q[0]
    result = qf.denoise(q, fps=FPS)
    assert psnr(clean[half:], result[half:]) > psnr(clean[half:], qf.butterworth(q, cutoff=6, fps=FPS)[half:])
    # What a frozen joint did is not known: its samples stay.
    assert np.degrees(qf.geodesic_distance(result[1:half], q[1:half])).max() < 1e-5


@pytest.mark.parametrize("every", [1, 4])
def test_clean_motion_hardly_changes(clean, every):
    q = np.ascontiguousarray(clean[::every])
    changed = np.degrees(qf.geodesic_distance(q, qf.denoise(q, fps=FPS / every)))
    assert changed.mean() < (0.02 if every == 1 else 0.05)


def test_infinite_strengths_are_refused_and_large_ones_leave_a_smooth_path(clean):
    q, _ = noisy(clean, "ar0.5")
    with pytest.raises(ValueError, match="strength"):
        qf.smooth(q, noise="measured", strength=np.inf)
    assert np.isfinite(qf.smooth(q[:200], noise="measured", strength=1e6)).all()
    np.testing.assert_allclose(
        qf.geodesic_distance(qf.smooth(q, noise="measured", strength=0), q), 0, atol=1e-6
    )


def test_rotations_of_euler_angles_in_steps_are_accepted(clean):
    angles = Rotation.from_quat(clean.reshape(-1, 4), scalar_first=True).as_euler("ZXY", degrees=True)
    steps = Rotation.from_euler("ZXY", np.round(angles), degrees=True).as_quat(scalar_first=True)
    q = steps.reshape(clean.shape)
    assert np.isfinite(qf.denoise(q, fps=FPS)).all()
    assert np.isfinite(qf.noise_level(q)).all()


# ---- filters that ask for the level


def test_white_noise_has_the_level_of_noise_level_in_every_filter(clean):
    q, _ = noisy(clean, "white")
    level = qf.noise_level(q)
    np.testing.assert_array_equal(qf.kalman_noises(q, fps=FPS)[1], level)
    np.testing.assert_array_equal(
        qf.nonlocal_pose_means(q), qf.nonlocal_pose_means(q, bandwidth=np.sqrt(np.mean(level**2)))
    )


@pytest.mark.parametrize(("kind", "gain"), [("ar0.7", 1.0), ("unsteady", 1.0)])
def test_nonlocal_pose_means_takes_the_measured_level(clean, kind, gain):
    q, vectors = noisy(clean, kind)
    truth = np.sqrt(np.mean(vectors**2))
    assert 0.85 < np.median(qf.kalman_noises(q, fps=FPS)[1]) / truth < 1.15
    assert psnr(clean, qf.nonlocal_pose_means(q)) > psnr(clean, q) + gain
