"""The laws of principal geodesics of whole poses."""

import clips
import numpy as np
import pytest
import quatfilt as qf
import tolerances
from drawn import seeds
from hypothesis import given
from hypothesis import strategies as st
from plugins.properties import examples

OBJECTIVES = ["geodesic", "squared", "chordal"]

pytestmark = pytest.mark.usefixtures("backend")


def swings(seed, joints=3, frames=60):
    """Poses along a main direction and two lesser ones, with noise."""
    rng = np.random.default_rng(seed)
    vectors = rng.standard_normal((3, joints, 3)) * np.array([0.5, 0.2, 0.08])[:, None, None]
    waves = np.sin(rng.uniform(0, 2 * np.pi, (frames, 3)))
    q = clips.from_vectors(np.einsum("fk,kjc->fjc", waves, vectors / np.sqrt(joints)))
    return clips.noisy(rng, clips.product(clips.random_rotations(rng, joints), q), 0.02), rng


def fitted(q, components=3, objective="geodesic"):
    return qf.PrincipalGeodesicAnalysis(components, objective=objective, body=True).fit(q)


def seen_from(q, mean):
    """Rotation vectors as seen from the means."""
    return (clips.rotation(np.broadcast_to(mean, q.shape)).inv() * clips.rotation(q)).as_rotvec()


def points(v, s):
    """Poses ``c_v(s)``; `s` in radians of rotation."""
    return clips.from_vectors(s[:, None, None] * v)


def pose_distances(a, b):
    return np.sqrt(np.sum(clips.angles(a, b) ** 2, axis=1))


@pytest.mark.parametrize("objective", OBJECTIVES)
def test_poses_on_a_geodesic_leave_nothing(objective):
    rng = np.random.default_rng(0)
    v = rng.standard_normal((5, 3))
    v /= np.linalg.norm(v)
    s = rng.uniform(-2.4, 2.4, 200)
    q = clips.product(clips.random_rotations(rng, 5), points(v, s))
    pga = fitted(q, 1, objective)
    assert pga.residuals_[0] < tolerances.FLOAT64
    sign = np.sign(np.sum(v * pga.components_[0]))
    np.testing.assert_allclose(sign * pga.components_[0], v, atol=tolerances.DIRECTION)
    assert clips.angles(pga.inverse_transform(pga.transform(q)), q).max() < tolerances.FLOAT64


@examples(10)
@given(seed=seeds, objective=st.sampled_from(OBJECTIVES))
def test_one_joint_is_a_body(seed, objective):
    q, _ = swings(seed, joints=1)
    body = fitted(q, 3, objective)
    joint = qf.PrincipalGeodesicAnalysis(3, objective=objective).fit(q)
    np.testing.assert_allclose(body.components_, joint.components_, atol=tolerances.DIRECTION)
    np.testing.assert_allclose(body.residuals_, joint.residuals_[:, 0], atol=tolerances.FLOAT64)
    np.testing.assert_allclose(body.transform(q), joint.transform(q)[:, 0], atol=tolerances.DIRECTION)


@examples(10)
@given(seed=seeds, objective=st.sampled_from(OBJECTIVES))
def test_a_joint_that_hardly_moves_hardly_matters(seed, objective):
    """The general way, which no formula of one joint takes part in, leads to the geodesic of the joint that moves."""
    q, rng = swings(seed, joints=1)
    still = clips.from_vectors(1e-9 * rng.standard_normal((len(q), 1, 3)))
    body = fitted(np.concatenate([q, still], axis=1), 1, objective)
    joint = qf.PrincipalGeodesicAnalysis(1, objective=objective).fit(q)
    np.testing.assert_allclose(body.residuals_, joint.residuals_[:, 0], atol=1e-6)


@examples(10)
@given(seed=seeds)
def test_signs_do_not_matter_and_frames_of_reference_turn_along(seed):
    q, rng = swings(seed)
    plain = fitted(q)
    left, right = clips.random_rotations(rng, 3), clips.random_rotations(rng, 3)
    moved = fitted(clips.product(left, clips.flipped(rng, q)))
    np.testing.assert_allclose(moved.components_, plain.components_, atol=tolerances.DIRECTION)
    np.testing.assert_allclose(moved.residuals_, plain.residuals_, atol=tolerances.FLOAT64)
    turned = fitted(clips.product(q, right))
    back = np.stack([clips.rotation(right).apply(v) for v in turned.components_])
    np.testing.assert_allclose(back, plain.components_, atol=tolerances.DIRECTION)
    np.testing.assert_allclose(turned.residuals_, plain.residuals_, atol=tolerances.FLOAT64)


@examples(10)
@given(seed=seeds, joints=st.integers(2, 6))
def test_no_worse_than_the_tangent_axis_and_never_rising(seed, joints):
    q, _ = swings(seed, joints)
    pga = fitted(q, 6)
    tangent = seen_from(q, pga.mean_).reshape(len(q), -1)
    axis = np.linalg.svd(tangent, full_matrices=False)[2][0].reshape(joints, 3)
    s = np.linspace(-4, 4, 2001)
    grid = clips.product(pga.mean_, points(axis, s))
    nearest = np.min([pose_distances(np.broadcast_to(pose, q.shape), q) for pose in grid[::10]], axis=0)
    assert pga.residuals_[0] <= nearest.mean() + tolerances.FLOAT64
    assert (np.diff(pga.residuals_) <= 0).all()
    assert (np.diff(pga.descent_, axis=1)[np.isfinite(pga.descent_[:, 1:])] <= 0).all()


@examples(20)
@given(seed=seeds, joints=st.integers(2, 5), spread=st.sampled_from([0.3, 1.5, 3.1]))
def test_projections_are_the_nearest_points(backend, seed, joints, spread):
    """Also of poses far from the geodesic, where the distance along it has several minima."""
    rng = np.random.default_rng(seed)
    mean = np.tile([1.0, 0, 0, 0], (joints, 1))
    v = rng.standard_normal((1, joints, 3))
    v /= np.linalg.norm(v)
    vectors = rng.standard_normal((20, joints, 3))
    vectors *= rng.uniform(0, spread, (20, joints, 1)) / np.linalg.norm(vectors, axis=-1, keepdims=True)
    q = clips.from_vectors(vectors)
    s = backend.body_scores(q, mean, v)[:, 0]
    end = np.pi / np.linalg.norm(v[0], axis=-1).max()
    assert (np.abs(s) <= end * (1 + tolerances.ALGEBRA)).all()
    found = pose_distances(points(v[0], s), q)
    for other in np.linspace(-end, end, 301):
        pose = np.broadcast_to(points(v[0], np.array([other])), q.shape)
        assert (found <= pose_distances(pose, q) + tolerances.FLOAT64).all()


@pytest.mark.parametrize("objective", OBJECTIVES)
def test_no_direction_nearby_is_better(backend, objective):
    q, rng = swings(7, joints=4, frames=150)
    mean = backend.geodesic_centre(q)[0]
    v = backend.body_geodesics(q, mean, 1, 64, objective, 1e-9)[0]

    def value(direction):
        left = clips.product(mean, points(direction[0], backend.body_scores(q, mean, direction)[:, 0]))
        half = clips.angles(left, q) / 2
        if objective == "chordal":
            return np.sum(1 - np.cos(half), axis=1).mean()
        squares = np.sum(half**2, axis=1)
        return (squares if objective == "squared" else np.sqrt(squares)).mean()

    least = value(v)
    for _ in range(100):
        other = v + rng.choice([1e-4, 1e-3, 1e-1]) * rng.standard_normal(v.shape)
        assert value(other / np.linalg.norm(other)) > least - 1e-9


def test_enough_geodesics_describe_poses():
    q, _ = swings(3, joints=2, frames=40)
    pga = qf.PrincipalGeodesicAnalysis(body=True, tol=1e-4).fit(q)
    assert pga.residuals_[-1] <= 1e-4 < pga.residuals_[-2]
    errors = pga.reconstruction_error(q)
    assert errors.shape == (40, 2)
    np.testing.assert_allclose(np.sqrt(np.sum(errors**2, axis=1)).mean(), pga.residuals_[-1], rtol=1e-6)
    for k in range(4):
        mean = np.sqrt(np.sum(pga.reconstruction_error(q, k) ** 2, axis=1)).mean()
        assert k == 0 or mean == pytest.approx(pga.residuals_[k - 1], abs=tolerances.FLOAT64)


def test_missing_samples_are_left_out_of_their_pose():
    q, _ = swings(5, joints=3, frames=80)
    gaps = q.copy()
    gaps[::4, 1] = np.nan
    gaps[10] = 0
    pga = fitted(gaps)
    scores = pga.transform(gaps)
    np.testing.assert_array_equal(np.flatnonzero(np.isnan(scores).any(axis=1)), [10])
    errors = pga.reconstruction_error(gaps)
    np.testing.assert_array_equal(
        np.isnan(errors), np.isnan(gaps).any(axis=-1) | (np.arange(80) == 10)[:, None]
    )
    without = np.sqrt(np.nansum(errors**2, axis=1))[np.arange(80) != 10]
    np.testing.assert_allclose(without.mean(), pga.residuals_[-1], atol=tolerances.FLOAT64)
    # A joint that is never seen has no part in anything.
    gaps[:, 1] = np.nan
    pga = fitted(gaps)
    assert (pga.components_[:, 1] == 0).all()
    others = fitted(np.delete(np.delete(q, 10, axis=0), 1, axis=1))
    np.testing.assert_allclose(pga.components_[:, [0, 2]], others.components_, atol=tolerances.DIRECTION)


def test_what_rests_has_no_direction():
    q = np.tile(clips.random_rotations(np.random.default_rng(1), 3), (9, 1, 1))
    pga = fitted(q, 2)
    assert pga.residuals_.max() < tolerances.FLOAT64
    np.testing.assert_allclose(np.sqrt(np.sum(pga.components_**2, axis=(1, 2))), 1, atol=tolerances.ALGEBRA)
    assert np.abs(pga.transform(q)).max() < tolerances.FLOAT64


def test_one_series():
    q, _ = swings(2, joints=1)
    pga = fitted(q[:, 0])
    assert pga.components_.shape == (3, 3)
    assert pga.residuals_.shape == (3,)
    scores = pga.transform(q[:, 0])
    assert scores.shape == (len(q), 3)
    assert pga.inverse_transform(scores[:, :2]).shape == (len(q), 4)
    assert pga.reconstruction_error(q[:, 0]).shape == (len(q),)
