"""Forward kinematics: the core against the reference."""

import clips
import numpy as np
import pytest
import tolerances
from drawn import dtypes, joints, lengths, seeds
from hypothesis import given
from hypothesis import strategies as st
from quatfilt import _core, _reference


def body(rng, frames, joints, roots):
    """Rotations, translation, parents and offsets of a random tree whose limbs have length 1 in all."""
    parents = np.array([rng.integers(-1 if roots else 0, j) if j else -1 for j in range(joints)], np.int64)
    offsets = rng.standard_normal((joints, 3)) / max(joints, 1)
    return clips.smooth(rng, frames, joints), clips.path(rng, frames), parents, offsets


def agree(q, translation, parents, offsets):
    result, expected = (
        backend.forward_kinematics(q, translation, parents, offsets) for backend in (_core, _reference)
    )
    assert result.dtype == expected.dtype
    scale = 1 + np.nanmax(np.abs(expected), initial=0)
    np.testing.assert_allclose(result, expected, rtol=0, atol=scale * tolerances.filtered(q.dtype))


@given(seed=seeds, frames=lengths, joints=joints, roots=st.booleans(), dtype=dtypes)
def test_forward_kinematics(seed, frames, joints, roots, dtype):
    rng = np.random.default_rng(seed)
    q, translation, parents, offsets = body(rng, frames, joints, roots)
    agree(q.astype(dtype), translation.astype(dtype), parents, offsets.astype(dtype))


def test_missing_samples_stay_in_their_branch_and_frame():
    rng = np.random.default_rng(0)
    q, translation, parents, offsets = body(rng, 2000, 12, roots=False)
    q[[3, 700, 1999], [1, 0, 5]] = np.nan
    agree(q, translation, parents, offsets)


def test_parents_must_precede_their_children():
    q = np.tile([1.0, 0, 0, 0], (2, 3, 1))
    for parents in ([-1, 2, 0], [0, -1, -1], [-1, 0, 9]):
        with pytest.raises(ValueError, match=r"^parents: expected parents that precede their children$"):
            _core.forward_kinematics(q, np.zeros((2, 3)), np.array(parents, np.int64), np.zeros((3, 3)))
