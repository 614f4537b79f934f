"""Poses as vectors: the core against the reference."""

import clips
import numpy as np
import pytest
import tolerances
from drawn import dtypes, joints, lengths, missing, seeds, spoil
from hypothesis import given
from quatfilt import _core, _reference


def agree(q, means, weights):
    before = q.tobytes()
    result, expected = (backend.pose_features(q, means, weights) for backend in (_core, _reference))
    assert result.dtype == expected.dtype
    np.testing.assert_allclose(result, expected, rtol=0, atol=4 * tolerances.filtered(q.dtype))
    assert q.tobytes() == before, "the input was written"


@given(seed=seeds, frames=lengths, joints=joints, share=missing, dtype=dtypes)
def test_pose_features(seed, frames, joints, share, dtype):
    rng = np.random.default_rng(seed)
    means = clips.random_rotations(rng, joints)
    # Within what both fold alike: beside half a turn, a rounding decides about the side.
    away = rng.standard_normal((frames, joints, 3))
    away *= rng.uniform(0, 3.1, (frames, joints, 1)) / np.linalg.norm(away, axis=-1, keepdims=True)
    q = spoil(rng, clips.flipped(rng, clips.product(means[None], clips.from_vectors(away))), share)
    agree(q.astype(dtype), means, rng.uniform(0, 1, joints))


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_across_tasks(dtype):
    rng = np.random.default_rng(0)
    q = clips.walk(rng, 5003, 7)
    agree(q.astype(dtype), q[0], np.arange(7.0))


def test_arrays_that_do_not_fit():
    q = np.tile([1.0, 0, 0, 0], (2, 3, 1))
    with pytest.raises(ValueError, match=r"^means: expected 12 elements, got 8$"):
        _core.pose_features(q, np.zeros((2, 4)), np.ones(3))
    with pytest.raises(ValueError, match=r"^weights: expected 3 elements, got 2$"):
        _core.pose_features(q, np.zeros((3, 4)), np.ones(2))
