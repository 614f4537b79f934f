"""The goal of the automatic method: how it is measured."""

import json

import numpy as np
import pytest
import quatfilt as qf
from quatfilt.evaluation import clips, smooth_goal, smooth_goal_page
from quatfilt.evaluation._written import write
from quatfilt.evaluation.bilateral_figs_conditions import CLIP
from quatfilt.evaluation.methods import CLASSICAL
from quatfilt.evaluation.noises import Noise, versions
from quatfilt.evaluation.real_jitter import DEFECTS
from quatfilt.evaluation.smooth_goal import GOAL_CLIPS

ROWS = ("Gaussian, oracle", "Butterworth, oracle")


def as_it_is(q):
    return q


@pytest.fixture(scope="module", name="walk")
def short_walk():
    return clips.load(None, longest=200)


@pytest.fixture(scope="module", name="outcomes")
def outcomes_of_the_automatic_method(walk):
    return smooth_goal.run(walk, smooth_goal.automatic(), seeds=2, multiples=(1, 15), rows=ROWS, workers=1)


def test_outcomes_are_those_of_the_method(walk, outcomes):
    truth = walk[0].steady_rotations
    noisy = versions(walk[0], Noise("15σ", 15), 2)
    expected = np.mean([qf.metrics.psnr(truth, qf.denoise(q)) for q in noisy])
    found = outcomes[1]
    assert found.multiple == 15
    assert found.automatic == pytest.approx(expected, abs=1e-9)
    assert found.noisy == pytest.approx(np.mean([qf.metrics.psnr(truth, q) for q in noisy]), abs=1e-9)
    assert found.margin == pytest.approx(expected - max(found.classical.values()), abs=1e-9)
    assert found.classical[found.best] == max(found.classical.values())
    assert set(found.settings) == set(ROWS)


def test_a_method_that_does_nothing_is_behind_by_what_the_filters_gain(walk):
    (found,) = smooth_goal.run(walk, as_it_is, seeds=1, multiples=(5,), rows=ROWS, workers=1)
    assert found.automatic == found.noisy
    assert found.margin < -8
    # One sample of a hundred turns by 35 degrees in the mean, on top of noise of its own.
    assert found.angle_with_impulses - found.angle == pytest.approx(0.01 * 30, abs=0.06)


def test_processes_compute_the_same(walk, outcomes):
    again = smooth_goal.run(walk, smooth_goal.automatic(), seeds=2, multiples=(1, 15), rows=ROWS, workers=2)
    assert again == outcomes


def test_the_recordings_are_used_nowhere_else():
    assert len(GOAL_CLIPS) == 20
    elsewhere = {*clips.CLIPS, *CLIP, *(defect.clip for defect in DEFECTS)}
    assert not elsewhere & set(GOAL_CLIPS)


def test_all_classical_filters_are_asked():
    names = [row.removesuffix(", oracle") for row in CLASSICAL]
    assert {"Gaussian", "Butterworth", "Savitzky-Golay", "wavelet", "Blender", "Kalman (smoother)"} <= set(
        names
    )


def test_the_recordings_are_there(data_dir):
    found = clips.load(data_dir, GOAL_CLIPS, longest=smooth_goal.LONGEST)
    assert [clip.name for clip in found] == list(GOAL_CLIPS)
    assert max(len(clip.motion) for clip in found) == smooth_goal.LONGEST
    assert min(clip.steady.sum() for clip in found) >= 15


def test_the_page_and_the_numbers_agree(walk, outcomes, tmp_path):
    report = smooth_goal_page.Report(walk, outcomes, "auto", 2, "0.0", "the command")
    written, trouble = write(
        tmp_path,
        smooth_goal_page.STEM,
        page=smooth_goal_page.markdown(report),
        numbers=smooth_goal_page.as_dict(report),
        draw=lambda path: smooth_goal_page.draw(report, path),
    )
    assert trouble == ""
    numbers = json.loads(written[1].read_text(encoding="utf-8"))
    page = written[0].read_text(encoding="utf-8")
    first = numbers["outcomes"][0]
    assert first["margin"] == pytest.approx(first["automatic"] - first["classical"][first["best"]])
    assert f"{first['margin']:+.2f} (synthetic)" in page
    assert written[2].read_bytes().startswith(b"\x89PNG")
