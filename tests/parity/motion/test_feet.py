"""Feet on the ground: the core against the reference."""

import numpy as np
import pytest
import tolerances
from drawn import dtypes, seeds
from hypothesis import given
from hypothesis import strategies as st
from quatfilt import _core, _reference

PARENTS = np.array([-1, 0, 1, 2, 3, 4, 1, 6, 7, 0], np.int64)
"""A root, a pelvis, a leg with a toe, one without, and a spine."""

LEGS = np.array([[2, 3, 4, 5], [6, 7, 8, 8]], np.int64)

lengths = st.sampled_from([2, 3, 5, 20, 47, 130, 300])


def feet(rng, frames):
    """Paths of feet that stand and step, before and after a filter, with noise in the former; ``(frames, 2, 2, 3)`` twice."""
    t = np.arange(frames)[:, None, None, None] / 60 + rng.uniform(0, 1, (2, 2, 1))
    step = np.clip(np.sin(2 * np.pi * t), -0.2, 1) + 0.2
    path = np.concatenate([np.cumsum(0.5 * step, axis=0), 8 * step, 0.1 * step], axis=-1)
    before = path + rng.normal(0, rng.choice([0, 0.01, 0.5]), path.shape)
    after = path + 0.3 * np.sin(2 * np.pi * 3 * t) + rng.normal(0, 0.02, path.shape)
    return before, after


@given(
    seed=seeds,
    frames=lengths,
    up=st.sampled_from([1, 2, -2, -3]),
    fps=st.sampled_from([25.0, 60.0, 120.0]),
    lock=st.booleans(),
    known=st.booleans(),
    gaps=st.booleans(),
    dtype=dtypes,
)
def test_displacements(seed, frames, up, fps, lock, known, gaps, dtype):
    rng = np.random.default_rng(seed)
    before, after = (path.astype(dtype) for path in feet(rng, frames))
    if gaps:
        before[rng.random(before.shape[:3]) < 0.1] = np.nan
        after[rng.random(after.shape[:3]) < 0.05] = np.nan
        after[:, 1, 1] = np.nan
    contacts = rng.random((frames, 2, 2)) < 0.7 if known else None
    size = np.array([80.0, 30.0])
    (result, touching), (expected, standing) = (
        backend.foot_displacements(before, after, size, up, fps, contacts, lock)
        for backend in (_core, _reference)
    )
    np.testing.assert_array_equal(touching, standing)
    np.testing.assert_allclose(result, expected, rtol=0, atol=tolerances.FEET)
    assert np.isfinite(result).all()


@given(
    seed=seeds,
    frames=lengths,
    pelvis=st.sampled_from([0, 1]),
    legs=st.sampled_from([1, 2]),
    moving=st.booleans(),
    root=st.booleans(),
    lock=st.booleans(),
    gaps=st.booleans(),
    dtype=dtypes,
)
def test_placed_feet(seed, frames, pelvis, legs, moving, root, lock, gaps, dtype):
    rng = np.random.default_rng(seed)
    q = np.array([1.0, 0, 0, 0]) + rng.normal(0, 0.3, (frames, len(PARENTS), 4))
    q /= np.linalg.norm(q, axis=-1, keepdims=True)
    q[:, 3] = q[0, 3]  # a knee that never bends has no hinge
    local = rng.standard_normal((1, len(PARENTS), 3)) * 20
    if moving:
        local = local + 0.1 * rng.standard_normal((frames, len(PARENTS), 3))
    displacements = rng.standard_normal((frames, legs, 2, 3)) * (rng.random((frames, 1, 1, 1)) < 0.6)
    if gaps:
        q[rng.random(q.shape[:2]) < 0.05] = np.nan
    arguments = (
        q.astype(dtype),
        (rng.standard_normal((frames, 3)) * 50).astype(dtype),
        local.astype(dtype),
        *(PARENTS, pelvis, LEGS[:legs], np.array([40.0, 45.0])[:legs], displacements, root, lock),
    )
    results, expected = (backend.place_feet(*arguments) for backend in (_core, _reference))
    for result, other in zip(results, expected, strict=True):
        assert result.dtype == other.dtype == dtype
        scale = 1 + np.nanmax(np.abs(other), initial=0)
        np.testing.assert_allclose(result, other, rtol=0, atol=scale * tolerances.filtered(np.dtype(dtype)))


def test_legs_that_do_not_hang_together_are_refused():
    q = np.tile([1.0, 0, 0, 0], (3, len(PARENTS), 1))
    zeros = np.zeros((3, 3)), np.zeros((1, len(PARENTS), 3))
    for legs, pelvis in (
        ([[2, 4, 3, 3]], 1),
        ([[2, 3, 4, 5]], 9),
        ([[2, 3, 4, 99]], 1),
        ([[2, 3, 4, 5]], 99),
    ):
        with pytest.raises(ValueError, match=r"^legs: expected joints that hang on each other$"):
            _core.place_feet(
                q,
                *zeros,
                PARENTS,
                pelvis,
                np.array(legs, np.int64),
                np.ones(1),
                np.zeros((3, 1, 2, 3)),
                True,
                False,
            )
