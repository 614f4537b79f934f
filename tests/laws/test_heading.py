"""The laws of headings and of poses as vectors."""

import clips
import numpy as np
import pytest
import tolerances
from hypothesis import given
from hypothesis import strategies as st

seeds = st.integers(0, 2**32 - 1)
axes = st.integers(0, 2)


def close(a, b):
    np.testing.assert_allclose(a, b, rtol=0, atol=tolerances.FLOAT64)


def about(up, angles):
    """Turns about the vertical."""
    vectors = np.zeros((len(angles), 3))
    vectors[:, up] = angles
    return clips.from_vectors(vectors)


def upright(rng, frames, up):
    """A body that leans by up to a right angle about horizontal axes."""
    leaning = rng.uniform(-1, 1, (frames, 3))
    leaning[:, up] = 0
    return clips.from_vectors(leaning)


@given(seed=seeds, up=axes)
def test_heading_and_rest_give_the_rotation(backend, seed, up):
    rng = np.random.default_rng(seed)
    q = clips.random_rotations(rng, 50)
    heading, rest = backend.split_heading(q, up)
    assert clips.angles(clips.product(about(up, heading), rest), q).max() < tolerances.FLOAT64
    close(rest[:, 1 + up], 0)


@given(seed=seeds, up=axes)
def test_the_rest_is_the_shortest_turn_that_tilts_the_vertical_so(backend, seed, up):
    rng = np.random.default_rng(seed)
    lean = upright(rng, 40, up)
    heading, rest = backend.split_heading(lean, up)
    close(heading, 0)
    assert clips.angles(rest, lean).max() < tolerances.FLOAT64


@given(seed=seeds, up=axes)
def test_turning_the_world_turns_the_heading_alone(backend, seed, up):
    rng = np.random.default_rng(seed)
    q = clips.product(about(up, np.linspace(0, 3, 60)), upright(rng, 60, up))
    by = rng.uniform(-9, 9)
    heading, rest = backend.split_heading(q, up)
    other, same = backend.split_heading(clips.product(about(up, [by]), q), up)
    assert clips.angles(rest, same).max() < tolerances.FLOAT64
    # The same everywhere, up to whole turns.
    close(np.ptp(other - heading), 0)
    close(np.cos(other - heading - by), 1)


@given(seed=seeds, up=axes)
def test_signs_do_not_matter(backend, seed, up):
    rng = np.random.default_rng(seed)
    q = clips.product(about(up, np.linspace(0, 20, 80)), upright(rng, 80, up))
    heading, rest = backend.split_heading(q, up)
    flipped, other = backend.split_heading(clips.flipped(rng, q[:, None])[:, 0], up)
    close(flipped, heading)
    assert clips.angles(rest, other).max() < tolerances.FLOAT64


def test_turns_are_counted(backend):
    angles = np.linspace(0.5, 40, 400)
    heading, rest = backend.split_heading(about(1, angles), 1)
    close(heading, angles)
    close(np.abs(rest[:, 0]), 1)


def test_missing_samples_do_not_interrupt_the_count(backend):
    angles = np.linspace(0, 12, 120)
    q = about(2, angles)
    q[[0, 50, 51, 119]] = np.nan
    q[7] = 0
    heading, rest = backend.split_heading(q, 2)
    valid = np.isfinite(q).all(axis=1) & q.any(axis=1)
    close(heading[valid], angles[valid])
    assert np.isnan(heading[~valid]).all()
    assert np.isnan(rest[~valid]).all()


def test_upside_down_has_no_heading(backend):
    heading, rest = backend.split_heading(np.array([[0.0, 0.6, 0, 0.8]]), 1)
    assert heading == 0
    close(rest, [[0, 0.6, 0, 0.8]])


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_nothing_to_split(backend, dtype):
    heading, rest = backend.split_heading(np.zeros((0, 4), dtype), 1)
    assert heading.shape == (0,)
    assert rest.shape == (0, 4)
    assert heading.dtype == rest.dtype == dtype


@given(seed=seeds)
def test_distances_of_features_are_weighted_distances_of_poses(backend, seed):
    rng = np.random.default_rng(seed)
    means, weights = clips.random_rotations(rng, 5), rng.uniform(0, 2, 5)
    # From the mean, exactly; between poses near it, up to the curvature of the sphere.
    steps = rng.standard_normal((30, 5, 3))
    steps /= np.linalg.norm(steps, axis=-1, keepdims=True)
    far = clips.product(means, clips.from_vectors(steps * rng.uniform(0, 3, (30, 5, 1))))
    near = clips.product(means, clips.from_vectors(0.01 * steps))
    angles = clips.angles(np.broadcast_to(means, far.shape), far)
    features = backend.pose_features(far, means, weights)
    close(np.sum(features**2, axis=1), np.sum(weights * angles**2, axis=1))
    features = backend.pose_features(near, means, weights)
    expected = np.sqrt(np.sum(weights * clips.angles(near[1:], near[:-1]) ** 2, axis=1))
    got = np.linalg.norm(np.diff(features, axis=0), axis=1)
    # The chart stretches by (θ/2)/sin(θ/2), 4e-6 at 0.01 radians.
    np.testing.assert_allclose(got, expected, rtol=1e-5)


@given(seed=seeds)
def test_signs_of_poses_do_not_matter(backend, seed):
    rng = np.random.default_rng(seed)
    q, means = clips.smooth(rng, 30, 4), clips.random_rotations(rng, 4)
    features = backend.pose_features(q, means, np.ones(4))
    close(backend.pose_features(clips.flipped(rng, q), means, np.ones(4)), features)
    close(backend.pose_features(q, -means, np.ones(4)), features)
