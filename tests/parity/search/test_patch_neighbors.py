"""Patch search: the core against the reference."""

import clips
import numpy as np
import patches
import pytest
import tolerances
from drawn import dtypes, seeds, spoilt_clips
from hypothesis import given
from hypothesis import strategies as st
from plugins.properties import examples
from quatfilt import _core, _reference

lengths = st.one_of(st.integers(0, 5), st.integers(6, 40), st.sampled_from([63, 64, 65, 130, 300]))
"""Below and above the length from which diagonals are passed over, and beyond a task."""

joints = st.sampled_from([1, 2, 5])


def agree(q, library=None, **options):
    found, expected = (patches.neighbors(b, q, library, **options) for b in (_core, _reference))
    exact = patches.all_distances(
        _reference, q, library, **{key: value for key, value in options.items() if key != "k"}
    )
    patches.same_neighbors(found, expected, exact, tolerances.filtered(q.dtype))


@given(
    q=spoilt_clips(lengths=lengths, joints=joints),
    radius=st.sampled_from([0, 1, 5, 12]),
    k=st.sampled_from([1, 3, 16, 400]),
    exclusion=st.sampled_from([0, 1, 5, 500]),
    seed=seeds,
)
def test_in_the_clip_itself(q, radius, k, exclusion, seed):
    weights = np.random.default_rng(seed).choice([0.0, 0.5, 3.0], q.shape[1])
    weights[0] = 1
    agree(q, radius=radius, k=k, exclusion=exclusion, weights=weights)


@given(
    q=spoilt_clips(lengths=lengths, joints=st.just(2)),
    library=st.lists(spoilt_clips(lengths=lengths, joints=st.just(2)), min_size=1, max_size=3),
    radius=st.sampled_from([0, 3]),
)
def test_in_other_clips(q, library, radius):
    agree(q, library, radius=radius)


@examples(20)
@given(dtype=dtypes, seed=seeds, turns=st.sampled_from([0, 0.5, 3]), speed=st.sampled_from([1, 4, 20]))
def test_complete_clips_with_much_and_little_to_pass_over(dtype, seed, turns, speed):
    rng = np.random.default_rng(seed)
    q = clips.turning(rng, 240, 2, turns=turns)[::speed]
    q = clips.flipped(rng, np.concatenate([q, q[::-1], clips.noisy(rng, q[:60], 0.01)])).astype(dtype)
    agree(q, exclusion=10)
    agree(q[: len(q) // 2], [q[len(q) // 2 :], q[:30]])


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_poses_that_tie(dtype):
    """Repetitions to the last bit: the lower number comes first, whatever is passed over."""
    rng = np.random.default_rng(3)
    q = np.tile(clips.random_rotations(rng, 40, 2), (6, 1, 1)).astype(dtype)
    for candidates in (q, q[:50]):
        library = None if candidates is q else [candidates, q]
        options = {"k": 7, "exclusion": 0, "radius": 1}
        found, expected = (patches.neighbors(b, q, library, **options) for b in (_core, _reference))
        same = expected[1] < 1e-3
        np.testing.assert_array_equal(found[0][same], expected[0][same])
        assert same[1:-1, :4].all()
    still = np.tile(clips.random_rotations(rng, 1, 2), (200, 1, 1)).astype(dtype)
    found, expected = (patches.neighbors(b, still) for b in (_core, _reference))
    np.testing.assert_array_equal(found[0], expected[0])
