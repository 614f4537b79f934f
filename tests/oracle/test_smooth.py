"""Automatic smoothing against SciPy: its solvers, its cosine transform, its Gaussians, and the errors that the risk foretells."""

import itertools

import clips
import numpy as np
import pytest
import quatfilt as qf
import tolerances
from quatfilt._reference.filters.smooth import strength as strengths
from quatfilt._reference.filters.smooth.penalised import penalised
from quatfilt._reference.filters.smooth.strength import block_scores, candidates, cosine_transform, strength
from scipy import fft, linalg, stats
from scipy.ndimage import gaussian_filter1d
from scipy.spatial.transform import Rotation

AXIS = np.array([2.0, -1, 2]) / 3


def differences(frames, order):
    """The matrix of differences of an order."""
    return np.diff(np.eye(frames), n=order, axis=0)


def normal_matrix(weights, softness, order):
    """Of the least squares problem as it is usually written: `W + Dᵀ S⁻¹ D`."""
    steps = differences(len(weights), order)
    return np.diag(weights) + steps.T @ (steps / softness[:, None])


def solved_by_scipy(z, weights, softness, order):
    """The usual form with SciPy's solver for banded matrices."""
    matrix = normal_matrix(weights, softness, order)
    bands = np.zeros((order + 1, len(z)))
    for k in range(order + 1):
        bands[k, : len(z) - k] = np.diagonal(matrix, -k)
    return linalg.solveh_banded(bands, weights * z, lower=True)


# ---- penalised least squares


@pytest.mark.parametrize("order", [1, 2, 3])
@pytest.mark.parametrize("frames", [4, 5, 9, 60, 700])
def test_penalised_least_squares(frames, order):
    rng = np.random.default_rng(frames)
    z = np.cumsum(rng.standard_normal(frames))
    weights = rng.uniform(0.01, 1, frames)
    softness = np.exp(rng.uniform(-6, 5, frames - order))
    result = penalised(z, weights, softness, order)
    expected = linalg.solve(normal_matrix(weights, softness, order), weights * z, assume_a="pos")
    # Conditions of the usual form: up to 1e7 here.
    np.testing.assert_allclose(result, expected, rtol=0, atol=1e-9 * np.abs(z).max())
    np.testing.assert_allclose(
        result, solved_by_scipy(z, weights, softness, order), rtol=0, atol=1e-9 * np.abs(z).max()
    )


@pytest.mark.parametrize("order", [1, 2, 3])
def test_reinsch_form_keeps_its_digits_where_the_usual_one_loses_them(order):
    """A polynomial that is not penalised, and the least softness that is ever used."""
    z = np.polynomial.Polynomial([3.0, -1, 2][:order])(np.linspace(-1, 1, 600))
    softness = np.full(600 - order, strengths.STIFFEST)
    np.testing.assert_allclose(penalised(z, np.ones(600), softness, order), z, rtol=0, atol=1e-10)


@pytest.mark.parametrize("cutoff", [1e-4, 0.03, 1.0, 64.0])
def test_first_differences_are_a_filter_of_the_cosine_transform(cutoff):
    """Which is what the risk takes every order for: exactly so for the first."""
    z = np.random.default_rng(0).standard_normal(200)
    mu = 2 - 2 * np.cos(np.pi * np.arange(200) / 200)
    expected = fft.idct(fft.dct(z, norm="ortho") / (1 + mu / cutoff), norm="ortho")
    result = penalised(z, np.ones(200), np.full(199, cutoff), 1)
    np.testing.assert_allclose(result, expected, rtol=0, atol=tolerances.FLOAT64)


@pytest.mark.parametrize("order", [2, 3])
@pytest.mark.parametrize("period", [12, 40, 90])
def test_of_a_sine_far_from_the_ends_as_much_is_left_as_the_risk_counts_on(period, order):
    cutoff = 0.02
    sine = np.sin(2 * np.pi * np.arange(2001) / period)
    left = penalised(sine, np.ones(2001), np.full(2001 - order, cutoff**order), order)
    expected = 1 / (1 + ((2 - 2 * np.cos(2 * np.pi / period)) / cutoff) ** order)
    np.testing.assert_allclose(left[700:-700], expected * sine[700:-700], rtol=0, atol=1e-8)


# ---- how strongly


@pytest.mark.parametrize("frames", [1, 2, 3, 64, 100, 512])
def test_cosine_transform(frames):
    x = np.random.default_rng(frames).standard_normal(frames)
    np.testing.assert_allclose(cosine_transform(x), fft.dct(x, norm="ortho"), rtol=0, atol=tolerances.FLOAT64)


BLOCK = 256
DRAWS = 4000


def motion():
    """What lies under the noise: slow waves, in units of the noise, without a mean."""
    time = np.arange(BLOCK) / BLOCK
    x = 6 * np.sin(2 * np.pi * 1.3 * time + 0.4) + 2 * np.sin(2 * np.pi * 5.1 * time) + 3 * time
    return x - x.mean()


def left(order, cutoff):
    """`h`, of each frequency but the lowest, which stands for the mean."""
    mu = 2 - 2 * np.cos(np.pi * np.arange(1, BLOCK) / BLOCK)
    return 1 / (1 + (mu / cutoff) ** order)


def test_the_risk_is_the_mean_error(monkeypatch):
    """Stein: what is known without the truth has the mean of the squared error, but for the number of frequencies."""
    monkeypatch.setattr(strengths, "LIKELIHOOD", 0.0)
    found = candidates(BLOCK)
    truth = fft.dct(motion(), norm="ortho")[1:]
    rng = np.random.default_rng(1)
    draws = motion() + rng.standard_normal((DRAWS, BLOCK))
    transforms = fft.dct(draws, norm="ortho")[:, 1:]
    risks = np.mean([block_scores(z, found) for z in draws], axis=0) * strengths.TEMPERATURE
    for place, order in enumerate(strengths.ORDERS):
        for candidate in range(0, strengths.CUTOFFS, 3):
            cutoff = found.cutoffs[place, candidate]
            h = left(order, cutoff)
            error = np.mean(np.sum((h * transforms - truth) ** 2, axis=1))
            mean = 1 / (1 + ((2 - 2 * np.cos(np.pi / BLOCK)) / 4 / cutoff) ** order)
            foretold = risks[place, candidate] - 2 * mean - (BLOCK - 1)
            assert abs(foretold - error) < tolerances.RISK_BIAS * BLOCK + 0.02 * error, (order, cutoff)


def test_the_likelihood_is_that_of_normal_numbers(monkeypatch):
    """If the differences are white noise, a cosine has the variance `1 / (1 − h)`."""
    monkeypatch.setattr(strengths, "TEMPERATURE", np.inf)
    monkeypatch.setattr(strengths, "LIKELIHOOD", 1.0)
    # Each frequency has a bin of its own.
    monkeypatch.setattr(strengths, "FINE_BINS", BLOCK)
    found = candidates(BLOCK)
    z = motion() + np.random.default_rng(2).standard_normal(BLOCK)
    scores = block_scores(z, found)
    transform = fft.dct(z - z.mean(), norm="ortho")
    mu = 2 - 2 * np.cos(np.pi * np.arange(BLOCK) / BLOCK)
    mu[0] = mu[1] / 4
    for place, order in enumerate(strengths.ORDERS):
        for candidate in (0, 7, 17):
            ratio = (mu / found.cutoffs[place, candidate]) ** order
            density = stats.norm.logpdf(transform, scale=np.sqrt((1 + ratio) / ratio)).sum()
            constant = -BLOCK * np.log(2 * np.pi) / 2
            assert scores[place, candidate] == pytest.approx(constant - density, rel=1e-10)


@pytest.mark.parametrize("sigma", [0.1, 0.5, 2.0])
def test_what_is_chosen_errs_little_more_than_the_best_candidate(sigma):
    """Waves in noise that end level, as cosines do: beside that candidate whose mean error is least, which nobody knows."""
    rng = np.random.default_rng(3)
    time = np.pi * (np.arange(BLOCK) + 0.5) / BLOCK
    clean = (4 * np.cos(2 * time) + 3 * np.cos(5 * time) + np.cos(11 * time)) / sigma
    draws = clean + rng.standard_normal((25, BLOCK))
    errors = []
    for order, cutoffs in zip(strengths.ORDERS, candidates(BLOCK).cutoffs, strict=True):
        for cutoff in cutoffs[cutoffs**order > 1e-7]:
            matrix = normal_matrix(np.ones(BLOCK), np.full(BLOCK - order, cutoff**order), order)
            errors.append(np.sum((linalg.solve(matrix, draws.T).T - clean) ** 2))
    chosen = 0.0
    for z in draws:
        pick = strength(z)
        softness = pick.cutoff[: BLOCK - pick.order] ** pick.order
        chosen += np.sum((penalised(z, np.ones(BLOCK), softness, pick.order) - clean) ** 2)
    assert chosen < 1.4 * min(errors)


# ---- rotations


def smoothed_numbers(column, noise, weights=None):
    """A column of numbers, smoothed by SciPy as strongly as the reference asks for."""
    z = column / noise
    pick = strength(z)
    middle = pick.order // 2
    softness = pick.cutoff[middle : middle + len(z) - pick.order] ** pick.order
    weights = np.ones(len(z)) if weights is None else weights
    return noise * solved_by_scipy(z, weights, softness, pick.order)


def smoothed_vectors(vectors, noise):
    """Two rounds along the principal axes of the steps of a mean, with SciPy, of vectors `(frames, 3)`."""
    mean = gaussian_filter1d(vectors, 10, axis=0, mode="mirror")
    for _ in range(2):
        axes = linalg.svd(np.diff(mean, axis=0), full_matrices=False)[2]
        mean = np.stack([smoothed_numbers(column, noise) for column in axes @ vectors.T], axis=1) @ axes
    return mean


@pytest.mark.parametrize("frames", [30, 300, 1000])
def test_angles_about_one_axis_are_smoothed_as_numbers(backend, frames):
    """However far they turn."""
    rng = np.random.default_rng(4)
    angle = 0.05 * np.arange(frames) + np.sin(np.arange(frames) / 15) + rng.normal(0, 0.15, frames)
    result, _ = backend.smooth(
        clips.from_vectors(angle[:, None, None] * AXIS), None, None, np.array([0.15]), 0.0
    )
    expected = clips.from_vectors(smoothed_numbers(angle, 0.15)[:, None, None] * AXIS)
    assert clips.angles(result, expected).max() < 1e-7


def test_weights_are_those_of_least_squares(backend):
    rng = np.random.default_rng(5)
    angle = np.sin(np.arange(200) / 15) + rng.normal(0, 0.15, 200)
    trust = clips.confidences(rng, 200, 1)
    q = clips.from_vectors(angle[:, None, None] * AXIS)
    result, _ = backend.smooth(q, None, trust, np.array([0.15]), 0.0)
    expected = smoothed_numbers(angle, 0.15, np.maximum(trust[:, 0], 0.01))
    assert clips.angles(result, clips.from_vectors(expected[:, None, None] * AXIS)).max() < 1e-7


def test_small_rotation_vectors_are_smoothed_alike(backend):
    """What differs are commutators, products of two angles: half the angles leave half of the relative difference."""
    rng = np.random.default_rng(6)
    wave = np.sin(np.arange(300)[:, None] / np.array([9.0, 13, 17])) + rng.normal(0, 0.3, (300, 3))
    errors = []
    for scale in (0.08, 0.04, 0.02):
        vectors = scale * wave
        q = clips.from_vectors(vectors[:, None])
        result, _ = backend.smooth(q, None, None, np.array([0.3 * scale]), 0.0)
        expected = Rotation.from_rotvec(smoothed_vectors(vectors, 0.3 * scale))
        errors.append((expected.inv() * clips.rotation(result)).magnitude().max() / scale)
    assert errors[0] < 0.02
    for before, after in itertools.pairwise(errors):
        assert after < before / 1.6


def test_the_translation_is_smoothed_as_vectors(backend):
    rng = np.random.default_rng(7)
    path = np.sin(np.arange(700)[:, None] / np.array([19.0, 43, 97])) + rng.normal(0, 0.1, (700, 3))
    still = np.tile([1.0, 0, 0, 0], (700, 1, 1))
    _, moved = backend.smooth(still, path, None, np.zeros(1), 0.1)
    np.testing.assert_allclose(moved, smoothed_vectors(path, 0.1), rtol=0, atol=1e-8)


def test_the_body_is_smoothed_as_one_long_vector(backend):
    """Small vectors of three joints about a pilot, in units of their noise, along the axes of its steps."""
    rng = np.random.default_rng(8)
    waves = np.sin(np.arange(300)[:, None] / np.array([9.0, 13, 17]))
    clean = 1e-6 * (waves @ rng.standard_normal((3, 9))).reshape(300, 3, 3)
    noise = 1e-6 * np.array([0.1, 0.2, 0.4])
    vectors = clean + noise[:, None] * rng.standard_normal((300, 3, 3))
    about = gaussian_filter1d(vectors, 3, axis=0, mode="mirror")
    result = backend.smooth_body(clips.from_vectors(vectors), clips.from_vectors(about), None, noise)
    poses, pilot = ((x / noise[:, None]).reshape(300, 9) for x in (vectors, about))
    axes = linalg.svd(np.diff(pilot, axis=0), full_matrices=False)[2]
    smooth = np.stack([smoothed_numbers(column, 1.0) for column in axes @ poses.T], axis=1) @ axes
    expected = ((pilot + smooth) / 2).reshape(300, 3, 3) * noise[:, None]
    assert clips.angles(result, clips.from_vectors(expected)).max() < 1e-3 * noise.min()


def test_the_strength_is_a_factor_of_the_estimated_noise(backend):
    rng = np.random.default_rng(9)
    q = clips.noisy(rng, clips.smooth(rng, 200, 3), 0.05)
    for factor in (0.5, 1.0, [0.2, 1.0, 3.0]):
        expected, _ = backend.smooth(q, None, None, factor * backend.noise_level(q), 0.0)
        np.testing.assert_array_equal(qf.smooth(q, strength=factor), expected)
