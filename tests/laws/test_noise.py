"""What must hold for estimated noise levels."""

import clips
import noise
import numpy as np
import tolerances
from hypothesis import given
from hypothesis import strategies as st

seeds = st.integers(0, 2**32 - 1)


def sample(seed):
    rng = np.random.default_rng(seed)
    return clips.noisy(rng, clips.smooth(rng, 60, 3), 0.05), rng


@given(seed=seeds)
def test_it_does_not_depend_on_signs_nor_on_the_frame_of_the_world_or_of_the_body(backend, seed):
    q, rng = sample(seed)
    level = backend.noise_level(q)
    np.testing.assert_array_equal(backend.noise_level(clips.flipped(rng, q)), level)
    left = clips.random_rotations(rng, 3)
    np.testing.assert_allclose(backend.noise_level(clips.product(left, q)), level, atol=tolerances.FLOAT64)
    # A median per coordinate knows the axes of the body: they may be exchanged, not turned.
    cyclic = np.array([0.5, 0.5, 0.5, 0.5])
    np.testing.assert_allclose(backend.noise_level(clips.product(q, cyclic)), level, atol=tolerances.FLOAT64)


@given(seed=seeds)
def test_it_grows_with_the_noise(backend, seed):
    vectors = np.random.default_rng(seed).standard_normal((60, 3, 1)) * np.array([0.6, 0, 0.8])
    small, large = (backend.noise_level(clips.from_vectors(s * vectors)) for s in (1e-3, 4e-3))
    np.testing.assert_allclose(large, 4 * small, rtol=tolerances.FLOAT64 / 1e-3)


@given(seed=seeds)
def test_missing_samples_do_not_spread(backend, seed):
    q, rng = sample(seed)
    gaps = q.copy()
    gaps[30:34, 1] = np.where(rng.random((4, 1)) < 0.5, np.nan, 0)
    level, with_gaps = backend.noise_level(q), backend.noise_level(gaps)
    np.testing.assert_array_equal(with_gaps[[0, 2]], level[[0, 2]])
    assert 0.5 < with_gaps[1] / level[1] < 2


def test_smooth_constant_and_short_clips_have_no_noise(backend):
    rng = np.random.default_rng(0)
    constant = np.tile(clips.random_rotations(rng, 2), (50, 1, 1))
    assert (backend.noise_level(constant) < tolerances.ALGEBRA).all()
    assert (backend.noise_level(clips.smooth(rng, 500, 5)) < 1e-6).all()
    for frames in range(6):
        np.testing.assert_array_equal(backend.noise_level(clips.random_rotations(rng, frames, 2)), [0, 0])
    assert (backend.noise_level(clips.random_rotations(rng, 6, 2)) > 0).all()
    np.testing.assert_array_equal(backend.noise_level(np.full((50, 2, 4), np.nan)), [0, 0])


def test_float32(backend):
    q, _ = sample(0)
    level = backend.noise_level(q.astype(np.float32))
    assert level.dtype == np.float32
    np.testing.assert_allclose(level, backend.noise_level(q), rtol=0, atol=tolerances.FLOAT32)


# ---- paths


@given(seed=seeds)
def test_of_a_path_it_does_not_depend_on_its_place_nor_on_the_order_of_coordinates(backend, seed):
    rng = np.random.default_rng(seed)
    path = clips.path(rng, 80)
    level = noise.of_path(backend, path)
    assert level > 0
    for other in (path + np.array([1e3, -20, 7]), path[:, [2, 0, 1]], -path, path[::-1]):
        np.testing.assert_allclose(noise.of_path(backend, other), level, rtol=1e-9)
    np.testing.assert_allclose(noise.of_path(backend, 100 * path), 100 * level, rtol=tolerances.FLOAT64)


def test_smooth_and_short_paths_have_no_noise(backend):
    time = np.linspace(0, 1, 60)[:, None]
    assert noise.of_path(backend, 3 + time * np.array([5.0, 0, -2])) < tolerances.ALGEBRA
    assert noise.of_path(backend, np.sin(3 * time + np.array([0.0, 1, 2]))) < 1e-9
    for frames in range(6):
        assert noise.of_path(backend, clips.path(np.random.default_rng(0), frames)) == 0
    assert noise.of_path(backend, clips.path(np.random.default_rng(0), 6)) > 0
    assert noise.of_path(backend, np.full((60, 3), np.nan)) == 0


@given(seed=seeds)
def test_missing_places_do_not_spread(backend, seed):
    rng = np.random.default_rng(seed)
    path = rng.standard_normal((200, 3))
    gaps = path.copy()
    gaps[rng.random(200) < 0.05] = np.nan
    assert 0.6 < noise.of_path(backend, gaps) / noise.of_path(backend, path) < 1.6


def test_a_path_in_float32(backend):
    path = clips.path(np.random.default_rng(1), 500)
    level = noise.of_path(backend, path)
    np.testing.assert_allclose(noise.of_path(backend, path.astype(np.float32)), level, rtol=1e-4)
