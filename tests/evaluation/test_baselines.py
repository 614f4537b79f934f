"""The filters for numbers are those that users run; each is held against another way to compute it."""

import clips as synthetic
import numpy as np
import pytest
import pywt
import quatfilt as qf
from quatfilt.evaluation import baselines
from quatfilt.evaluation.baselines import BASELINES, SETTINGS
from quatfilt.evaluation.channels import VIEWS
from scipy import signal

FPS = 120.0


@pytest.fixture(name="numbers")
def noisy_waves():
    rng = np.random.default_rng(0)
    t = np.arange(150)[:, None] / FPS
    return np.sin(2 * np.pi * t * [1.0, 2.0, 3.0]) + 0.1 * rng.standard_normal((150, 3))


def only(sweep, numbers, setting):
    (result,) = sweep(numbers, [setting], FPS)
    return result


@pytest.mark.parametrize("baseline", BASELINES, ids=lambda baseline: baseline.name)
def test_every_grid_has_as_many_settings_and_each_gives_a_result(baseline, numbers):
    for fps in (120.0, 30.0):
        grid = baseline.grid(fps)
        assert len(set(grid)) == SETTINGS
        results = list(baseline.sweep(numbers, grid, fps))
        assert [result.shape for result in results] == [numbers.shape] * SETTINGS
        assert np.isfinite(results).all()


@pytest.mark.parametrize("baseline", BASELINES, ids=lambda baseline: baseline.name)
def test_a_constant_stays_and_the_input_is_not_written(baseline, numbers):
    flat = np.full((40, 2), 3.0)
    for result in baseline.sweep(flat, baseline.grid(FPS), FPS):
        assert result == pytest.approx(flat, abs=1e-9)
    before = numbers.copy()
    list(baseline.sweep(numbers, baseline.grid(FPS), FPS))
    assert np.array_equal(numbers, before)


@pytest.mark.parametrize("baseline", BASELINES, ids=lambda baseline: baseline.name)
@pytest.mark.parametrize("frames", [2, 3, 4, 9, 37])
def test_short_clips_are_filtered_too(baseline, frames):
    numbers = np.random.default_rng(1).standard_normal((frames, 2))
    for result in baseline.sweep(numbers, baseline.grid(FPS), FPS):
        assert result.shape == numbers.shape
        assert np.isfinite(result).all()


@pytest.mark.parametrize("window", [5, 11, 57])
def test_savgol_is_scipys(numbers, window):
    expected = signal.savgol_filter(numbers, window, 3, axis=0)
    assert only(baselines.savgol, numbers, window) == pytest.approx(expected, abs=1e-10)


def test_smooth_keys_are_blenders():
    # As Blender writes it: previous and next, averaged; the key at index 0 never counts as "second before".
    y = np.random.default_rng(2).standard_normal(12)
    expected = y.copy()
    for i in range(1, 11):
        p1, c, n1 = y[i - 1], y[i], y[i + 1]
        p2 = y[i - 2] if i - 2 > 0 else p1
        n2 = y[i + 2] if i + 2 < 12 else n1
        previous = (3 * p2 + 5 * p1 + 2 * c + n1 + n2) / 12
        following = (p2 + p1 + 2 * c + 5 * n1 + 3 * n2) / 12
        expected[i] = (previous + following) / 2
    assert only(baselines.blender, y[:, None], 1)[:, 0] == pytest.approx(expected, abs=1e-14)
    twice = only(baselines.blender, only(baselines.blender, y[:, None], 1), 1)
    assert only(baselines.blender, y[:, None], 2) == pytest.approx(twice, abs=1e-14)


def test_the_kalman_smoother_is_the_most_likely_path(numbers):
    ratio = 300.0
    frames = len(numbers)
    acceleration = ratio / FPS**2
    # x_t = x_0 + t·v_0 + Σ_s (t − s − ½)·a_s, a_s ~ N(0, acceleration²), measured with deviation 1.
    t, s = np.arange(frames)[:, None], np.arange(frames - 1)[None]
    reach = np.where(s < t, t - s - 0.5, 0.0)
    design = np.hstack([np.ones((frames, 1)), t, reach])
    prior = np.r_[0.0, 1 / baselines._UNKNOWN, np.full(frames - 1, acceleration**-2.0)]
    # Nothing is known of the first place.
    solved = np.linalg.solve(design.T @ design + np.diag(prior), design.T @ numbers)
    smoothed = only(baselines.kalman_smoother, numbers, ratio)
    assert smoothed == pytest.approx(design @ solved, abs=1e-6)
    assert only(baselines.kalman_forward, numbers, ratio)[-1] == pytest.approx(smoothed[-1], abs=1e-12)


def test_the_kalman_filter_does_not_look_ahead(numbers):
    later = numbers.copy()
    later[100:] += 5
    results = [only(baselines.kalman_forward, each, 500.0) for each in (numbers, later)]
    assert np.array_equal(results[0][:100], results[1][:100])
    assert not np.allclose(results[0][100:], results[1][100:])


def test_the_kalman_grid_has_its_half_gain_at_the_cutoffs():
    time = np.arange(4000) / FPS
    for cutoff, ratio in zip(baselines.cutoffs(FPS), baselines._kalman_grid(FPS), strict=True):
        if not 2 < cutoff < 20:
            continue
        wave = np.sin(2 * np.pi * cutoff * time)[:, None]
        # Far from the ends, the smoother is 1 / (1 + (2 sin(π f/fps))⁴ / a²) up to the shape of its discrete noise.
        gain = np.abs(only(baselines.kalman_smoother, wave, ratio)[1000:3000]).max()
        assert gain == pytest.approx(0.5, abs=0.1)


def test_wavelet_shrinkage_with_a_huge_threshold_leaves_the_coarse_part(numbers):
    coarse, *details = pywt.wavedec(numbers, "sym8", axis=0)
    expected = pywt.waverec([coarse, *(0 * d for d in details)], "sym8", axis=0)[: len(numbers)]
    assert only(baselines.wavelet, numbers, 1e6) == pytest.approx(expected, abs=1e-12)


def test_wavelet_threshold_is_universal():
    white = np.random.default_rng(3).standard_normal((4096, 1))
    coarse, *_ = pywt.wavedec(white, "sym8", axis=0)
    shrunk = only(baselines.wavelet, white, 1.0)
    # Almost nothing of white noise is above it.
    assert np.sum(shrunk**2) < 1.2 * np.sum(coarse**2)
    assert np.sum(only(baselines.wavelet, white, 0.25) ** 2) > 10 * np.sum(shrunk**2)


@pytest.mark.parametrize("view", VIEWS)
def test_views_give_back_what_they_were_given(view):
    rng = np.random.default_rng(4)
    q = synthetic.flipped(rng, synthetic.turning(rng, 200, 3, turns=0.7))
    channels = VIEWS[view](q)
    assert qf.geodesic_distance(channels.rotations(channels.values), q).max() < 1e-12
    # No jumps: the numbers move as slowly as the rotations do.
    assert np.abs(np.diff(channels.values, axis=0)).max() < 0.5


def test_the_kalman_smoother_goes_from_the_samples_to_a_straight_line():
    numbers = np.random.default_rng(5).standard_normal((60, 1))
    assert only(baselines.kalman_smoother, numbers, 1e9) == pytest.approx(numbers, abs=1e-3)
    line = np.polynomial.Polynomial.fit(np.arange(60), numbers[:, 0], 1)(np.arange(60))
    assert only(baselines.kalman_smoother, numbers, 1e-4)[:, 0] == pytest.approx(line, abs=1e-3)
