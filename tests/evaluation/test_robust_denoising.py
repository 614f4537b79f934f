"""The table of the noise of trackers: its kinds of noise, and how it is measured."""

import json

import numpy as np
import pytest
import quatfilt as qf
from quatfilt.evaluation import clips, robust_denoising, robust_denoising_page
from quatfilt.evaluation._written import write
from quatfilt.evaluation.bilateral_figs_conditions import CLIP
from quatfilt.evaluation.noise_kinds import KINDS, Body, knots
from quatfilt.evaluation.real_jitter import DEFECTS
from quatfilt.evaluation.robust_denoising import AUTOMATIC, METHODS, ROBUST_CLIPS
from quatfilt.evaluation.smooth_goal import GOAL_CLIPS
from scipy.spatial.transform import Rotation

ROWS = ("Gaussian, oracle", "Butterworth, oracle")
TUNED = {"02_03", "05_02", "14_05", "86_01", "13_29", "07_01"}
LEVEL = 0.04
STATIONARY = ("white", "ar5", "ar8", "low-passed")


@pytest.fixture(scope="module", name="walk")
def short_walk():
    return clips.load(None, longest=240)


@pytest.fixture(scope="module", name="results")
def results_of_two_kinds(walk):
    return robust_denoising.run(
        walk, seeds=2, kinds=("white", "steps"), levels=(LEVEL,), every=(1, 4), rows=ROWS, workers=1
    )


def still(frames, joints=6):
    rotations = np.zeros((frames, joints, 4))
    rotations[..., 0] = 1
    return Body(rotations, ((2, 4), (3, 5)))


def noise(kind, frames=4000, seed=0, level=LEVEL):
    """Rotation vectors of a kind of noise on a body at rest."""
    return 2 * qf.log(KINDS[kind].add(still(frames), level, np.random.default_rng(seed)))


@pytest.mark.parametrize("kind", KINDS)
def test_a_kind_returns_unit_quaternions_and_depends_on_its_generator_alone(kind, walk):
    body = Body.of(walk[0].motion.rotations, walk[0].motion.skeleton.names)
    before = body.rotations.copy()
    noisy = [KINDS[kind].add(body, LEVEL, np.random.default_rng(seed)) for seed in (0, 0, 1)]
    assert noisy[0].shape == body.rotations.shape
    np.testing.assert_allclose(np.linalg.norm(noisy[0], axis=-1), 1, atol=1e-9)
    np.testing.assert_array_equal(noisy[0], noisy[1])
    assert np.array_equal(noisy[0], noisy[2]) == (not KINDS[kind].levelled)
    np.testing.assert_array_equal(body.rotations, before)


@pytest.mark.parametrize("kind", STATIONARY)
def test_stationary_noise_has_its_level_everywhere(kind):
    vectors = noise(kind)
    # 4000 frames of 6 joints: the deviation of the most correlated kind is known to 3 %.
    assert np.std(vectors) == pytest.approx(LEVEL, rel=0.03)
    assert np.std(vectors[:20]) == pytest.approx(LEVEL, rel=0.35)


@pytest.mark.parametrize(
    ("kind", "correlation"), [("white", 0.0), ("ar5", 0.5), ("ar8", 0.8), ("low-passed", 0.94)]
)
def test_noise_is_correlated_from_frame_to_frame(kind, correlation):
    vectors = noise(kind)
    found = np.mean(vectors[1:] * vectors[:-1]) / np.mean(vectors**2)
    assert found == pytest.approx(correlation, abs=0.02)


@pytest.mark.parametrize(("kind", "levels"), [("unsteady", (0.25, 2.0)), ("bad-third", (0.1, 1.5))])
def test_the_level_changes_along_time(kind, levels):
    found = noise(kind).reshape(40, -1).std(axis=1) / LEVEL
    assert np.all(np.min(np.abs(found[:, None] - levels) / levels, axis=1) < 0.15)
    assert {int(np.argmin(np.abs(level - np.array(levels)))) for level in found} == {0, 1}


def test_one_axis_is_ten_times_noisier():
    np.testing.assert_allclose(noise("axis").std(axis=(0, 1)) / LEVEL, [0.3, 0.3, 3.0], rtol=0.05)


def test_held_and_frozen_frames_repeat():
    held = noise("held", 400).reshape(100, 4, -1)
    assert np.all(held == held[:, :1])
    assert np.all(held[1:, 0] != held[:-1, 0])
    frozen = noise("frozen", 400)
    assert np.all(frozen[:200] == frozen[0])
    assert np.all(frozen[201:] != frozen[200:-1])
    assert KINDS["frozen"].counts(400) == slice(200, None)


def test_swaps_exchange_left_and_right():
    """A body whose left limbs point elsewhere than the right ones: swapped samples are far off, and 3 to 11 frames at a time."""
    body = still(4000)
    body.rotations[:, [2, 3]] = qf.exp([0.5, 0.0, 0.0])
    noisy = KINDS["swaps"].add(body, 0.001, np.random.default_rng(0))
    off = qf.geodesic_distance(body.rotations, noisy) > 0.5
    assert not off[:, :2].any()
    np.testing.assert_array_equal(off[:, 2:], np.repeat(off[:, 2:3], 4, axis=1))
    edges = np.flatnonzero(np.diff(np.concatenate([[False], off[:, 2], [False]])))
    lengths = edges[1::2] - edges[::2]
    assert 15 < len(lengths) < 60
    assert np.median(lengths) == pytest.approx(7, abs=2)


def test_joints_are_paired_by_their_names(walk):
    names = ["hips", "lfemur", "rfemur", "lowerback", "LeftArm", "RightArm", "lhand"]
    assert Body.of(still(3, 7).rotations, names).pairs == [(1, 2), (4, 5)]
    assert len(Body.of(walk[0].motion.rotations, walk[0].motion.skeleton.names).pairs) == 8


@pytest.mark.parametrize(
    ("kind", "joints", "degrees"), [("runs", range(6), (15, 60)), ("flips", [0], (100, 170))]
)
def test_runs_are_turned_far(kind, joints, degrees):
    angles = np.degrees(np.linalg.norm(noise(kind, level=1e-6), axis=-1))
    hit = angles > 1
    assert set(np.flatnonzero(hit.any(axis=0))) == set(joints)
    once = angles[hit & (angles < degrees[1] + 1)]
    assert len(once) > 0.9 * hit.sum()  # two runs that overlap turn farther
    # The root has about 20 runs: the first and last of 20 even draws lie a twentieth of the range from its ends.
    assert np.percentile(once, [1, 99]) == pytest.approx(degrees, abs=0.3 * (degrees[1] - degrees[0]))


def test_angles_stand_in_steps(walk):
    body = Body.of(walk[0].motion.rotations, walk[0].motion.skeleton.names)
    stepped = KINDS["steps"].add(body, 0.0, np.random.default_rng(0))
    degrees = Rotation.from_quat(stepped.reshape(-1, 4), scalar_first=True).as_euler("ZXY", degrees=True)
    np.testing.assert_allclose(degrees, np.round(degrees), atol=1e-6)


def test_between_the_ticks_of_a_clock_motion_is_straight():
    times = knots(1000, np.random.default_rng(3))
    gaps = np.diff(times[1:-1])
    assert np.all(np.isclose(gaps, 10 / 3) | np.isclose(gaps, 20 / 3))
    assert 0.05 < np.mean(gaps > 4) < 0.3
    vectors = noise("interpolated", 1000)
    bent = np.linalg.norm(np.diff(vectors, n=2, axis=0), axis=-1) > 1e-3 * LEVEL
    # A knot bends the path at the two frames beside it, in all joints.
    assert np.mean(bent.all(axis=1) | ~bent.any(axis=1)) > 0.9
    assert 0.4 < np.mean(bent.all(axis=1)) < 0.7


def test_mixtures_have_both_parts():
    assert {name for name in KINDS if "+" in name} == {
        "ar5+bursts",
        "axis+unsteady",
        "ar8+swaps",
        "student+held",
    }
    held = noise("student+held", 400).reshape(100, 4, -1)
    assert np.all(held == held[:, :1])


def test_outcomes_are_those_of_the_methods(walk, results):
    outcomes, unchanged = results
    assert [(one.fps, one.kind, one.level) for one in outcomes] == [
        (120, "white", LEVEL),
        (120, "steps", None),
        (30, "white", LEVEL),
        (30, "steps", None),
    ]
    clip, found = walk[0], outcomes[0]
    noisy = robust_denoising.versions(clip, "white", LEVEL, 2)
    truth = clip.motion.rotations[:, clip.steady]

    def mean(estimates):
        return np.mean([qf.metrics.psnr(truth, motion.rotations[:, clip.steady]) for motion in estimates])

    assert found.noisy == pytest.approx(mean(noisy), abs=1e-9)
    for name, options in METHODS.items():
        assert found.psnr[name] == pytest.approx(mean([qf.denoise(q, **options) for q in noisy]), abs=1e-9)
    assert found.margin == found.psnr[AUTOMATIC] - max(found.psnr["kalman"], found.psnr["bw6"])
    assert found.best in {"Gaussian", "Butterworth"}
    cleaned = qf.denoise(clip.motion)
    first = unchanged[0]
    assert (first.fps, first.method) == (120, AUTOMATIC)
    assert first.change == pytest.approx(
        qf.metrics.angle_error(truth, cleaned.rotations[:, clip.steady]), abs=1e-9
    )
    assert first.slide == pytest.approx(qf.metrics.foot_slide(cleaned, reference=clip.motion))
    assert len(unchanged) == 2 * len(METHODS)


def test_processes_compute_the_same(walk, results):
    again = robust_denoising.run(
        walk, seeds=2, kinds=("white", "steps"), levels=(LEVEL,), every=(1, 4), rows=ROWS, workers=2
    )
    assert again == results


def test_nothing_was_tuned_on_the_recordings():
    elsewhere = {*clips.CLIPS, *clips.MORE, *GOAL_CLIPS, *CLIP, *(defect.clip for defect in DEFECTS), *TUNED}
    assert not elsewhere & set(ROBUST_CLIPS)


def test_the_recordings_are_there(data_dir):
    found = clips.load(data_dir, ROBUST_CLIPS, longest=robust_denoising.LONGEST)
    assert [clip.name for clip in found] == list(ROBUST_CLIPS)
    assert min(clip.steady.sum() for clip in found) >= 15


def test_the_page_and_the_numbers_agree(walk, results, tmp_path):
    outcomes, unchanged = results
    report = robust_denoising_page.Report(walk, outcomes, unchanged, 2, "0.0", "the command")
    written, trouble = write(
        tmp_path,
        robust_denoising_page.STEM,
        page=robust_denoising_page.markdown(report),
        numbers=robust_denoising_page.as_dict(report),
        draw=lambda path: robust_denoising_page.draw(report, path),
    )
    assert trouble == ""
    numbers = json.loads(written[1].read_text(encoding="utf-8"))
    page = written[0].read_text(encoding="utf-8")
    first = numbers["outcomes"][0]
    lost = sum(one["margin"] < -0.5 for one in numbers["outcomes"])
    assert (
        f"Of 4 combinations of recording, frame rate, kind and level, {lost} are more than 0.5 dB below"
        in page
    )
    assert f"| white | {LEVEL} | {first['noisy']:.1f} | {first['psnr'][AUTOMATIC]:.1f} |" in page
    assert f"| 120 | {AUTOMATIC} | {numbers['clean'][0]['change']:.3f} |" in page
    assert written[2].read_bytes().startswith(b"\x89PNG")
