"""What Courty's section 3.2 says of other filters, and what does not come out."""

import clips
import numpy as np
import pytest
import quatfilt as qf
from quatfilt.evaluation.comparisons import global_chart, integrated_displacements, renormalised_average

MASK = np.array([1.0, 4.0, 6.0, 4.0, 1.0])
FILTERS = (renormalised_average, global_chart, integrated_displacements)


def lee_shin(q, mask, *, iterations=1):
    return qf.orientation_filter(q, mask, iterations=iterations)


def about_x(degrees):
    """Rotations about the x axis, one joint."""
    angles = np.radians(np.asarray(degrees, float))[:, None, None]
    return clips.from_vectors(angles * [1.0, 0.0, 0.0])


def worst(a, b):
    return np.degrees(clips.angles(a, b)).max()


@pytest.fixture(name="pair", scope="module")
def truth_and_noisy():
    rng = np.random.default_rng(0)
    truth = clips.smooth(rng, 600, 6)
    return truth, clips.noisy(rng, truth, 0.1)


@pytest.mark.parametrize("run", FILTERS)
def test_all_are_the_masks_mean_of_small_angles_about_one_axis(run):
    degrees = 5 * np.sin(np.arange(80) / 6) + np.random.default_rng(1).normal(0, 0.5, 80)
    padded = np.pad(degrees, 2, mode="reflect")
    expected = np.convolve(padded, MASK / MASK.sum(), mode="valid")
    assert worst(run(about_x(degrees), MASK), about_x(expected)) < 2e-3
    twice = np.convolve(np.pad(expected, 2, mode="reflect"), MASK / MASK.sum(), mode="valid")
    # The ends of a displacement filter are its own: the path may differ there, within the first step.
    assert worst(run(about_x(degrees), MASK, iterations=2), about_x(twice)) < 0.1


@pytest.mark.parametrize("run", FILTERS)
def test_a_constant_clip_stays_and_signs_do_not_matter(run):
    rng = np.random.default_rng(2)
    still = np.repeat(clips.random_rotations(rng, 1, 3), 20, axis=0)
    assert worst(run(still, MASK), still) < 1e-6
    q = clips.smooth(rng, 40, 3, swing=0.2)
    assert worst(run(clips.flipped(rng, q), MASK), run(q, MASK)) < 1e-6


def test_integrated_displacements_drift(pair):
    truth, noisy = pair
    drift, steady = (
        np.degrees(clips.angles(truth, run(noisy, MASK, iterations=3))).mean(axis=1)
        for run in (integrated_displacements, lee_shin)
    )
    assert drift[:20].mean() < 2 * steady[:20].mean()
    assert drift[-100:].mean() > 3 * drift[50:150].mean() / 2
    assert drift[-100:].mean() > 4 * steady[-100:].mean()


def test_integrated_displacements_do_not_drift_about_one_axis():
    degrees = 40 * np.sin(np.arange(600) / 30) + np.random.default_rng(3).normal(0, 3, 600)
    filtered = [run(about_x(degrees), MASK) for run in (integrated_displacements, lee_shin)]
    assert worst(*filtered) < 5


def test_one_global_chart_breaks_near_the_antipode():
    # The path goes from a quarter turn through −1, one whole turn; there noise swings the logarithm about.
    degrees = np.linspace(90, 450, 600)
    truth = about_x(degrees)
    noisy = clips.noisy(np.random.default_rng(4), truth, 0.05)
    chart, lee = (np.degrees(clips.angles(truth, run(noisy, MASK)))[:, 0] for run in (global_chart, lee_shin))
    assert lee.max() < 10
    assert chart[degrees < 270].max() < 10
    assert chart[np.abs(degrees - 360) < 15].max() > 60


def test_one_global_chart_depends_on_the_coordinates_and_the_others_do_not(pair):
    _, noisy = pair
    turn = clips.from_vectors(np.array([[[0.0, 2.0, 0.0]]]))
    for run in (renormalised_average, integrated_displacements, lee_shin):
        assert worst(run(clips.product(turn, noisy), MASK), clips.product(turn, run(noisy, MASK))) < 1e-6
    moved = clips.product(turn, global_chart(noisy, MASK))
    assert worst(global_chart(clips.product(turn, noisy), MASK), moved) > 1


def test_averages_in_r4_are_off_where_frames_lie_far_apart():
    ahead = np.array([0.0, 0.0, 3.0, 2.0, 1.0])
    for step, least, most in ((2, 0, 1e-2), (100, 3, 40)):
        degrees = step * np.arange(40)
        wanted = about_x(degrees + step * (2 * 1 + 1 * 2) / 6)
        away = np.degrees(clips.angles(renormalised_average(about_x(degrees), ahead), wanted))[2:-2]
        assert least <= away.max() <= most
        exact = np.degrees(clips.angles(lee_shin(about_x(degrees), ahead), wanted))[2:-2]
        assert exact.max() < 1e-5


def test_averages_in_r4_are_level_with_lee_and_shin_on_dense_frames(pair):
    # The paper sets them aside; on motion capture there is nothing between the two.
    truth, noisy = pair
    flat, lee = (qf.metrics.mse(truth, run(noisy, MASK)) for run in (renormalised_average, lee_shin))
    assert flat == pytest.approx(lee, rel=0.02)
