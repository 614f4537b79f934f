"""The laws of principal geodesic analysis."""

import clips
import numpy as np
import pytest
import quatfilt as qf
import tolerances
from hypothesis import given
from hypothesis import strategies as st
from plugins.properties import examples
from scipy.spatial.transform import Rotation

OBJECTIVES = ["geodesic", "squared", "chordal"]

seeds = st.integers(0, 2**32 - 1)


def cloud(rng, frames=40, joints=2, spread=0.4):
    """Samples about random centres, of different width along three axes."""
    vectors = spread * np.array([1, 0.6, 0.3]) * rng.standard_normal((frames, joints, 3))
    return clips.product(clips.random_rotations(rng, joints), clips.from_vectors(vectors))


def fit(q, k=3, **options):
    return qf.PrincipalGeodesicAnalysis(k, **options).fit(q)


def turned(q, vectors):
    """Vectors seen from another frame, ``q v q⁻¹``."""
    return clips.rotation(q).apply(np.reshape(vectors, (-1, 3))).reshape(np.shape(vectors))


@examples(6)
@given(seed=seeds, objective=st.sampled_from(OBJECTIVES))
def test_rotations_on_both_sides_turn_the_result(backend, seed, objective):  # noqa: ARG001 - a backend
    rng = np.random.default_rng(seed)
    q = cloud(rng)
    a, b = clips.random_rotations(rng, 2)
    plain = fit(q, objective=objective)
    moved = fit(clips.product(a, clips.product(q, b)), objective=objective)
    expected = clips.product(a, clips.product(plain.mean_, b))
    assert clips.angles(moved.mean_, expected).max() < tolerances.FLOAT64
    back = Rotation.from_quat(b, scalar_first=True).inv().as_quat(scalar_first=True)
    np.testing.assert_allclose(
        moved.components_, turned(back, plain.components_), rtol=0, atol=tolerances.DIRECTION
    )
    np.testing.assert_allclose(moved.residuals_, plain.residuals_, rtol=0, atol=tolerances.FLOAT64)


@examples(6)
@given(seed=seeds, objective=st.sampled_from(OBJECTIVES))
def test_neither_signs_nor_missing_samples_matter(backend, seed, objective):  # noqa: ARG001
    rng = np.random.default_rng(seed)
    q = cloud(rng, joints=1)
    spoilt = np.insert(
        clips.flipped(rng, q),
        [0, 7, 30],
        np.array([[np.nan] * 4, [0] * 4, [0, np.inf, 0, 0]])[:, None],
        axis=0,
    )
    plain, other = fit(q, objective=objective), fit(spoilt, objective=objective)
    np.testing.assert_allclose(other.components_, plain.components_, rtol=0, atol=tolerances.DIRECTION)
    np.testing.assert_allclose(other.residuals_, plain.residuals_, rtol=0, atol=tolerances.FLOAT64)
    missing = np.isnan(spoilt).any(axis=-1) | np.isinf(spoilt).any(axis=-1) | (spoilt == 0).all(axis=-1)
    np.testing.assert_array_equal(np.isnan(other.reconstruction_error(spoilt)), missing)
    np.testing.assert_array_equal(np.isnan(other.transform(spoilt)).any(axis=-1), missing)
    assert np.isnan(other.inverse_transform(other.transform(spoilt))[missing]).all()


@examples(6)
@given(seed=seeds, objective=st.sampled_from(OBJECTIVES))
def test_what_is_left_falls_and_is_the_mean_error(backend, seed, objective):  # noqa: ARG001
    q = cloud(np.random.default_rng(seed), spread=0.5)
    pga = fit(q, 7, objective=objective)
    assert (np.diff(pga.residuals_, axis=0) <= 0).all()
    for k in range(1, 8):
        mean_error = pga.reconstruction_error(q, k).mean(axis=0)
        np.testing.assert_allclose(mean_error, pga.residuals_[k - 1], rtol=0, atol=tolerances.FLOAT64)
    np.testing.assert_allclose(
        clips.angles(np.broadcast_to(pga.mean_, q.shape), q),
        pga.reconstruction_error(q, 0),
        rtol=0,
        atol=tolerances.FLOAT64,
    )
    descents = pga.descent_.reshape(14, -1)
    for values in descents:
        assert (np.diff(values[np.isfinite(values)]) <= 0).all()
    if objective == "geodesic":
        last = np.array([values[np.isfinite(values)][-1] for values in descents]).reshape(7, 2)
        np.testing.assert_allclose(2 * last, pga.residuals_, rtol=0, atol=tolerances.FLOAT64)


@given(seed=seeds)
@examples(4)
def test_any_tolerance_is_reached(backend, seed):  # noqa: ARG001
    q = cloud(np.random.default_rng(seed), spread=0.5)
    for tolerance in (0.1, 1e-3, 1e-9):
        pga = fit(q, None, tol=tolerance)
        assert (pga.residuals_[-1] <= tolerance).all()
        assert len(pga.residuals_) == 1 or (pga.residuals_[-2] > tolerance).any()
    back = pga.inverse_transform(pga.transform(q))
    assert clips.angles(q, back).mean() < 2e-9


@given(seed=seeds)
@examples(6)
def test_axes_are_unit_across_the_one_before_and_signed_by_the_samples(backend, seed):  # noqa: ARG001
    q = cloud(np.random.default_rng(seed))
    pga = fit(q, 4)
    np.testing.assert_allclose(np.linalg.norm(pga.components_, axis=-1), 1, atol=tolerances.ALGEBRA)
    dots = np.sum(pga.components_[1:] * pga.components_[:-1], axis=-1)
    np.testing.assert_allclose(dots, 0, atol=tolerances.DIRECTION)
    scores = pga.transform(q)
    for joint in range(2):
        for k in range(4):
            s = scores[:, joint, k]
            assert s[np.argmax(np.abs(s) > 0.7 * np.abs(s).max())] > 0


@pytest.mark.parametrize("objective", OBJECTIVES)
def test_samples_on_one_geodesic(backend, objective):  # noqa: ARG001
    axis = np.array([2.0, -1, 2]) / 3
    angles = np.sort(np.random.default_rng(0).uniform(-2.5, 2.5, 40))[::-1]
    angles -= angles.mean()
    q = clips.product(
        clips.random_rotations(np.random.default_rng(1), 1)[0], clips.from_vectors(angles[:, None] * axis)
    )
    pga = fit(q, 2, objective=objective)
    np.testing.assert_allclose(pga.components_[0], axis, atol=tolerances.DIRECTION)
    assert (pga.residuals_ < tolerances.FLOAT64).all()
    np.testing.assert_allclose(pga.transform(q)[:, 0], angles, atol=tolerances.FLOAT64)


def test_equal_samples_leave_nothing(backend):  # noqa: ARG001
    q = np.tile(clips.random_rotations(np.random.default_rng(0), 3), (20, 1, 1))
    pga = fit(q, 2)
    assert (pga.residuals_ < tolerances.FLOAT64).all()
    assert (np.abs(pga.transform(q)) < tolerances.FLOAT64).all()
    assert len(fit(q, None).residuals_) == 0


def test_a_series_has_no_joints_axis(backend):  # noqa: ARG001
    q = cloud(np.random.default_rng(0), joints=3)
    whole, one = fit(q, 2), fit(q[:, 1], 2)
    for name in ("mean_", "components_", "residuals_"):
        joint = getattr(whole, name)[..., 1, :] if name != "residuals_" else whole.residuals_[:, 1]
        np.testing.assert_allclose(getattr(one, name), joint, rtol=0, atol=tolerances.ALGEBRA)
    assert one.descent_.shape[0] == 2
    assert one.descent_.ndim == 2
    assert one.transform(q[:, 1]).shape == (40, 2)
    assert one.reconstruction_error(q[:, 1]).shape == (40,)
    assert one.inverse_transform(one.transform(q[:, 1])).shape == (40, 4)


def test_scalar_last(backend):  # noqa: ARG001
    q = cloud(np.random.default_rng(0))
    first, last = fit(q), fit(np.roll(q, -1, axis=-1), scalar_first=False)
    np.testing.assert_array_equal(last.components_, first.components_)
    np.testing.assert_array_equal(last.mean_, np.roll(first.mean_, -1, axis=-1))
    scores = first.transform(q)
    np.testing.assert_array_equal(last.transform(np.roll(q, -1, axis=-1)), scores)
    np.testing.assert_array_equal(
        last.inverse_transform(scores), np.roll(first.inverse_transform(scores), -1, axis=-1)
    )


def test_fewer_parameters_are_fewer_factors(backend):  # noqa: ARG001
    q = cloud(np.random.default_rng(0))
    pga = fit(q)
    scores = pga.transform(q)
    np.testing.assert_allclose(
        clips.angles(q, pga.inverse_transform(scores[..., :1])),
        pga.reconstruction_error(q, 1),
        rtol=0,
        atol=tolerances.FLOAT64,
    )
    np.testing.assert_allclose(
        pga.inverse_transform(scores[..., :0])[5], pga.mean_, rtol=0, atol=tolerances.ALGEBRA
    )


def test_whole_turns_do_not_matter(backend):  # noqa: ARG001
    q = cloud(np.random.default_rng(0), joints=1)
    pga = fit(q, 1)
    scores = pga.transform(q)
    for turns in (3, -5):
        far = pga.inverse_transform(scores + 2 * np.pi * turns)
        assert clips.angles(far, pga.inverse_transform(scores)).max() < tolerances.FLOAT64


def test_float32(backend):  # noqa: ARG001
    q = cloud(np.random.default_rng(0))
    wide, narrow = fit(q), fit(q.astype(np.float32))
    for name in ("mean_", "components_", "residuals_", "descent_"):
        assert getattr(narrow, name).dtype == np.float32
    np.testing.assert_allclose(narrow.components_, wide.components_, rtol=0, atol=tolerances.FLOAT32)
    assert narrow.transform(q.astype(np.float32)).dtype == np.float32
    assert narrow.transform(q).dtype == np.float64


def test_a_joint_without_samples_is_missing(backend):  # noqa: ARG001
    q = cloud(np.random.default_rng(0), joints=3)
    q[:, 1] = np.nan
    pga = fit(q, 2)
    assert np.isnan(pga.mean_[1]).all()
    assert np.isnan(pga.residuals_[:, 1]).all()
    np.testing.assert_allclose(pga.residuals_[:, [0, 2]], fit(q[:, [0, 2]], 2).residuals_)
    assert np.isnan(pga.transform(q)[:, 1]).all()


def test_directions_converge_where_samples_nearly_lie_on_the_geodesic(backend):  # noqa: ARG001
    """The direction does not move by more than its share of what the samples move."""
    rng = np.random.default_rng(3)
    angles = np.linspace(-1, 1, 41)[:, None] * np.array([0.0, 0.6, 0.8])
    for noise in (1e-3, 1e-6, 1e-9):
        vectors = angles + noise * rng.standard_normal((41, 3))
        q = clips.from_vectors(vectors)
        start = fit(q, 1)
        for _ in range(3):
            b = clips.random_rotations(rng, 1)[0]
            back = Rotation.from_quat(b, scalar_first=True).inv().as_quat(scalar_first=True)
            again = fit(clips.product(q, b), 1)
            np.testing.assert_allclose(
                again.components_, turned(back, start.components_), rtol=0, atol=tolerances.DIRECTION
            )
