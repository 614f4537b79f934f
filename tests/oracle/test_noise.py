"""The noise level against the noise that was added."""

import clips
import noise
import numpy as np
import pytest
import tolerances

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
