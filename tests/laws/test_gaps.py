"""What must hold for filled gaps."""

import clips
import numpy as np
import pytest
import tolerances
from hypothesis import given
from hypothesis import strategies as st

seeds = st.integers(0, 2**32 - 1)
longest = st.sampled_from([-1, 0, 1, 3])
METHODS = ["slerp", "squad"]
every_method = pytest.mark.parametrize("method", METHODS)


def sample(seed, dtype=np.float64):
    rng = np.random.default_rng(seed)
    q = clips.flipped(rng, clips.smooth(rng, 30, 3, swing=4)).astype(dtype)
    missing = rng.random((30, 3)) < rng.choice([0.1, 0.6, 0.97])
    q[missing] = np.where(rng.random((30, 3, 1)) < 0.5, np.nan, 0)[missing]
    return q, missing


def run_lengths(missing):
    """Length of the run of missing samples that each sample belongs to, 0 for valid ones."""
    lengths = np.zeros(missing.shape, int)
    for joint in range(missing.shape[1]):
        for frame in np.flatnonzero(missing[:, joint]):
            first = last = frame
            while first > 0 and missing[first - 1, joint]:
                first -= 1
            while last + 1 < len(missing) and missing[last + 1, joint]:
                last += 1
            lengths[frame, joint] = last - first + 1
    return lengths


@every_method
@given(seed=seeds, max_gap=longest, dtype=st.sampled_from([np.float32, np.float64]))
def test_short_runs_are_filled_and_nothing_else(backend, method, seed, max_gap, dtype):
    q, missing = sample(seed, dtype)
    result, filled = backend.fill_gaps(q, max_gap, method)
    assert result.dtype == dtype
    short = run_lengths(missing) <= (30 if max_gap < 0 else max_gap)
    np.testing.assert_array_equal(filled, missing & short & ~missing.all(axis=0))
    np.testing.assert_array_equal(np.abs(result[~missing]), np.abs(q[~missing]))
    np.testing.assert_array_equal(np.isnan(result).all(axis=-1), missing & ~filled)
    np.testing.assert_array_equal(np.isnan(result).any(axis=-1), missing & ~filled)
    np.testing.assert_allclose(np.linalg.norm(result[filled], axis=-1), 1, atol=tolerances.algebra(dtype))


@every_method
@given(seed=seeds)
def test_it_does_not_depend_on_signs_and_turns_with_the_clip(backend, method, seed):
    q, missing = sample(seed)
    valid = ~(missing.all(axis=0) | np.zeros_like(missing))
    rng = np.random.default_rng(seed)
    left, right = clips.random_rotations(rng, 2)
    moved = q.copy()
    moved[~missing] = clips.flipped(rng, clips.product(left, clips.product(q[~missing], right)))
    result, _ = backend.fill_gaps(q, -1, method)
    turned, _ = backend.fill_gaps(moved, -1, method)
    expected = clips.product(left, clips.product(result[valid], right))
    assert clips.angles(turned[valid], expected).max(initial=0) < tolerances.FLOAT64


@every_method
@pytest.mark.parametrize("gap", [1, 2, 7])
def test_a_steady_turn_is_restored(backend, gap, method):
    angle = 0.3 * np.arange(12)
    clean = clips.from_vectors(angle[:, None, None] * np.array([0.6, 0.8, 0]))
    q = clean.copy()
    q[3 : 3 + gap] = np.nan
    result, filled = backend.fill_gaps(q, gap, method)
    assert filled.sum() == gap
    assert clips.angles(result, clean).max() < tolerances.FLOAT64


def about_one_axis(angle):
    return clips.from_vectors(angle[:, None, None] * np.array([0.6, 0.8, 0]))


def test_a_steadily_growing_turn_is_restored_by_the_cubic_alone(backend):
    """Neighbours of gaps at any distance: other gaps stand beside them."""
    clean = about_one_axis(0.01 * np.arange(30) ** 2)
    q = clean.copy()
    q[[3, 5, 6, 9, 10, 11, 13, 14, 15, 16, 18]] = np.nan
    result, _ = backend.fill_gaps(q, -1, "squad")
    assert clips.angles(result, clean).max() < tolerances.FLOAT64
    result, _ = backend.fill_gaps(q, -1, "slerp")
    assert clips.angles(result, clean).max() > 0.05


def test_the_cubic_takes_up_the_velocities_at_its_ends(backend):
    """At either end of a long gap the step inside is the step outside: that of the parabola, nearly."""
    rng = np.random.default_rng(5)
    gap = 20_000
    q = np.full((gap + 4, 1, 4), np.nan)
    turns = clips.from_vectors(1e-4 * rng.standard_normal((2, 1, 3)))
    q[[1]], q[[-2]] = clips.random_rotations(rng, 2)[:, None, None]
    q[[0]], q[[-1]] = clips.product(q[[1]], turns[:1]), clips.product(q[[-2]], turns[1:])
    result, _ = backend.fill_gaps(q, -1, "squad")
    outside = clips.product(result[[0, -2]] * [1, -1, -1, -1], result[[1, -1]])
    inside = clips.product(result[[1, -3]] * [1, -1, -1, -1], result[[2, -2]])
    assert clips.angles(outside, inside).max() < 0.01 * clips.angles(result[[0, -2]], result[[1, -1]]).min()
    straight, _ = backend.fill_gaps(q, -1, "slerp")
    inside = clips.product(straight[[1, -3]] * [1, -1, -1, -1], straight[[2, -2]])
    assert clips.angles(outside, inside).min() > 0.1 * clips.angles(result[[0, -2]], result[[1, -1]]).min()


def test_the_cubic_is_the_geodesic_where_nothing_lies_beyond(backend):
    q = clips.random_rotations(np.random.default_rng(6), 6, 2)
    q[1:-1] = np.nan
    cubic, straight = (backend.fill_gaps(q, -1, method)[0] for method in METHODS)
    assert clips.angles(cubic, straight).max() < tolerances.FLOAT64


@every_method
def test_ends_are_held(backend, method):
    q = clips.random_rotations(np.random.default_rng(0), 8, 1)
    expected = q.copy()
    expected[:2], expected[5:] = q[2], q[4]
    q[:2], q[5:] = np.nan, 0
    result, filled = backend.fill_gaps(q, 3, method)
    assert clips.angles(result, expected).max() < tolerances.ALGEBRA
    np.testing.assert_array_equal(filled[:, 0], [True, True, False, False, False, True, True, True])


@every_method
def test_empty(backend, method):
    result, filled = backend.fill_gaps(np.zeros((0, 3, 4)), -1, method)
    assert result.shape == (0, 3, 4)
    assert filled.shape == (0, 3)
