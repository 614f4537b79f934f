"""Principal geodesic analysis: the core against the reference."""

import clips
import numpy as np
import pytest
import quatfilt as qf
import tolerances
from drawn import dtypes, seeds, spoil
from hypothesis import given
from hypothesis import strategies as st
from layouts import LAYOUTS
from plugins.properties import examples
from quatfilt import _core, _reference

DTYPES = [np.float32, np.float64]
OBJECTIVES = ["geodesic", "squared", "chordal"]
BACKENDS = (_core, _reference)


def same_numbers(result, expected, tolerance):
    assert result.dtype == expected.dtype
    assert result.shape == expected.shape
    np.testing.assert_allclose(result, expected, rtol=0, atol=tolerance, equal_nan=True)


def mean_angles(q, means):
    """Mean rotation angles of the joints from their means, ``(joints,)``; 0 for a joint without samples."""
    angles = np.zeros(q.shape[:2])
    there = np.isfinite(q).all(axis=-1) & (q != 0).any(axis=-1)
    angles[there] = clips.angles(np.broadcast_to(means, q.shape)[there], q[there])
    return angles.sum(axis=0) / np.maximum(there.sum(axis=0), 1)


def agree(q, objective, components=4):
    """Compare the fit, parameters and rotations; directions where something is left for them to fit."""
    before = q.tobytes()
    (means, radius, unique), expected = (backend.geodesic_centre(q) for backend in BACKENDS)
    same_numbers(radius, expected[1], tolerances.FLOAT64)
    np.testing.assert_array_equal(unique, expected[2])
    seen = np.isfinite(radius)
    np.testing.assert_array_equal(np.isfinite(means).all(axis=-1), seen)
    assert clips.angles(means[seen], expected[0][seen]).max(initial=0) < tolerances.KARCHER_MEAN
    assert unique.all(), "the samples have no centre"

    means = means.astype(q.dtype)
    arguments = (q, means, components, 64, objective, 1e-9)
    result, expected = (backend.principal_geodesics(*arguments) for backend in BACKENDS)
    tolerance = tolerances.filtered(q.dtype)
    same_numbers(result[1], expected[1], tolerance)
    left = np.concatenate([mean_angles(q, means)[None], expected[1][:-1].astype(np.float64)])
    told = left > tolerances.DIRECTED
    assert result[0].dtype == q.dtype
    np.testing.assert_allclose(result[0][told], expected[0][told], rtol=0, atol=tolerances.direction(q.dtype))
    np.testing.assert_allclose(np.linalg.norm(result[0], axis=-1), 1, atol=tolerances.algebra(q.dtype))
    for values in result[2].reshape(components * q.shape[1], -1):
        assert (np.diff(values[np.isfinite(values)]) <= 0).all(), "the objective rises"

    scores = [backend.geodesic_scores(q, means, expected[0]) for backend in BACKENDS]
    missing = np.isnan(scores[1])
    np.testing.assert_array_equal(np.isnan(scores[0]), missing)
    # A parameter of a sample half a turn from the mean may be π or −π: compare what it stands for.
    rotations = [
        backend.geodesic_product(given, means, expected[0]) for backend in BACKENDS for given in scores
    ]
    there = ~missing.any(axis=-1)
    for rotated in rotations:
        assert rotated.dtype == q.dtype
        np.testing.assert_array_equal(np.isfinite(rotated).all(axis=-1), there)
        assert clips.angles(rotated[there], rotations[-1][there]).max(initial=0) < tolerance
    assert q.tobytes() == before, "the input was written"


@examples(25)
@given(
    seed=seeds,
    frames=st.sampled_from([1, 2, 3, 7, 8, 9, 40, 300]),
    joints=st.sampled_from([1, 3]),
    spread=st.sampled_from([0.0, 1e-3, 0.1, 0.4]),
    share=st.sampled_from([0.0, 0.3]),
    dtype=dtypes,
    objective=st.sampled_from(OBJECTIVES),
)
def test_of_clouds(seed, frames, joints, spread, share, dtype, objective):
    rng = np.random.default_rng(seed)
    q = np.tile(clips.random_rotations(rng, joints), (frames, 1, 1))
    shape = spread * np.array([1, 0.5, 0.3])
    q = clips.product(q, clips.from_vectors(shape * rng.standard_normal((frames, joints, 3))))
    agree(spoil(rng, clips.flipped(rng, q), share).astype(dtype), objective)


@pytest.mark.parametrize("dtype", DTYPES)
@pytest.mark.parametrize("objective", OBJECTIVES)
def test_across_tasks_and_subsets(objective, dtype):
    rng = np.random.default_rng(0)
    q = clips.flipped(rng, clips.noisy(rng, clips.smooth(rng, 9001, 2), 0.1))
    agree(q.astype(dtype), objective)


def test_until_nothing_is_left():
    rng = np.random.default_rng(1)
    q = clips.smooth(rng, 200, 3)
    q[:, 1] = q[0, 1]
    means = _reference.geodesic_centre(q)[0]
    arguments = (q, means, 0, 64, "geodesic", 1e-6)
    result, expected = (backend.principal_geodesics(*arguments) for backend in BACKENDS)
    assert len(result[0]) == len(expected[0]) < 12
    same_numbers(result[1], expected[1], tolerances.FLOAT64)
    result, expected = (
        backend.principal_geodesics(*arguments[:3], 2, *arguments[4:]) for backend in BACKENDS
    )
    assert len(result[0]) == len(expected[0]) == 2


@pytest.mark.parametrize("joints", [0, 2])
def test_without_samples(joints):
    for frames in (0, 3):
        q = np.full((frames, joints, 4), np.nan)
        for backend in BACKENDS:
            means, radius, unique = backend.geodesic_centre(q)
            assert np.isnan(means).all()
            assert np.isnan(radius).all()
            assert unique.all()
            directions, residuals, descents = backend.principal_geodesics(q, means, 2, 64, "geodesic", 1e-9)
            assert directions.shape == (2, joints, 3)
            assert np.isnan(residuals).all()
            assert descents.shape == (2, joints, 0)


@pytest.mark.parametrize("dtype", DTYPES)
@pytest.mark.parametrize("layout", LAYOUTS)
def test_layouts(layout, dtype):
    rng = np.random.default_rng(2)
    plain = clips.noisy(rng, clips.smooth(rng, 90, 3), 0.1).astype(dtype)
    q = LAYOUTS[layout](plain)
    result = qf.PrincipalGeodesicAnalysis(2).fit(q)
    np.testing.assert_array_equal(result.components_, qf.PrincipalGeodesicAnalysis(2).fit(plain).components_)
    with qf.use_backend("numpy"):
        expected = qf.PrincipalGeodesicAnalysis(2).fit(q)
    same_numbers(result.components_, expected.components_, tolerances.direction(dtype))


def test_real_motion(data_dir):
    q = qf.read_motion(data_dir / "cmu" / "02" / "02_01.amc").rotations
    q = q[:, (_reference.geodesic_centre(q)[1] < 3)]
    assert q.shape[1] > 20
    agree(q[::3].copy(), "geodesic", components=5)
