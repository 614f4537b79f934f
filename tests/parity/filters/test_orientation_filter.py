"""Lee and Shin's orientation filters: the core against the reference."""

import clips
import drawn
import numpy as np
import pytest
import quatfilt as qf
import tolerances
from drawn import same_samples, seeds
from hypothesis import given
from hypothesis import strategies as st
from layouts import LAYOUTS
from quatfilt import _core, _reference

DTYPES = [np.float32, np.float64]
BOUNDARIES = ["nearest", "mirror", "linear"]
MASKS = [[2.0], [1, 2, 1], [1, 4, 6, 4, 1], [-3, 12, 17, 12, -3], [0, 0, 1, 3, 9]]


def noisy(rng, frames, joints, sigma=0.05):
    """A clip with random signs to filter."""
    return clips.flipped(rng, clips.noisy(rng, clips.smooth(rng, frames, joints, swing=2), sigma))


def agree(q, mask, iterations=1, boundary="mirror", translation=None):
    mask = np.asarray(mask, np.float64)
    translation = None if translation is None else np.require(translation, q.dtype, "C")
    arguments = (q, translation, mask, iterations, boundary)
    before = [x.tobytes() for x in arguments[:3] if x is not None]
    (result, moved), (expected, path) = (
        backend.orientation_filter(*arguments) for backend in (_core, _reference)
    )
    assert [x.tobytes() for x in arguments[:3] if x is not None] == before, "an input was written"
    assert result.dtype == expected.dtype == q.dtype
    assert result.shape == expected.shape == q.shape
    tolerance = tolerances.filtered(q.dtype)
    same_samples(result, expected, tolerance)
    if path is None:
        assert moved is None
    else:
        assert moved.dtype == path.dtype
        np.testing.assert_allclose(moved, path, rtol=0, atol=tolerance)


@given(
    seed=seeds,
    frames=st.one_of(st.integers(0, 5), st.integers(6, 90)),
    joints=st.sampled_from([0, 1, 2, 3, 17]),
    dtype=drawn.dtypes,
    mask=st.sampled_from(MASKS),
    iterations=st.integers(1, 4),
    boundary=st.sampled_from(BOUNDARIES),
    along=st.booleans(),
)
def test_any_options(seed, frames, joints, dtype, mask, iterations, boundary, along):
    rng = np.random.default_rng(seed)
    q = noisy(rng, frames, max(joints, 1), 0.1)[:, :joints]
    translation = clips.path(rng, frames) if along else None
    agree(np.ascontiguousarray(q, dtype), mask, iterations, boundary, translation)


@pytest.mark.parametrize("dtype", DTYPES)
@pytest.mark.parametrize(("joints", "lengths"), [(1, [2047, 2048, 2049]), (31, [127, 129, 319, 321, 577])])
def test_around_the_ends_of_tiles(joints, lengths, dtype):
    for frames in lengths:
        rng = np.random.default_rng(frames)
        q = noisy(rng, frames, joints).astype(dtype)
        agree(q, MASKS[2], 2, translation=clips.path(rng, frames))


@pytest.mark.parametrize("dtype", DTYPES)
@pytest.mark.parametrize("boundary", BOUNDARIES)
@pytest.mark.parametrize("frames", [2, 3, 12, 400])
def test_long_masks(frames, boundary, dtype):
    """One pass: held velocities carry a rounding of the ends over the whole mask, and each pass does so again."""
    mask = np.random.default_rng(1).uniform(0, 1, 61)
    agree(noisy(np.random.default_rng(2), frames, 3).astype(dtype), mask, 1, boundary)


@pytest.mark.parametrize("dtype", DTYPES)
@pytest.mark.parametrize("layout", LAYOUTS)
def test_layouts(layout, dtype):
    plain = noisy(np.random.default_rng(3), 80, 3).astype(dtype)
    result = qf.orientation_filter(LAYOUTS[layout](plain), MASKS[2])
    assert result.dtype == dtype
    np.testing.assert_array_equal(result, qf.orientation_filter(plain, MASKS[2]))


@given(
    q=drawn.spoilt_clips(lengths=st.integers(0, 60), joints=st.sampled_from([1, 3, 5])),
    gaps=st.sampled_from(["fill", "keep"]),
    max_gap=st.sampled_from([None, 0, 1, 3, 1000]),
)
def test_missing_samples(q, gaps, max_gap):
    result = qf.orientation_filter(q, MASKS[1], gaps=gaps, max_gap=max_gap)
    with qf.use_backend("numpy"):
        expected = qf.orientation_filter(q, MASKS[1], gaps=gaps, max_gap=max_gap)
    same_samples(result, expected, tolerances.filtered(result.dtype))
