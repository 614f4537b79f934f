"""The protocol of Table I, and what its page says."""

import json
import math
from dataclasses import replace

import numpy as np
import pytest
import quatfilt as qf
from quatfilt.evaluation import clips, nlpm_table1, nlpm_table1_page, nlpm_table1_picture, nlpm_table1_report
from quatfilt.evaluation._written import write
from quatfilt.evaluation.methods import BANDWIDTHS, CLASSICAL, NOISY, PASSES, ROWS, Clips
from quatfilt.evaluation.nlpm_table1_report import Report
from quatfilt.evaluation.noises import SIGMA, Noise, versions
from quatfilt.evaluation.real_jitter import Jitter
from quatfilt.evaluation.selection import best_of, levels

NOISES = (Noise("1σ", 1), Noise("75σ", 75), Noise("impulses", None))


def short_walk(frames=150):
    whole = clips.load(None, longest=frames)[0]
    assert len(whole.motion) == frames
    return whole


def report_of(clip):
    results = nlpm_table1.run([clip], seeds=2, noises=NOISES, workers=1)
    return Report([clip], NOISES, results, 2, "0.0", "the command")


@pytest.fixture(scope="module", name="report")
def report_of_a_short_walk():
    return report_of(short_walk())


@pytest.fixture(scope="module", name="slow")
def report_at_30_frames_per_second():
    return report_of(clips.thinned(short_walk(), 4))


def test_every_row_is_run_on_every_noise(report):
    found = [(result.noise, result.row) for result in report.results]
    assert found == [(noise.name, row) for noise in NOISES for row in ROWS]
    assert all(len(result.measures) == 2 for result in report.results)
    assert report.rows == list(ROWS)


def test_noise_is_that_of_the_paper(report):
    # The mean of the squared components is σ², while no sample wraps.
    expected = 20 * math.log10(math.pi / SIGMA)
    assert report.mean(NOISY, "1σ", "psnr") == pytest.approx(expected, abs=0.1)


def test_an_oracle_is_never_worse_than_a_setting_on_its_grid(report):
    assert SIGMA in BANDWIDTHS
    pairs = [("NLPM, oracle", "NLPM, paper, mean"), ("Savitzky-Golay, oracle", "Savitzky-Golay")]
    for noise in NOISES:
        for oracle, fixed in [*pairs, ("Blender, oracle", "Blender")]:
            assert report.mean(oracle, noise.name, "psnr") >= report.mean(fixed, noise.name, "psnr") - 1e-9


def test_all_oracles_choose_among_as_many_settings():
    assert len(set(PASSES)) == len(set(BANDWIDTHS)) == 17
    clip = short_walk(40)
    noisy = Clips.of([clip.steady_rotations], 120.0)
    for name, row in ROWS.items():
        if row.oracle:
            views = 2 if name in CLASSICAL else 1
            settings = [setting for setting, _ in row.candidates(noisy)]
            assert len(set(settings)) == 17 * views, name


def test_the_better_view_counts(report):
    clip = report.clips[0]
    for noise in NOISES:
        noisy = Clips.of(versions(clip, noise, 2), 120.0)
        truth = np.tile(clip.steady_rotations, (1, 2, 1))
        found = {
            setting: np.mean(levels(truth, q, 2)) for setting, q in ROWS["Butterworth"].candidates(noisy)
        }
        assert list(found) == ["6 Hz, vectors", "6 Hz, components"]
        assert report.of("Butterworth", noise.name)[0].setting == max(found, key=found.get)
        assert report.mean("Butterworth", noise.name, "psnr") == pytest.approx(max(found.values()), abs=1e-9)


def test_the_best_candidate_is_chosen_and_taken_apart():
    truth = short_walk(30).steady_rotations
    rng = np.random.default_rng(1)
    noisy = Clips.of([qf.add_gaussian_noise(truth, sigma=0.1, rng=rng) for _ in range(3)], 120.0)
    near = Clips.of([qf.add_gaussian_noise(truth, sigma=0.01, rng=rng) for _ in range(3)], 120.0)
    setting, estimates = best_of(
        iter([("noisy", noisy.rotations), ("near", near.rotations), ("noisy", noisy.rotations)]), truth, noisy
    )
    assert setting == "near"
    assert len(estimates) == 3
    assert np.array_equal(np.concatenate(estimates, axis=1), near.rotations)


def test_filters_of_whole_poses_see_one_version_at_a_time():
    truth = short_walk(40).steady_rotations
    rng = np.random.default_rng(2)
    noisy = [qf.add_gaussian_noise(truth, sigma=0.05, rng=rng) for _ in range(2)]
    side = Clips.of(noisy, 120.0)
    for row in ("NLPM", "bilateral"):
        together = side.apart(next(ROWS[row].candidates(side))[1])
        for version, filtered in zip(noisy, together, strict=True):
            alone = next(ROWS[row].candidates(Clips.of([version], 120.0)))[1]
            assert np.array_equal(filtered, alone)


def test_the_automatic_bandwidth_does_what_it_is_for(report):
    assert report.mean("NLPM", "1σ", "psnr") > report.mean(NOISY, "1σ", "psnr") + 5
    assert abs(report.mean("NLPM", "1σ", "delay")) < 0.1


def test_the_forward_kalman_filter_comes_late_and_the_smoother_does_not(report):
    assert report.mean("Kalman (forward)", "1σ", "delay") > 0.5
    assert abs(report.mean("Kalman (smoother)", "1σ", "delay")) < 0.1


def test_the_share_of_wrapped_samples_is_that_of_a_sample():
    noise = Noise("75σ", 75)
    vectors = np.random.default_rng(0).normal(0, 75 * SIGMA, (200_000, 3))
    assert noise.wrapped == pytest.approx(np.mean(np.linalg.norm(vectors, axis=1) > np.pi), abs=0.003)
    assert Noise("impulses", None).wrapped == 0


def test_processes_compute_the_same(report):
    rows = (NOISY, "Gaussian, oracle", "NLPM")
    again = nlpm_table1.run(report.clips, seeds=2, noises=NOISES[:1], rows=rows, workers=2)
    assert again == [result for row in rows for result in report.of(row, "1σ")]


def test_thinned_clips_are_a_quarter_and_keep_their_joints(report, slow):
    whole, thin = report.clips[0], slow.clips[0]
    assert slow.fps == 30
    assert np.array_equal(thin.motion.rotations, whole.motion.rotations[::4])
    assert np.array_equal(thin.steady, whole.steady)
    # There is less to average over.
    assert slow.mean("Gaussian, oracle", "1σ", "psnr") < report.mean("Gaussian, oracle", "1σ", "psnr")


def test_the_page_and_the_numbers_agree(report, slow, tmp_path):
    jitter = [
        Jitter(defect, joint, row, 114.27, 113.62, 0.25)
        for defect, joint in (
            ("05_05", "ltoes"),
            ("05_06", "ltoes"),
            ("05_18", "ltoes"),
            ("09_10", "lradius"),
            ("03_02", None),
        )
        for row in ("bridge", NOISY, "NLPM")
    ]
    more = Report(
        [replace(report.clips[0], name="another")],
        NOISES,
        [replace(result, clip="another") for result in report.results],
        2,
        "0.0",
        "the command",
    )
    tables = nlpm_table1_report.Tables(report, slow, more, jitter)
    written, trouble = write(
        tmp_path,
        nlpm_table1_report.STEM,
        page=nlpm_table1_page.markdown(tables),
        numbers=nlpm_table1_report.as_dict(tables),
        draw=lambda path: nlpm_table1_picture.draw(report, path),
    )
    assert trouble == ""
    assert [path.name for path in written] == ["nlpm-table1.md", "nlpm-table1.json", "nlpm-table1.png"]
    numbers = json.loads((tmp_path / "nlpm-table1.json").read_text(encoding="utf-8"))
    assert len(numbers["results"]) == 3 * len(ROWS) * len(NOISES)
    gaussian = {
        one["fps"]: one
        for one in numbers["results"]
        if (one["noise"], one["row"]) == ("1σ", "Gaussian, oracle")
    }
    page = (tmp_path / "nlpm-table1.md").read_text(encoding="utf-8")
    assert gaussian[120]["setting"].split()[1] == "frames,"
    for fps in (120, 30):
        assert (
            f"| Gaussian, oracle | {gaussian[fps]['mean'][numbers['measures'].index('psnr')]:.2f} ±" in page
        )
    assert "`NLPM, paper, sum` returns the noisy clip as it is (within 0.01 dB) at 1σ" in page
    assert "75σ 7.67%" in page
    assert "### another, walk (150 frames, " in page
    assert "| as recorded | 114.3 / 113.6 / 0.2 |" in page
    assert "| Gaussian, oracle | 73.89 (6) |" in page
    assert (tmp_path / "nlpm-table1.png").read_bytes().startswith(b"\x89PNG")


def test_clips_are_found_at_any_depth_and_their_unsteady_joints_left_out(data_dir):
    found = clips.load(data_dir)
    assert [clip.name for clip in found] == list(clips.CLIPS)
    for clip in found:
        steps = qf.geodesic_distance(clip.motion.rotations[1:], clip.motion.rotations[:-1]).max(axis=0)
        assert (np.degrees(steps[clip.steady]) <= 15).all()
        assert (np.degrees(steps[~clip.steady]) > 15).all()
