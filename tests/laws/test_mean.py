"""The laws of Karcher means."""

import clips
import numpy as np
import tolerances
from hypothesis import given
from hypothesis import strategies as st

seeds = st.integers(0, 2**32 - 1)


def sample(seed):
    rng = np.random.default_rng(seed)
    q = clips.noisy(rng, np.tile(clips.random_rotations(rng, 2), (30, 1, 1)), rng.uniform(0, 0.8))
    return q, rng.random((30, 2)), rng


def same(a, b):
    assert clips.angles(a, b).max() < tolerances.KARCHER_MEAN


@given(seed=seeds)
def test_motions_move_the_mean(backend, seed):
    q, weights, rng = sample(seed)
    left, right = clips.random_rotations(rng, 2)
    moved = clips.product(left, clips.product(q, right))
    same(backend.mean(moved, weights), clips.product(left, clips.product(backend.mean(q, weights), right)))


@given(seed=seeds)
def test_neither_signs_nor_order_nor_the_scale_of_the_weights_matter(backend, seed):
    q, weights, rng = sample(seed)
    result = backend.mean(q, weights)
    order = rng.permutation(30)
    same(backend.mean(clips.flipped(rng, q)[order], 5 * weights[order]), result)
    assert (result[:, 0] >= 0).all()
    np.testing.assert_allclose(np.linalg.norm(result, axis=-1), 1, atol=tolerances.ALGEBRA)


@given(seed=seeds)
def test_weights_count_repetitions(backend, seed):
    q, _, rng = sample(seed)
    times = rng.integers(0, 4, 30)
    weights = np.repeat(times[:, None], 2, axis=1).astype(np.float64)
    same(backend.mean(np.repeat(q, times, axis=0), None), backend.mean(q, weights))


@given(seed=seeds)
def test_missing_samples_are_left_out(backend, seed):
    q, weights, rng = sample(seed)
    gone = rng.random(30) < 0.5
    gone[0] = False
    with_gaps = q.copy()
    with_gaps[gone] = np.nan
    with_gaps[gone & (rng.random(30) < 0.5)] = 0
    same(backend.mean(with_gaps, weights), backend.mean(q[~gone], weights[~gone]))


def test_without_any_sample_there_is_no_mean(backend):
    q = clips.random_rotations(np.random.default_rng(0), 5, 2)
    q[:, 1] = np.nan
    result = backend.mean(q, None)
    assert np.isfinite(result[0]).all()
    assert np.isnan(result[1]).all()
    assert np.isnan(backend.mean(q, np.zeros((5, 2)))).all()
    assert np.isnan(backend.mean(q[:0], None)).all()


def test_float32(backend):
    q, weights, _ = sample(0)
    result = backend.mean(q.astype(np.float32), weights.astype(np.float32))
    assert result.dtype == np.float32
    assert clips.angles(result, backend.mean(q, weights)).max() < tolerances.FLOAT32
