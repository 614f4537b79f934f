"""Euler angles against SciPy's intrinsic rotations."""

import itertools

import clips
import numpy as np
import pytest
import tolerances
from scipy.spatial.transform import Rotation

pytestmark = pytest.mark.parametrize("axes", ["".join(order) for order in itertools.permutations("XYZ")])


def test_from_euler_is_intrinsic(backend, axes):
    a = np.random.default_rng(0).uniform(-60, 60, (2000, 3))
    expected = Rotation.from_euler(axes, a).as_quat(scalar_first=True)
    assert clips.angles(expected, backend.from_euler(a, axes)).max() < tolerances.EULER


def test_to_euler(backend, axes):
    q = clips.random_rotations(np.random.default_rng(1), 2000)
    expected = clips.rotation(q).as_euler(axes)
    np.testing.assert_allclose(backend.to_euler(-3 * q, axes), expected, rtol=0, atol=tolerances.EULER)


@pytest.mark.parametrize("side", [-1, 1])
@pytest.mark.parametrize("off", [0, 1e-15, 1e-12, 1e-9, 1e-7, 1e-5])
def test_the_rotation_is_kept_in_and_near_a_lock(backend, axes, side, off):
    a = np.random.default_rng(2).uniform(-3, 3, (500, 3))
    a[:, 1] = side * (np.pi / 2 - off)
    q = backend.from_euler(a, axes)
    result = backend.to_euler(q, axes)
    assert clips.angles(q, backend.from_euler(result, axes)).max() < 10 * tolerances.EULER
    if off == 0:
        np.testing.assert_array_equal(result[:, 2], 0)


def test_continuous_euler_finds_the_curve_again(backend, axes):
    t = np.linspace(0, 9, 1500)[:, None]
    curve = np.stack([7 * np.sin(t), 4 * np.sin(2 * t + 1), 9 * np.cos(t)], axis=-1)
    principal = backend.to_euler(backend.from_euler(curve.reshape(-1, 3), axes), axes).reshape(curve.shape)
    assert np.abs(np.diff(principal, axis=0)).max() > 3, "the angles jump"
    principal[100:110] = np.nan
    result = backend.continuous_euler(principal, curve[0], axes)
    np.testing.assert_array_equal(np.isnan(result[:, 0, 0]), np.isnan(principal[:, 0, 0]))
    present = ~np.isnan(result[:, 0, 0])
    np.testing.assert_allclose(result[present], curve[present], rtol=0, atol=100 * tolerances.EULER)


def test_in_a_lock_the_third_angle_stays(backend, axes):
    steps = np.linspace(0, 2, 50)
    curve = np.stack([steps, np.full(50, np.pi / 2), np.full(50, 1.0)], axis=-1)[:, None]
    principal = backend.to_euler(backend.from_euler(curve[:, 0], axes), axes)[:, None]
    result = backend.continuous_euler(principal, curve[0], axes)
    np.testing.assert_allclose(result, curve, rtol=0, atol=1e-7)
