"""Karcher means against SciPy's chordal mean and against the condition for a minimum."""

import clips
import numpy as np
import pytest
import tolerances


def gradient(mean, q, weights):
    """Weighted mean of the rotation vectors that lead from the mean to the samples."""
    vectors = (clips.rotation(mean).inv() * clips.rotation(q)).as_rotvec()
    return np.average(vectors, axis=0, weights=weights)


@pytest.mark.parametrize("spread", [0.01, 0.5, 1.5])
@pytest.mark.parametrize("weighted", [False, True])
def test_the_logarithms_cancel_at_the_mean(backend, spread, weighted):
    rng = np.random.default_rng(0)
    q = clips.noisy(rng, np.tile(clips.random_rotations(rng, 3), (200, 1, 1)), spread)
    weights = rng.random((200, 3)) if weighted else None
    result = backend.mean(clips.flipped(rng, q), weights)
    for joint in range(3):
        given = weights[:, joint] if weighted else None
        assert np.linalg.norm(gradient(result[joint], q[:, joint], given)) < tolerances.KARCHER_MEAN


def test_of_a_small_cloud_it_is_near_the_chordal_mean(backend):
    rng = np.random.default_rng(1)
    spread = 1e-3
    q = clips.noisy(rng, np.tile(clips.random_rotations(rng, 1), (100, 1, 1)), spread)
    chordal = clips.rotation(q).mean().as_quat(scalar_first=True)
    assert clips.angles(backend.mean(q, None)[0], chordal) < spread**3


def test_of_two_rotations_it_is_half_way(backend):
    a, b = clips.random_rotations(np.random.default_rng(2), 2, 50)
    result = backend.mean(np.stack([a, b]), None)
    np.testing.assert_allclose(clips.angles(a, result), clips.angles(a, b) / 2, atol=tolerances.KARCHER_MEAN)
    np.testing.assert_allclose(clips.angles(b, result), clips.angles(a, b) / 2, atol=tolerances.KARCHER_MEAN)


def test_about_one_axis_it_is_the_mean_angle(backend):
    angle = np.random.default_rng(3).uniform(-1.5, 1.4, 300)
    q = clips.from_vectors(angle[:, None, None] * np.array([0.6, 0, 0.8]))
    expected = clips.from_vectors(angle.mean() * np.array([0.6, 0, 0.8]))
    assert clips.angles(backend.mean(q, None)[0], expected) < tolerances.KARCHER_MEAN
