"""Principal geodesic analysis of whole poses: the core against the reference."""

import clips
import numpy as np
import pytest
import quatfilt as qf
import tolerances
from drawn import dtypes, seeds, spoil
from hypothesis import given
from hypothesis import strategies as st
from plugins.properties import examples
from quatfilt import _core, _reference

DTYPES = [np.float32, np.float64]
OBJECTIVES = ["geodesic", "squared", "chordal"]
BACKENDS = (_core, _reference)


def same_numbers(result, expected, tolerance):
    assert result.dtype == expected.dtype
    assert result.shape == expected.shape
    np.testing.assert_allclose(result, expected, rtol=0, atol=tolerance, equal_nan=True)


def agree_on(q, means, directions):
    """Compare parameters and poses along the same geodesics."""
    scores = [backend.body_scores(q, means, directions) for backend in BACKENDS]
    same_numbers(scores[0], scores[1], tolerances.filtered(q.dtype) * len(directions))
    poses = [backend.body_product(scores[1], means, directions) for backend in BACKENDS]
    assert poses[0].dtype == q.dtype
    there = np.isfinite(poses[1]).all(axis=-1)
    np.testing.assert_array_equal(np.isfinite(poses[0]).all(axis=-1), there)
    assert clips.angles(poses[0][there], poses[1][there]).max(initial=0) < tolerances.filtered(q.dtype)


def agree(q, objective, components=3):
    before = q.tobytes()
    means = _reference.geodesic_centre(q)[0].astype(q.dtype)
    arguments = (q, means, components, 64, objective, 1e-9)
    result, expected = (backend.body_geodesics(*arguments) for backend in BACKENDS)
    same_numbers(result[1], expected[1], tolerances.filtered(q.dtype))
    left = np.concatenate([[np.pi], expected[1][:-1].astype(np.float64)])
    told = left > tolerances.DIRECTED
    assert result[0].dtype == q.dtype
    np.testing.assert_allclose(result[0][told], expected[0][told], rtol=0, atol=tolerances.direction(q.dtype))
    np.testing.assert_allclose(
        np.sqrt(np.sum(result[0] ** 2, axis=(1, 2))), 1, atol=tolerances.algebra(q.dtype)
    )
    for values in result[2]:
        assert (np.diff(values[np.isfinite(values)]) <= 0).all(), "the objective rises"
    agree_on(q, means, expected[0])
    assert q.tobytes() == before, "the input was written"


@examples(15)
@given(
    seed=seeds,
    frames=st.sampled_from([40, 63, 64, 65, 300]),
    joints=st.sampled_from([1, 2, 5]),
    share=st.sampled_from([0.0, 0.3]),
    dtype=dtypes,
    objective=st.sampled_from(OBJECTIVES),
)
def test_of_swings(seed, frames, joints, share, dtype, objective):
    """Joints swing about axes of their own with amplitudes that tell the geodesics apart."""
    rng = np.random.default_rng(seed)
    vectors = rng.standard_normal((3, joints, 3)) * np.array([0.5, 0.2, 0.05])[:, None, None]
    waves = np.sin(rng.uniform(0, 2 * np.pi, (frames, 3)))
    q = clips.from_vectors(np.einsum("fk,kjc->fjc", waves, vectors / np.sqrt(joints)))
    q = clips.noisy(rng, clips.product(clips.random_rotations(rng, joints), q), 0.01)
    agree(spoil(rng, clips.flipped(rng, q), share).astype(dtype), objective)


@given(
    seed=seeds,
    frames=st.sampled_from([0, 1, 5, 65]),
    joints=st.sampled_from([1, 2, 4, 9]),
    spread=st.sampled_from([0.2, 1.0, 3.0]),
    share=st.sampled_from([0.0, 0.3, 1.0]),
    dtype=dtypes,
)
def test_far_from_the_geodesic(seed, frames, joints, spread, share, dtype):
    """Rotations up to half a turn from the mean, which other pieces of the geodesic may be nearer to."""
    rng = np.random.default_rng(seed)
    means = clips.random_rotations(rng, joints).astype(dtype)
    lengths = rng.uniform(0, spread, (frames, joints, 1))
    vectors = rng.standard_normal((frames, joints, 3))
    vectors *= lengths / np.linalg.norm(vectors, axis=-1, keepdims=True)
    q = clips.flipped(rng, clips.product(means, clips.from_vectors(vectors)))
    directions = rng.standard_normal((2, joints, 3)) * rng.uniform(0, 1, (joints, 1)) ** 3
    directions /= np.sqrt(np.sum(directions**2, axis=(1, 2), keepdims=True))
    agree_on(spoil(rng, q, share).astype(dtype), means, directions.astype(dtype))


def test_until_nothing_is_left():
    rng = np.random.default_rng(1)
    q = clips.smooth(rng, 90, 2, swing=0.2)
    q = np.concatenate([q, np.tile(q[:1], (90, 1, 1))], axis=1)
    means = _reference.geodesic_centre(q)[0]
    arguments = (q, means, 0, 64, "geodesic", 1e-3)
    result, expected = (backend.body_geodesics(*arguments) for backend in BACKENDS)
    assert len(result[0]) == len(expected[0]) < 30
    same_numbers(result[1], expected[1], tolerances.FLOAT64)
    assert (result[0][:, 2:] == 0).all(), "a joint that rests has a part in a geodesic"
    result, expected = (backend.body_geodesics(*arguments[:3], 2, *arguments[4:]) for backend in BACKENDS)
    assert len(result[0]) == len(expected[0]) == 2


@pytest.mark.parametrize("joints", [0, 2])
@pytest.mark.parametrize("frames", [0, 3])
def test_without_samples(frames, joints):
    q = np.full((frames, joints, 4), np.nan)
    means = np.full((joints, 4), np.nan)
    for backend in BACKENDS:
        directions, residuals, descents = backend.body_geodesics(q, means, 2, 64, "geodesic", 1e-9)
        assert directions.shape == (2, joints, 3)
        assert residuals.shape == (2,)
        assert np.isnan(residuals).all()
        assert descents.shape == (2, 0)
        scores = backend.body_scores(q, means, directions)
        assert scores.shape == (frames, 2)
        assert np.isnan(scores).all()
        assert backend.body_product(scores, means, directions).shape == (frames, joints, 4)


@pytest.mark.parametrize("dtype", DTYPES)
@pytest.mark.parametrize("objective", OBJECTIVES)
def test_across_tasks_and_subsets(objective, dtype):
    rng = np.random.default_rng(3)
    q = clips.flipped(rng, clips.noisy(rng, clips.walk(rng, 1501, 4), 0.05))
    agree(q.astype(dtype), objective)


def test_real_motion(data_dir):
    agree(qf.read_motion(data_dir / "cmu" / "02" / "02_01.amc").rotations[::2].copy(), "geodesic")
