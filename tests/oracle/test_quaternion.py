"""The algebra of quaternions against SciPy's rotations."""

import clips
import numpy as np
import pytest
import tolerances

pytestmark = pytest.mark.parametrize("dtype", [np.float32, np.float64])


def samples(dtype, seed=0, count=2000):
    q = clips.random_rotations(np.random.default_rng(seed), count)
    return clips.flipped(np.random.default_rng(seed + 1), q).astype(dtype)


def test_log_is_half_the_rotation_vector(backend, dtype):
    q = np.abs(samples(dtype)[:, :1]) * [1, 0, 0, 0] + samples(dtype) * [0, 1, 1, 1]
    expected = clips.rotation(q).as_rotvec() / 2
    result = backend.log(q.astype(dtype))
    assert result.dtype == dtype
    np.testing.assert_allclose(result, expected, rtol=0, atol=tolerances.algebra(dtype))


def test_log_of_the_other_sign_goes_the_other_way_round(backend, dtype):
    q = samples(dtype)
    there, back = backend.log(q), backend.log(-q)
    lengths = np.linalg.norm(there, axis=1) + np.linalg.norm(back, axis=1)
    np.testing.assert_allclose(lengths, np.pi, rtol=0, atol=2 * tolerances.algebra(dtype))


def test_log_of_small_and_special_rotations(backend, dtype):
    v = np.array([[1e-3, 0, 0], [0, 1e-9, 0], [0, 0, 1e-18], [1e-30, 0, 0], [0, 0, 0]])
    q = np.concatenate([np.ones((5, 1)), v], axis=1).astype(dtype)
    np.testing.assert_allclose(backend.log(q), np.arctan(v), rtol=tolerances.algebra(dtype), atol=0)
    np.testing.assert_array_equal(
        backend.log(np.array([[-1, 0, 0, 0]], dtype)), np.array([[np.pi, 0, 0]], dtype)
    )


def test_exp(backend, dtype):
    v = (np.random.default_rng(2).standard_normal((2000, 3)) * 3).astype(dtype)
    result = backend.exp(v)
    assert result.dtype == dtype
    angle = np.linalg.norm(v.astype(np.float64), axis=1)
    np.testing.assert_allclose(result[:, 0], np.cos(angle), rtol=0, atol=4 * tolerances.algebra(dtype))
    error = clips.angles(clips.from_vectors(2 * v.astype(np.float64)), result)
    assert error.max() < 8 * tolerances.algebra(dtype)


def test_multiply(backend, dtype):
    a, b = samples(dtype, 3), samples(dtype, 5)
    assert clips.angles(clips.product(a, b), backend.multiply(a, b)).max() < tolerances.algebra(dtype)


def test_multiply_keeps_signs(backend, dtype):
    i, j, k = np.eye(4, dtype=dtype)[1:]
    np.testing.assert_array_equal(backend.multiply(np.array([i, j, k]), np.array([j, k, i])), [k, i, j])
    np.testing.assert_array_equal(
        backend.multiply(np.array([i, j, k]), np.array([i, j, k])), -np.eye(4)[[0, 0, 0]]
    )


def test_conjugate_and_normalize(backend, dtype):
    q = samples(dtype)
    np.testing.assert_array_equal(backend.conjugate(q), q * np.array([1, -1, -1, -1], dtype))
    scaled = q * np.random.default_rng(1).uniform(0.1, 9, (len(q), 1)).astype(dtype)
    np.testing.assert_allclose(backend.normalize(scaled), q, rtol=0, atol=tolerances.algebra(dtype))


def test_geodesic_distance(backend, dtype):
    a, b = samples(dtype, 7), samples(dtype, 9)
    b[:500] = a[:500]
    b[500:1000] = clips.product(a[500:1000], clips.from_vectors(np.full((500, 3), 1e-4)))
    b[1000:1100] = clips.product(a[1000:1100], [0.0, 1, 0, 0])
    result = backend.geodesic_distance(a, b)
    assert result.dtype == dtype
    np.testing.assert_allclose(result, clips.angles(a, b), rtol=0, atol=2 * tolerances.algebra(dtype))
