"""The laws of interpolation in time."""

import clips
import numpy as np
import pytest
import tolerances
from hypothesis import given
from hypothesis import strategies as st

seeds = st.integers(0, 2**32 - 1)


def sample(seed, frames=12):
    rng = np.random.default_rng(seed)
    times = np.cumsum(rng.uniform(0.1, 1, frames))
    return clips.flipped(rng, clips.smooth(rng, frames, 2, swing=20)), times, rng


@given(seed=seeds)
def test_at_the_times_of_samples_it_is_the_samples(backend, seed):
    q, times, _ = sample(seed)
    assert clips.angles(backend.slerp(q, times, times), q).max() < tolerances.ALGEBRA


@given(seed=seeds)
def test_between_two_samples_the_angle_grows_evenly(backend, seed):
    q, _, rng = sample(seed, frames=2)
    part = np.sort(rng.random(20))
    result = backend.slerp(q, np.array([0.0, 1.0]), part)
    angle = clips.angles(q[0], q[1])
    expected = part[:, None] * angle
    np.testing.assert_allclose(
        clips.angles(np.broadcast_to(q[0], result.shape), result), expected, atol=tolerances.FLOAT64
    )
    expected = (1 - part[:, None]) * angle
    np.testing.assert_allclose(
        clips.angles(result, np.broadcast_to(q[1], result.shape)), expected, atol=tolerances.FLOAT64
    )


@given(seed=seeds)
def test_constant_rotations_and_time_reversal(backend, seed):
    q, times, rng = sample(seed)
    new_times = rng.uniform(times[0], times[-1], 30)
    result = backend.slerp(q, times, new_times)
    left, right = clips.random_rotations(rng, 2)
    moved = backend.slerp(clips.product(left, clips.product(q, right)), times, new_times)
    assert clips.angles(moved, clips.product(left, clips.product(result, right))).max() < tolerances.FLOAT64
    reversed_result = backend.slerp(np.ascontiguousarray(q[::-1]), -times[::-1], -new_times)
    assert clips.angles(reversed_result, result).max() < tolerances.FLOAT64


@given(seed=seeds)
def test_output_is_unit_and_continuous_in_sign(backend, seed):
    q, times, rng = sample(seed)
    result = backend.slerp(q, times, np.sort(rng.uniform(times[0], times[-1], 30)))
    np.testing.assert_allclose(np.linalg.norm(result, axis=-1), 1, atol=tolerances.ALGEBRA)
    assert (np.sum(result[1:] * result[:-1], axis=-1) >= 0).all()


def test_missing_samples_reach_no_further_than_their_neighbors(backend):
    q, _, _ = sample(0)
    q[5, 1] = np.nan
    result = backend.slerp(q, np.arange(12.0), np.arange(0, 11.5, 0.5))
    missing = np.isnan(result).any(axis=-1)
    assert not missing[:, 0].any()
    np.testing.assert_array_equal(np.flatnonzero(missing[:, 1]), [9, 10, 11])


@pytest.mark.parametrize("frames", [0, 1])
def test_shortest_clips(backend, frames):
    q = clips.random_rotations(np.random.default_rng(0), frames, 2)
    result = backend.slerp(q, np.zeros(frames), np.zeros(3 * frames))
    assert result.shape == (3 * frames, 2, 4)
    assert clips.angles(result, np.repeat(q, 3, axis=0)).max(initial=0) < tolerances.ALGEBRA
