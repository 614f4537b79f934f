"""The noise level against the noise that was added."""

import clips
import noise
import numpy as np
import pytest
import tolerances
from quatfilt._reference.noise.coherence import coherence, noise_of
from scipy.spatial.transform import Rotation

SIGMA = 0.016
MANY = 400
"""Joints whose mean is taken: its deviation is a twentieth of one joint's."""


@pytest.mark.parametrize("frames", [30, 120, 1000])
def test_white_noise(backend, frames):
    rng = np.random.default_rng(0)
    q = clips.noisy(rng, np.tile([1.0, 0, 0, 0], (frames, MANY, 1)), SIGMA)
    assert abs(backend.noise_level(q).mean() / SIGMA - 1) < tolerances.WHITE_NOISE_LEVEL


@pytest.mark.parametrize("fps", [30, 120])
def test_a_fast_swing_does_not_count_as_noise(backend, fps):
    rng = np.random.default_rng(1)
    angle = np.radians(60) * np.sin(2 * np.pi * 3 * np.arange(600) / fps)
    swing = clips.from_vectors(angle[:, None, None] * np.array([0.6, 0.0, 0.8]))
    q = clips.noisy(rng, np.repeat(swing, 50, axis=1), SIGMA)
    assert abs(backend.noise_level(q).mean() / SIGMA - 1) < tolerances.WHITE_NOISE_LEVEL


def test_of_one_coordinate_alone(backend):
    rng = np.random.default_rng(2)
    vectors = SIGMA * rng.standard_normal((2000, 20, 3)) * np.array([1.0, 0, 0])
    expected = SIGMA / np.sqrt(3)
    assert (
        abs(backend.noise_level(clips.from_vectors(vectors)).mean() / expected - 1)
        < tolerances.WHITE_NOISE_LEVEL
    )


@pytest.mark.parametrize("scale", [1e-3, 40.0])
def test_of_a_path_that_wanders(backend, scale):
    rng = np.random.default_rng(3)
    time = np.arange(20_000)[:, None] / 120
    path = scale * np.sin(time * np.array([1.0, 2, 3])) + scale * rng.normal(0, SIGMA, (20_000, 3))
    assert abs(noise.of_path(backend, path) / (scale * SIGMA) - 1) < tolerances.WHITE_NOISE_LEVEL


def test_of_a_path_it_is_what_the_level_of_small_rotations_is(backend):
    rng = np.random.default_rng(4)
    vectors = 1e-5 * (
        np.sin(np.arange(300)[:, None] / np.array([9.0, 13, 17])) + rng.normal(0, 0.1, (300, 3))
    )
    level = backend.noise_level(clips.from_vectors(vectors[:, None]))[0]
    assert abs(noise.of_path(backend, vectors) / level - 1) < 1e-4


# ---- heavy noise


@pytest.mark.parametrize("sigma", [0.1, 0.5, 0.8, 1.2, 1.6])
def test_coherence_is_the_length_of_the_mean_rotation(sigma):
    vectors = np.random.default_rng(5).normal(0, sigma, (200_000, 3))
    mean = Rotation.from_rotvec(vectors).as_matrix().mean(axis=0)
    np.testing.assert_allclose(mean, coherence(np.array(sigma)) * np.eye(3), atol=0.005)
    np.testing.assert_allclose(noise_of(coherence(np.array(sigma))), sigma, rtol=1e-6)


@pytest.mark.parametrize("sigma", [0.24, 0.26, 0.48, 0.8, 1.2])
@pytest.mark.parametrize("frames", [200, 1000])
def test_noise_that_wraps(backend, sigma, frames):
    """At 1.2 rad one sample in thirteen is turned by more than half a turn."""
    rng = np.random.default_rng(6)
    q = clips.noisy(rng, np.tile([1.0, 0, 0, 0], (frames, MANY // 4, 1)), sigma)
    assert abs(backend.noise_level(q).mean() / sigma - 1) < tolerances.WHITE_NOISE_LEVEL


@pytest.mark.parametrize("sigma", [0.3, 0.8])
def test_motion_does_not_count_as_heavy_noise(backend, sigma):
    """It turns by up to 12 degrees from frame to frame, beside which it would be a third too much in light noise."""
    rng = np.random.default_rng(7)
    angle = np.radians(60) * np.sin(2 * np.pi * 4 * np.arange(1000) / 120)
    swing = clips.from_vectors(angle[:, None, None] * np.array([0.6, 0.0, 0.8]))
    q = clips.noisy(rng, np.repeat(swing, 50, axis=1), sigma)
    assert abs(backend.noise_level(q).mean() / sigma - 1) < tolerances.WHITE_NOISE_LEVEL


def test_rotations_at_random_have_all_the_noise_there_is(backend):
    q = clips.random_rotations(np.random.default_rng(8), 20_000, 5)
    assert (backend.noise_level(q) > 1.4).all()
    assert (backend.noise_level(q) <= np.sqrt(3) + 1e-12).all()
