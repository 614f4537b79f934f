"""Euler angles: the core against the reference."""

import itertools

import numpy as np
import pytest
import tolerances
from quatfilt import _core, _reference

pytestmark = pytest.mark.parametrize("axes", ["".join(order) for order in itertools.permutations("XYZ")])


def angles(seed=0, count=5003):
    rng = np.random.default_rng(seed)
    result = rng.uniform(-60, 60, (count, 3))
    result[::7, 1] = np.pi / 2
    result[1::7, 1] = -np.pi / 2
    result[2::7, 1] = np.pi / 2 + 1e-9 * rng.standard_normal(len(result[2::7]))
    result[3::50] = 0
    result[4::50, 2] = np.nan
    result[5::500] *= 1e6
    return result


@pytest.mark.parametrize("count", [0, 1, 63, 64, 65, 5003, 40_000])
def test_from_euler(axes, count):
    a = angles(count=count)
    np.testing.assert_allclose(
        _core.from_euler(a, axes), _reference.from_euler(a, axes), rtol=0, atol=tolerances.ALGEBRA
    )


@pytest.mark.parametrize("count", [0, 1, 63, 64, 65, 5003, 40_000])
def test_to_euler(axes, count):
    q = np.random.default_rng(1).standard_normal((count, 4))
    q[::9] = 0
    q[1::9, 2] = np.nan
    result, expected = _core.to_euler(q, axes), _reference.to_euler(q, axes)
    np.testing.assert_allclose(result, expected, rtol=0, atol=tolerances.EULER)
    assert np.isnan(result).all(axis=1).sum() == len(q[::9]) + len(q[1::9])


def test_to_euler_in_a_lock(axes):
    q = _core.from_euler(angles(), axes)
    result, expected = _core.to_euler(q, axes), _reference.to_euler(q, axes)
    difference = _core.geodesic_distance(_core.from_euler(result, axes), _core.from_euler(expected, axes))
    assert np.nanmax(difference) < tolerances.EULER
    np.testing.assert_array_equal(np.isnan(result), np.isnan(expected))


def test_continuous_euler(axes):
    a = angles()[:5000].reshape(1000, 5, 3)
    start = np.array(a[:5, 1])
    start[2] = np.nan
    result = _core.continuous_euler(a, start, axes)
    np.testing.assert_allclose(result, _reference.continuous_euler(a, start, axes), rtol=0, atol=1e-7)
