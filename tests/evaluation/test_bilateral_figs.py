"""The figures of the bilateral filter: what is computed, and what the page says of it."""

import json
import math

import numpy as np
import pytest
import quatfilt as qf
from quatfilt.evaluation import bilateral_figs, bilateral_figs_page, bilateral_figs_picture
from quatfilt.evaluation._written import write
from quatfilt.evaluation.bilateral_figs_conditions import (
    CLIP,
    FRAMES,
    JOINTS,
    MASK,
    NOISE,
    PASSES,
    SIGMAS,
    START,
    with_noise,
)
from quatfilt.evaluation.bilateral_figs_results import path, speed
from quatfilt.evaluation.clips import load


@pytest.fixture(scope="module", name="figures")
def figures_of_the_walk():
    return bilateral_figs.run(None, seeds=2)


def test_the_noise_is_the_papers(figures):
    for curves in figures.curves:
        # ‖log‖² on S³ of three components of half the rotation's.
        assert curves.noisy_all == pytest.approx(3 * (NOISE / 2) ** 2, rel=0.03)
        assert set(curves.joint) == set(curves.every) == set(SIGMAS)
        assert all(len(values) == PASSES for values in curves.joint.values())
    assert [curves.fps for curves in figures.curves] == [30, 60, 120]


def test_an_infinite_sigma_is_the_gaussian_filter(figures):
    truth = figures.drawn.truth.rotations
    noisy = figures.drawn.motions["noisy"].rotations
    same = qf.bilateral(noisy, sigma_angle=math.inf, iterations=3)
    assert qf.geodesic_distance(same, qf.orientation_filter(noisy, MASK, iterations=3)).max() < 1e-9
    assert truth.shape[0] == FRAMES


def test_curves_are_means_over_the_seeds(figures):
    motion = figures.drawn.truth
    place = motion.skeleton.index(figures.drawn.joint)
    found = []
    for seed in range(2):
        noisy = with_noise(motion.rotations, seed)
        filtered = qf.bilateral(noisy, sigma_angle=0.4, iterations=4)
        found.append(qf.metrics.mse(motion.rotations[:, place], filtered[:, place]))
    assert figures.curves[0].joint[0.2][3] == pytest.approx(np.mean(found), rel=1e-9)


def test_integrated_displacements_drift_and_the_global_chart_depends_on_the_coordinates(figures):
    by_name = {one.name: one for one in figures.comparisons}
    fang, lee = by_name["displacements integrated"], by_name["Gaussian (Lee and Shin)"]
    assert fang.last_tenth > 4 * fang.first_tenth
    assert fang.last_tenth > 3 * lee.last_tenth
    spread = {name: one.turned[1] - one.turned[0] for name, one in by_name.items()}
    assert spread.pop("one global chart") > 1e-4
    assert max(spread.values()) < 1e-9


def test_averages_in_r4_are_off_the_more_the_sparser_the_frames(figures):
    away = [one.renormalised for one in figures.sparse]
    assert away == sorted(away)
    assert away[0] < 1e-3
    assert away[-1] > 10
    assert max(one.lee_shin for one in figures.sparse) < 1e-5


def test_paths_are_seen_from_the_root(figures):
    motion = figures.drawn.truth
    moved = motion.replace(translation=motion.translation + np.array([1.0, 2.0, 3.0]))
    hand = figures.drawn.hand
    assert path(moved, hand) == pytest.approx(path(motion, hand), abs=1e-9)
    assert speed(motion, figures.drawn.joint).shape == (FRAMES - 1,)


def test_the_page_and_the_numbers_agree(figures, tmp_path):
    run = bilateral_figs_page.Run(2, "0.0", "the command")
    written, trouble = write(
        tmp_path,
        bilateral_figs_page.STEM,
        page=bilateral_figs_page.markdown(figures, run),
        numbers=bilateral_figs_page.as_dict(figures, run),
        draw=lambda file: bilateral_figs_picture.draw(figures, file),
    )
    assert trouble == ""
    numbers = json.loads(written[0].with_suffix(".json").read_text(encoding="utf-8"))
    page = written[0].read_text(encoding="utf-8")
    after = numbers["curves"][0]["mse_by_pass"]["0.1"]["joint"]
    assert (
        f"| 30 fps, σ_g = 0.1 | {1e3 * numbers['curves'][0]['noisy']['joint']:.2f} | {1e3 * after[0]:.2f} |"
        in page
    )
    assert f"σ_g = 0.1: {1 + after.index(min(after))}" in page
    assert "| the paper, on a standard laptop of 2008 | 300 |" in page
    assert written[2].read_bytes().startswith(b"\x89PNG")


def test_the_recording_is_there(data_dir):
    clip = load(data_dir, CLIP)[0]
    joint, hand = JOINTS[clip.name]
    assert {joint, hand} <= set(clip.motion.skeleton.names)
    assert len(clip.motion) >= 120 * (START[clip.name] + 4 * FRAMES / 120)
