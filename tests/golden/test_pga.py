"""What the paper says of principal geodesics: Said, Courty, Le Bihan and Sangwine, EUSIPCO 2007, section 4."""

import clips
import numpy as np
import quatfilt as qf
import tolerances
from quatfilt._reference.geodesics.pga.objective import value
from quatfilt._reference.geodesics.pga.sphere import paper_start


def geodesic(axis, parameters):
    """Points ``(cos s, sin s · v)``."""
    return np.concatenate([np.cos(parameters)[:, None], np.sin(parameters)[:, None] * axis], axis=1)


def test_on_one_geodesic_equation_14_is_the_direction():
    rng = np.random.default_rng(0)
    for _ in range(20):
        axis = rng.standard_normal(3)
        axis /= np.linalg.norm(axis)
        x = geodesic(axis, rng.uniform(-1.5, 1.5, 50))
        start = paper_start(x)
        assert abs(abs(start @ axis) - 1) < tolerances.ALGEBRA
        assert value(x, start, "geodesic") < tolerances.ALGEBRA


def test_two_factors_leave_nothing_after_two_geodesics(backend):  # noqa: ARG001 - a backend
    """Products of two geodesics with symmetric spread."""
    s, t = (a.ravel() for a in np.meshgrid(np.linspace(-0.9, 0.9, 15), np.linspace(-0.35, 0.35, 11)))
    first, second = np.array([0.6, 0.0, 0.8]), np.array([0.0, 1.0, 0.0])
    q = clips.product(geodesic(first, s), geodesic(second, t))
    pga = qf.PrincipalGeodesicAnalysis(2).fit(q)
    assert pga.residuals_[0] > 0.1
    assert pga.residuals_[1] < tolerances.FLOAT64
    np.testing.assert_allclose(np.abs(pga.components_ @ np.stack([first, second]).T), np.eye(2), atol=1e-9)
    np.testing.assert_allclose(np.abs(pga.transform(q)), np.abs(2 * np.stack([s, t], axis=1)), atol=1e-9)


def test_another_surface_leaves_a_remainder(backend):  # noqa: ARG001
    """Logarithms in a plane are no products of geodesics."""
    s, t = (a.ravel() for a in np.meshgrid(np.linspace(-0.9, 0.9, 15), np.linspace(-0.35, 0.35, 11)))
    q = qf.exp(np.stack([s, t, 0 * s], axis=1))
    residuals = qf.PrincipalGeodesicAnalysis(3).fit(q).residuals_
    assert residuals[0] > residuals[1] > 0.01


def test_of_a_gaussian_the_directions_are_the_axes_of_its_concentration(backend):  # noqa: ARG001
    rng = np.random.default_rng(1)
    axes = np.linalg.qr(rng.standard_normal((3, 3)))[0].T
    logs = (rng.standard_normal((4000, 3)) * [0.4, 0.2, 0.1]) @ axes
    q = qf.exp(logs[np.linalg.norm(logs, axis=1) < 1.5])
    pga = qf.PrincipalGeodesicAnalysis(5).fit(q)
    cosines = np.abs(np.sum(pga.components_[:3] * axes, axis=1))
    assert (cosines > np.cos(np.radians(2))).all()
    assert (np.diff(pga.residuals_) < 0).all()
    assert pga.residuals_[-1] > 1e-6


def test_equation_13_belongs_to_the_chordal_objective():
    """Finite differences of the mean of ``1 − cos d``; those of the mean distance are not it."""
    rng = np.random.default_rng(2)
    x = qf.exp(rng.standard_normal((30, 3)) * [0.5, 0.2, 0.1])
    v = np.array([0.36, 0.48, 0.8])
    across = np.array([0.8, -0.6, 0.0])
    w, p = x[:, 0], x[:, 1:] @ v
    printed = -np.mean((p / np.sqrt(w**2 + p**2))[:, None] * x[:, 1:], axis=0) @ across
    step = 1e-5

    def difference(objective):
        ends = [np.cos(step) * v + sign * np.sin(step) * across for sign in (1, -1)]
        return (value(x, ends[0], objective) - value(x, ends[1], objective)) / (2 * step)

    assert abs(difference("chordal") - printed) < 1e-9
    assert abs(difference("geodesic") - printed) > 0.5 * abs(printed)
