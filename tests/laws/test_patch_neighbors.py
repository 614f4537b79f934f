"""The laws of patch search."""

import clips
import numpy as np
import patches
import tolerances
from hypothesis import given
from hypothesis import strategies as st

seeds = st.integers(0, 2**32 - 1)


def sample(seed, frames=90):
    rng = np.random.default_rng(seed)
    return clips.noisy(rng, clips.smooth(rng, frames, 2), 0.05), rng


def close(a, b):
    np.testing.assert_allclose(a, b, rtol=0, atol=tolerances.FLOAT64)


@given(seed=seeds)
def test_signs_and_constant_rotations_on_either_side_change_nothing(backend, seed):
    q, rng = sample(seed)
    indices, distances = patches.neighbors(backend, q)
    found = patches.neighbors(backend, clips.flipped(rng, q))
    close(found[1], distances)
    np.testing.assert_array_equal(found[0], indices)
    left, right = clips.random_rotations(rng, 2, 2)
    moved = clips.product(clips.product(left, q), right)
    close(patches.neighbors(backend, moved)[1], distances)
    close(patches.all_distances(backend, moved), patches.all_distances(backend, q))


@given(seed=seeds)
def test_time_and_joints_may_be_reversed(backend, seed):
    q, _ = sample(seed)
    distances = patches.neighbors(backend, q)[1]
    close(patches.neighbors(backend, q[::-1])[1][::-1], distances)
    close(patches.neighbors(backend, q[:, ::-1])[1], distances)


@given(seed=seeds)
def test_neighbours_are_sorted_and_keep_away(backend, seed):
    q, _ = sample(seed)
    for exclusion in (0, 7):
        indices, distances = patches.neighbors(backend, q, exclusion=exclusion, k=9)
        assert (np.diff(distances, axis=1) >= 0).all()
        assert (np.abs(indices - np.arange(len(q))[:, None]) > exclusion).all()


@given(seed=seeds)
def test_distances_are_a_metric(backend, seed):
    q, _ = sample(seed, frames=40)
    d = patches.all_distances(backend, q, [q])
    close(d, d.T)
    close(np.diag(d), 0)
    assert (d[:, None] <= d[:, :, None] + d.T[None] + tolerances.FLOAT64).all()


@given(seed=seeds)
def test_a_library_is_its_clips_one_after_the_other(backend, seed):
    q, rng = sample(seed)
    first, second = clips.smooth(rng, 31, 2), q[20:70]
    both = patches.all_distances(backend, q, [first, second])
    np.testing.assert_array_equal(both[:, :31], patches.all_distances(backend, q, [first]))
    np.testing.assert_array_equal(both[:, 31:], patches.all_distances(backend, q, [second]))
    indices, distances = patches.neighbors(backend, q[20:70], [first, q], k=1)
    np.testing.assert_array_equal(indices[2:-2, 0], 31 + np.arange(22, 68))
    close(distances[2:-2], 0)


@given(seed=seeds)
def test_missing_samples_are_left_out(backend, seed):
    q, rng = sample(seed)
    gaps = q.copy()
    gaps[:, 1] = np.nan
    alone = patches.neighbors(backend, q[:, :1])
    without = patches.neighbors(backend, gaps)
    close(without[1], alone[1])
    np.testing.assert_array_equal(without[0], patches.neighbors(backend, q, weights=[1, 0])[0])
    # A sample that is missing in all patches of a frame's joint says nothing, where others do.
    gaps = q.copy()
    gaps[40, 0] = 0
    d, with_gap = patches.all_distances(backend, q), patches.all_distances(backend, gaps)
    away = np.abs(np.arange(len(q)) - 40) > patches.RADIUS
    close(with_gap[np.ix_(away, away)], d[np.ix_(away, away)])
    assert np.isfinite(with_gap).sum() == np.isfinite(d).sum()
    gone = np.full_like(q, np.nan)
    gone[rng.integers(0, 90), 0] = q[0, 0]
    indices, distances = patches.neighbors(backend, gone, exclusion=0)
    assert (indices[np.isinf(distances)] == -1).all()
    assert np.isfinite(distances).sum() <= (2 * patches.RADIUS + 1) * 2 * patches.RADIUS


@given(seed=seeds)
def test_the_largest_distance_is_half_a_turn(backend, seed):
    _, rng = sample(seed)
    pose = clips.random_rotations(rng, 1, 2)
    axes = rng.standard_normal((1, 2, 3))
    opposite = clips.product(
        pose, clips.from_vectors(np.pi * axes / np.linalg.norm(axes, axis=-1)[..., None])
    )
    _, distances = patches.neighbors(backend, np.tile(pose, (70, 1, 1)), [np.tile(opposite, (3, 1, 1))])
    close(distances[:, :3], np.pi)
    assert np.isinf(distances[:, 3:]).all()
