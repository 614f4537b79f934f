"""Measures of rotations: values worked out by hand, and laws."""

import math

import clips
import numpy as np
import pytest
import quatfilt as qf
import tolerances
from quatfilt.motion import metrics

pytestmark = pytest.mark.usefixtures("backend")

ERRORS = [metrics.psnr, metrics.mse, metrics.angle_error, metrics.peak_velocity_kept]


def still(frames, joints):
    return np.tile([1.0, 0.0, 0.0, 0.0], (frames, joints, 1))


def about_z(degrees):
    half = np.radians(degrees) / 2
    return np.stack([np.cos(half), 0 * half, 0 * half, np.sin(half)], axis=-1)


@pytest.fixture(name="pair")
def pair_of_clips():
    rng = np.random.default_rng(4)
    truth = clips.walk(rng, 90, 4)
    return truth, clips.noisy(rng, truth, 0.05)


def test_psnr_of_a_known_error():
    # One component of three is 0.3 rad everywhere: the mean square is 0.03.
    truth = still(50, 2)
    estimate = np.broadcast_to(about_z(np.degrees(0.3)), (50, 2, 4))
    expected = 20 * math.log10(math.pi) - 10 * math.log10(0.03)
    assert metrics.psnr(truth, estimate) == pytest.approx(expected, abs=1e-10)


def test_psnr_takes_the_mean_before_the_logarithm():
    # Half of the samples are right, half are wrong by 0.3 rad: 3 dB better than all wrong.
    truth, estimate = still(50, 1), still(50, 1)
    estimate[::2, 0] = about_z(np.degrees(0.3))
    expected = 20 * math.log10(math.pi) - 10 * math.log10(0.015)
    assert metrics.psnr(truth, estimate) == pytest.approx(expected, abs=1e-10)


def test_a_perfect_estimate():
    truth = still(9, 2)
    assert metrics.psnr(truth, truth) == math.inf
    assert metrics.mse(truth, truth) == 0
    assert metrics.angle_error(truth, -truth) == 0


def test_mse_is_the_squared_half_angle():
    estimate = np.stack([about_z([20.0, 0.0]), about_z([0.0, 40.0])])
    expected = np.radians([[10, 0], [0, 20]]) ** 2
    truth = still(2, 2)
    assert metrics.mse(truth, estimate, per="sample") == pytest.approx(expected, abs=tolerances.ALGEBRA)
    assert metrics.mse(truth, estimate, per="joint") == pytest.approx(expected.mean(axis=0))
    assert metrics.mse(truth, estimate) == pytest.approx(expected.mean())


def test_angle_error_in_degrees_per_sample_joint_and_clip():
    estimate = np.stack([about_z([170.0, 350.0]), about_z([-30.0, 0.0])])
    expected = np.array([[170.0, 10.0], [30.0, 0.0]])
    truth = still(2, 2)
    assert metrics.angle_error(truth, estimate, per="sample") == pytest.approx(expected)
    assert metrics.angle_error(truth, estimate, per="joint") == pytest.approx([100.0, 5.0])
    assert metrics.angle_error(truth, estimate) == pytest.approx(52.5)
    assert metrics.angle_error(truth[:, 0], estimate[:, 0], per="sample").shape == (2,)
    assert metrics.angle_error(truth[:, 0], estimate[:, 0], per="joint").shape == ()


def test_errors_agree_with_scipy(pair):
    truth, estimate = pair
    angles = clips.angles(truth, estimate)
    assert metrics.angle_error(truth, estimate, per="sample") == pytest.approx(np.degrees(angles), rel=1e-9)
    vectors = (clips.rotation(truth).inv() * clips.rotation(estimate)).as_rotvec()
    expected = 20 * math.log10(math.pi) - 10 * math.log10(np.mean(vectors**2))
    assert metrics.psnr(truth, estimate) == pytest.approx(expected, rel=1e-10)


def test_jerk_of_a_cubic_and_of_a_constant_turn():
    seconds = np.arange(80) / 20
    cubic = about_z(0.5 * seconds**3)
    assert metrics.jerk(cubic, fps=20) == pytest.approx(3.0, rel=1e-8)
    assert metrics.jerk(about_z(10 * seconds), fps=20) == pytest.approx(0, abs=1e-7)


def test_jerk_scales_with_the_cube_of_the_frame_rate(pair):
    truth, _ = pair
    assert metrics.jerk(truth, fps=10) == pytest.approx(1000 * metrics.jerk(truth), rel=1e-12)


def test_peak_velocity_is_a_percentile_and_a_mean_over_joints():
    # 100 steps of one degree, except for six of ten degrees: the 95th percentile sees those.
    steps = np.full(100, 1.0)
    steps[40:46] = 10
    fast = about_z(np.concatenate([[0], np.cumsum(steps)]))
    slow = about_z(np.arange(101) * 5.0)
    same = about_z(np.arange(101) * 2.0)
    truth = np.stack([fast, same], axis=1)
    estimate = np.stack([slow, same], axis=1)
    assert metrics.peak_velocity_kept(truth, estimate, per="joint") == pytest.approx([0.5, 1.0])
    assert metrics.peak_velocity_kept(truth, estimate) == pytest.approx(0.75)


def test_a_joint_at_rest_has_no_peak_to_keep():
    turning = about_z(np.arange(30) * 3.0)
    truth = np.stack([turning, still(30, 1)[:, 0]], axis=1)
    estimate = np.stack([turning, about_z(np.arange(30) % 2)], axis=1)
    kept = metrics.peak_velocity_kept(truth, estimate, per="joint")
    assert kept[0] == pytest.approx(1)
    assert np.isnan(kept[1])
    assert metrics.peak_velocity_kept(truth, estimate) == pytest.approx(1)


@pytest.mark.parametrize("measure", ERRORS)
def test_signs_change_nothing(measure, pair):
    rng = np.random.default_rng(8)
    truth, estimate = pair
    flipped = measure(clips.flipped(rng, truth), clips.flipped(rng, estimate))
    assert flipped == pytest.approx(measure(truth, estimate), rel=1e-12)


def test_signs_change_no_jerk(pair):
    rng = np.random.default_rng(8)
    assert metrics.jerk(clips.flipped(rng, pair[1])) == pytest.approx(metrics.jerk(pair[1]), rel=1e-12)


@pytest.mark.parametrize("measure", ERRORS)
def test_a_rotation_of_everything_changes_nothing(measure, pair):
    rng = np.random.default_rng(9)
    turn = clips.random_rotations(rng)
    turned = [clips.product(turn, q) for q in pair]
    assert measure(*turned) == pytest.approx(measure(*pair), rel=1e-9)


@pytest.mark.parametrize("measure", ERRORS)
@pytest.mark.parametrize("absence", [np.nan, 0.0])
def test_missing_samples_are_left_out(measure, absence, pair):
    truth, estimate = (q.copy() for q in pair)
    truth[60:, 1] = estimate[60:, 1] = [1, 0, 0, 0]
    truth[:, 1], estimate[:, 1] = truth[:, 0], estimate[:, 0]
    expected = measure(truth[:60], estimate[:60], per="joint")[1]
    truth[60:, 1] = absence
    assert measure(truth, estimate, per="joint")[1] == pytest.approx(expected, rel=1e-12)
    assert np.isfinite(measure(truth, estimate))
    assert measure(estimate, truth, per="joint").shape == (4,)


def test_missing_samples_leave_a_hole_in_what_is_returned_per_sample(pair):
    truth, estimate = (q.copy() for q in pair)
    estimate[3, 2] = np.nan
    angles = metrics.angle_error(truth, estimate, per="sample")
    assert np.argwhere(np.isnan(angles)).tolist() == [[3, 2]]


@pytest.mark.parametrize("measure", ERRORS)
@pytest.mark.parametrize("frames", [0, 1])
def test_nothing_to_compare_is_nan_without_a_warning(measure, frames):
    missing = np.full((frames, 2, 4), np.nan)
    assert math.isnan(measure(missing, missing))
    assert math.isnan(metrics.jerk(still(frames + 2, 2)))


@pytest.mark.parametrize("measure", ERRORS)
def test_clips_of_other_shapes_are_refused(measure):
    with pytest.raises(
        ValueError, match=r"estimate: expected the reference's shape \(5, 2, 4\), got \(4, 2, 4\)"
    ):
        measure(still(5, 2), still(4, 2))
    with pytest.raises(ValueError, match="per: expected one of 'clip', 'joint'"):
        measure(still(5, 2), still(5, 2), per="frame")


def test_scalar_last():
    truth, estimate = still(3, 1), np.broadcast_to(about_z(30.0), (3, 1, 4))
    last = [np.roll(q, -1, axis=-1) for q in (truth, estimate)]
    assert metrics.angle_error(*last, scalar_first=False) == pytest.approx(30)


def test_the_module_is_public():
    assert qf.metrics is metrics
