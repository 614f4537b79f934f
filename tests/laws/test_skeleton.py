"""The laws of forward kinematics."""

import clips
import numpy as np
import tolerances
from hypothesis import given
from hypothesis import strategies as st

seeds = st.integers(0, 2**32 - 1)
JOINTS = 9


def sample(seed):
    rng = np.random.default_rng(seed)
    parents = np.array([-1] + [rng.integers(0, joint) for joint in range(1, JOINTS)], np.int64)
    offsets = rng.standard_normal((JOINTS, 3))
    return clips.smooth(rng, 10, JOINTS), clips.path(rng, 10), parents, offsets, rng


def close(a, b):
    np.testing.assert_allclose(a, b, rtol=0, atol=tolerances.FLOAT64)


@given(seed=seeds)
def test_bones_keep_their_lengths_and_the_root_its_place(backend, seed):
    q, translation, parents, offsets, _ = sample(seed)
    positions = backend.forward_kinematics(q, translation, parents, offsets)
    bones = positions[:, 1:] - positions[:, parents[1:]]
    close(
        np.linalg.norm(bones, axis=-1),
        np.broadcast_to(np.linalg.norm(offsets[1:], axis=-1), (10, JOINTS - 1)),
    )
    np.testing.assert_array_equal(positions[:, 0], translation)


@given(seed=seeds)
def test_a_motion_of_the_root_moves_the_body(backend, seed):
    q, translation, parents, offsets, rng = sample(seed)
    turn, shift = clips.random_rotations(rng, 1), rng.standard_normal(3)
    positions = backend.forward_kinematics(q, translation, parents, offsets)
    other = q.copy()
    other[:, 0] = clips.product(turn, q[:, 0])
    way = np.ascontiguousarray(clips.rotation(turn).apply(translation) + shift)
    moved = backend.forward_kinematics(other, way, parents, offsets)
    close(moved, clips.rotation(turn).apply(positions.reshape(-1, 3)).reshape(positions.shape) + shift)


@given(seed=seeds)
def test_signs_do_not_matter(backend, seed):
    q, translation, parents, offsets, rng = sample(seed)
    positions = backend.forward_kinematics(q, translation, parents, offsets)
    close(backend.forward_kinematics(clips.flipped(rng, q), translation, parents, offsets), positions)


def test_in_the_rest_pose_offsets_add_up(backend):
    _, _, parents, offsets, _ = sample(0)
    rest = np.tile([1.0, 0, 0, 0], (1, JOINTS, 1))
    positions = backend.forward_kinematics(rest, np.zeros((1, 3)), parents, offsets)[0]
    for joint in range(1, JOINTS):
        close(positions[joint], positions[parents[joint]] + offsets[joint])


def test_no_frames(backend):
    _, _, parents, offsets, _ = sample(0)
    assert backend.forward_kinematics(np.zeros((0, JOINTS, 4)), np.zeros((0, 3)), parents, offsets).shape == (
        0,
        JOINTS,
        3,
    )
