"""The protocol of Table I, and what its page says."""

import json
import math

import numpy as np
import pytest
import quatfilt as qf
from quatfilt.evaluation import clips, nlpm_table1, nlpm_table1_page, nlpm_table1_picture, nlpm_table1_report
from quatfilt.evaluation._written import write
from quatfilt.evaluation.methods import GRID, METHODS, NOISY, ORACLES
from quatfilt.evaluation.noises import SIGMA, Noise

NOISES = (Noise("1σ", 1), Noise("75σ", 75), Noise("impulses", None))


@pytest.fixture(scope="module", name="report")
def report_of_a_short_walk():
    whole = clips.load(None)[0]
    motion = whole.motion.replace(
        rotations=whole.motion.rotations[:150], translation=whole.motion.translation[:150]
    )
    clip = clips.Clip("synthetic", "walk", motion, whole.steady)
    results = nlpm_table1.run([clip], seeds=2, noises=NOISES, workers=1)
    return nlpm_table1_report.Report([clip], NOISES, results, 2, "0.0", "the command")


def test_every_method_is_run_on_every_noise(report):
    found = [(result.noise, result.method) for result in report.results]
    assert found == [(noise.name, method) for noise in NOISES for method in (NOISY, *METHODS, *ORACLES)]
    assert all(len(result.measures) == 2 for result in report.results)


def test_noise_is_that_of_the_paper(report):
    # The mean of the squared components is σ², while no sample wraps.
    expected = 20 * math.log10(math.pi / SIGMA)
    assert report.mean(NOISY, "1σ", "psnr") == pytest.approx(expected, abs=0.1)


def test_an_oracle_is_never_worse_than_the_papers_bandwidth_which_is_on_its_grid(report):
    assert SIGMA in GRID
    for noise in NOISES:
        assert report.mean("oracle", noise.name, "psnr") >= report.mean("paper, mean", noise.name, "psnr")


def test_the_automatic_bandwidth_does_what_it_is_for(report):
    assert report.mean("auto", "1σ", "psnr") > report.mean(NOISY, "1σ", "psnr") + 5
    assert abs(report.mean("auto", "1σ", "delay")) < 0.1


def test_the_share_of_wrapped_samples_is_that_of_a_sample():
    noise = Noise("75σ", 75)
    vectors = np.random.default_rng(0).normal(0, 75 * SIGMA, (200_000, 3))
    assert noise.wrapped == pytest.approx(np.mean(np.linalg.norm(vectors, axis=1) > np.pi), abs=0.003)
    assert Noise("impulses", None).wrapped == 0


def test_processes_compute_the_same(report):
    again = nlpm_table1.run(report.clips, seeds=2, noises=NOISES[:1], workers=2)
    assert again == report.results[: len(again)]


def test_the_page_and_the_numbers_agree(report, tmp_path):
    written, trouble = write(
        tmp_path,
        nlpm_table1_report.STEM,
        page=nlpm_table1_page.markdown(report),
        numbers=nlpm_table1_report.as_dict(report),
        draw=lambda path: nlpm_table1_picture.draw(report, path),
    )
    assert trouble == ""
    assert [path.name for path in written] == ["nlpm-table1.md", "nlpm-table1.json", "nlpm-table1.png"]
    numbers = json.loads((tmp_path / "nlpm-table1.json").read_text(encoding="utf-8"))
    auto = next(one for one in numbers["results"] if (one["noise"], one["method"]) == ("1σ", "auto"))
    page = (tmp_path / "nlpm-table1.md").read_text(encoding="utf-8")
    assert f"| auto | {auto['mean']['psnr']:.2f} ±" in page
    assert "`paper, sum` returns the noisy clip as it is (within 0.01 dB) at 1σ" in page
    assert "75σ 7.67%" in page
    assert (tmp_path / "nlpm-table1.png").read_bytes().startswith(b"\x89PNG")


def test_clips_are_found_at_any_depth_and_their_unsteady_joints_left_out(data_dir):
    found = clips.load(data_dir)
    assert [clip.name for clip in found] == list(clips.CLIPS)
    for clip in found:
        steps = qf.geodesic_distance(clip.motion.rotations[1:], clip.motion.rotations[:-1]).max(axis=0)
        assert (np.degrees(steps[clip.steady]) <= 15).all()
        assert (np.degrees(steps[~clip.steady]) > 15).all()
