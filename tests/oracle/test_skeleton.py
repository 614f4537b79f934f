"""Forward kinematics against SciPy's rotations, joint by joint."""

import clips
import numpy as np
import pytest
import tolerances


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_forward_kinematics(backend, dtype):
    rng = np.random.default_rng(0)
    parents = np.array([-1, 0, 1, 1, 3, 0, -1, 6])
    q = clips.random_rotations(rng, 30, len(parents)).astype(dtype)
    translation = rng.standard_normal((30, 3)).astype(dtype)
    offsets = rng.standard_normal((len(parents), 3)).astype(dtype)
    positions = backend.forward_kinematics(q, translation, parents, offsets)
    assert positions.dtype == dtype

    rotations, places = {}, {}
    for joint, parent in enumerate(parents):
        rotations[joint], places[joint] = clips.rotation(q[:, joint]), translation
        if parent >= 0:
            places[joint] = places[parent] + rotations[parent].apply(offsets[joint])
            rotations[joint] = rotations[parent] * rotations[joint]
    expected = np.stack([places[joint] for joint in range(len(parents))], axis=1)
    np.testing.assert_allclose(positions, expected, rtol=0, atol=tolerances.filtered(dtype))


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_forward_kinematics_of_moving_joints(backend, dtype):
    rng = np.random.default_rng(1)
    parents = np.array([-1, 0, 1, -1, 3])
    q = clips.random_rotations(rng, 1100, len(parents)).astype(dtype)
    moved = rng.standard_normal((1100, len(parents), 3)).astype(dtype)
    positions = backend.forward_kinematics_moving(q, moved, parents)
    assert positions.dtype == dtype

    rotations, places = {}, {}
    for joint, parent in enumerate(parents):
        rotations[joint], places[joint] = clips.rotation(q[:, joint]), moved[:, joint]
        if parent >= 0:
            places[joint] = places[parent] + rotations[parent].apply(moved[:, joint])
            rotations[joint] = rotations[parent] * rotations[joint]
    expected = np.stack([places[joint] for joint in range(len(parents))], axis=1)
    np.testing.assert_allclose(positions, expected, rtol=0, atol=tolerances.filtered(dtype))
