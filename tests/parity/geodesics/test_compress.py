"""Compression: the core writes the reference's bytes, and reads them to the same bits."""

import clips
import numpy as np
import pytest
import tolerances
from drawn import dtypes, seeds, spoil, spoilt_clips
from hypothesis import given
from hypothesis import strategies as st
from plugins.properties import examples
from quatfilt import _core, _reference

TOLERANCES = st.sampled_from([1e-7, 1e-4, np.radians(0.1), 0.05, 4.0])


def same_bits(a, b):
    assert a.dtype == b.dtype
    assert a.shape == b.shape
    valid = np.isfinite(b).all(axis=-1)
    np.testing.assert_array_equal(np.isfinite(a).all(axis=-1), valid)
    assert a[valid].tobytes() == b[valid].tobytes()


def agree(q, tolerance, quantised):
    """Compare streams and what comes back; return the clip and the stream."""
    before = q.tobytes()
    frames, bounds = _reference.principal_frames(q), np.full(q.shape[1], tolerance)
    (stream, error), (expected, expected_error) = (
        backend.compress(q, frames, bounds, quantised) for backend in (_core, _reference)
    )
    assert q.tobytes() == before, "the input was written"
    assert stream == expected
    assert error == expected_error
    double = q.dtype == np.float64
    back, expected_back = (
        backend.decompress(stream, *q.shape[:2], double) for backend in (_core, _reference)
    )
    same_bits(back, expected_back)
    return back, stream


@examples(30)
@given(
    q=spoilt_clips(
        lengths=st.sampled_from([0, 1, 2, 3, 4, 5, 31, 33, 64, 65, 130, 300]), joints=st.sampled_from([1, 3])
    ),
    tolerance=TOLERANCES,
    quantised=st.booleans(),
)
def test_of_motion_with_missing_samples(q, tolerance, quantised):
    agree(q, tolerance, quantised)


@examples(15)
@given(seed=seeds, dtype=dtypes, tolerance=TOLERANCES)
def test_of_anything(seed, dtype, tolerance):
    rng = np.random.default_rng(seed)
    agree(spoil(rng, clips.random_rotations(rng, 200, 2), 0.02).astype(dtype), tolerance, quantised=True)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_more_joints_than_a_batch(dtype):
    rng = np.random.default_rng(5)
    agree(clips.walk(rng, 90, 35).astype(dtype), 0.01, quantised=True)


@given(data=st.binary(max_size=300), double=st.booleans())
def test_any_bytes_are_some_clip(data, double):
    back, expected = (backend.decompress(data, 40, 2, double) for backend in (_core, _reference))
    same_bits(back, expected)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("frames", [1, 2, 700, 1025, 3000])
def test_frames_of_coordinates(frames, dtype):
    rng = np.random.default_rng(frames)
    q = clips.flipped(rng, clips.noisy(rng, clips.smooth(rng, frames, 4), 0.05)).astype(dtype)
    q[:, 3] = np.nan
    result, expected = _core.principal_frames(q), _reference.principal_frames(q)
    assert result.shape == expected.shape == (4, 2, 2, 4)
    np.testing.assert_array_equal(result[3], expected[3])
    if frames > 100:
        # Of a few samples in general position the axes need not be unique.
        assert clips.angles(expected[:3], result[:3]).max() <= tolerances.PRINCIPAL_AXES_OF_SHORT_CLIPS
