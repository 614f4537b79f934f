"""The algebra of quaternions and the scan of a clip: the core against the reference."""

import clips
import numpy as np
import pytest
import tolerances
from drawn import dtypes, lengths, seeds, spoilt_clips
from hypothesis import given
from hypothesis import strategies as st
from quatfilt import _core, _reference

UNARY = {"conjugate": 4, "exp": 3, "log": 4, "normalize": 4}
"""Functions of one array, and the length of its rows."""

BINARY = ["geodesic_distance", "multiply"]

rows = st.one_of(st.integers(0, 70), st.sampled_from([127, 128, 129, 1000, 4097]))
"""Numbers of rows around the widths of vectors and blocks."""


def both(name, *arrays):
    """Return what the core and the reference make of the same arrays, which they do not write."""
    before = [array.tobytes() for array in arrays]
    with np.errstate(all="ignore"):
        result, expected = (getattr(backend, name)(*arrays) for backend in (_core, _reference))
    assert [array.tobytes() for array in arrays] == before, "the input was written"
    assert result.dtype == expected.dtype
    assert result.shape == expected.shape
    return result, expected


SMALLEST = -11.0
"""Exponent of the smallest angles. Below 2e-12 rad the core's float32 logarithm takes a quaternion with ``w < 0`` for −1."""


def turned_by(rng, rows, dtype):
    """Unit quaternions with random signs, whose angles lie near 0, near π and anywhere between."""
    near = 10.0 ** rng.uniform(SMALLEST, 0, rows)
    angle = np.choose(rng.integers(0, 3, rows), [near, np.pi - near, rng.uniform(0, np.pi, rows)])
    axis = rng.standard_normal((rows, 3))
    axis /= np.linalg.norm(axis, axis=-1, keepdims=True)
    return clips.flipped(rng, clips.from_vectors(angle[:, None] * axis)).astype(dtype)


@pytest.mark.parametrize("name", UNARY)
@given(seed=seeds, rows=rows, dtype=dtypes)
def test_functions_of_one_array(name, seed, rows, dtype):
    rng = np.random.default_rng(seed)
    q = turned_by(rng, rows, dtype)
    if name == "exp":
        # A float32 angle of several turns has lost digits before anybody computes with it.
        q = (np.pi * q[:, 1:]).astype(dtype)
    if name == "normalize":
        q *= rng.uniform(0.1, 10, (rows, 1)).astype(dtype)
    result, expected = both(name, q)
    np.testing.assert_allclose(result, expected, rtol=0, atol=tolerances.algebra(dtype))


@pytest.mark.parametrize("name", BINARY)
@given(seed=seeds, rows=rows, dtype=dtypes)
def test_functions_of_two_arrays(name, seed, rows, dtype):
    rng = np.random.default_rng(seed)
    a = clips.random_rotations(rng, rows).astype(dtype)
    b = clips.product(a, turned_by(rng, rows, np.float64)).astype(dtype)
    result, expected = both(name, a, b)
    np.testing.assert_allclose(result, expected, rtol=0, atol=tolerances.algebra(dtype))


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("name", ["exp", "log"])
def test_small_angles_keep_their_digits(name, dtype):
    exponents = np.arange(np.log10(np.finfo(dtype).tiny) + 1, 0, 0.25)
    vectors = 10 ** exponents[:, None] * np.array([0.6, 0, -0.8])
    array = vectors if name == "exp" else np.concatenate([np.ones((len(vectors), 1)), vectors], axis=1)
    result, expected = both(name, array.astype(dtype))
    np.testing.assert_allclose(result[:, -3:], expected[:, -3:], rtol=tolerances.algebra(dtype), atol=0)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("name", [*UNARY, *BINARY])
def test_what_is_no_number_is_none_in_both(name, dtype):
    odd = np.array([0.0, -0.0, 1.0, -1.0, np.nan, np.inf, -np.inf])
    array = np.stack(np.meshgrid(*[odd] * UNARY.get(name, 4)), axis=-1).reshape(-1, UNARY.get(name, 4))
    array = array.astype(dtype)
    result, expected = both(name, *([array] if name in UNARY else [array, np.full_like(array, 0.5)]))
    usable = np.isfinite(array).all(axis=-1)
    broken = np.isnan(array).any(axis=-1)
    assert np.isnan(result[broken]).reshape(np.count_nonzero(broken), -1).any(axis=-1).all()
    np.testing.assert_allclose(
        result[usable], expected[usable], rtol=0, atol=tolerances.algebra(dtype), equal_nan=True
    )


def agree(q):
    """Compare the scans; of samples that are equally bad up to roundings either may be the worst."""
    missing, worst, index = _core.scan(q)
    expected_missing, expected_worst, expected_index = _reference.scan(q)
    assert missing == expected_missing
    tolerance = tolerances.algebra(q.dtype)
    np.testing.assert_allclose(worst, expected_worst, rtol=tolerance, atol=tolerance)
    if index != expected_index:
        norm = np.linalg.norm(q.reshape(-1, 4)[index].astype(np.float64))
        np.testing.assert_allclose(abs(norm - 1), expected_worst, rtol=tolerance, atol=tolerance)


@given(q=spoilt_clips())
def test_scan(q):
    before = q.tobytes()
    agree(q)
    assert q.tobytes() == before, "the input was written"


@given(seed=seeds, frames=lengths, dtype=dtypes, low=st.booleans(), high=st.booleans())
def test_one_bad_sample(seed, frames, dtype, low, high):
    rng = np.random.default_rng(seed)
    q = rng.standard_normal((frames, 3, 4))
    q /= np.linalg.norm(q, axis=-1, keepdims=True)
    flat = q.reshape(-1, 4)
    for present, scale in ((low, 0.8), (high, 1.3)):
        if present and frames:
            flat[rng.integers(len(flat))] *= scale
    q = q.astype(dtype)
    agree(q)
    if (low or high) and frames:
        assert _core.scan(q)[2] == _reference.scan(q)[2]


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("where", [0, 1, 65_536, 199_999])
@pytest.mark.parametrize("odd", [[0, 0, 0, 1.5], [np.nan, 0, 0, 1], [0, 0, 0, 0], [np.inf, 0, 0, 0]])
def test_across_tiles(dtype, where, odd):
    q = np.zeros((200_000, 1, 4), dtype)
    q[..., 2] = 1
    q[where] = odd
    assert _core.scan(q) == _reference.scan(q)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("size", [1e-30, 1e-200, 1e25, 1e30, 1e200])
def test_squares_that_overflow_or_vanish(dtype, size):
    with np.errstate(over="ignore"):
        q = np.tile(np.array([0, 0.6, 0, 0.8]), (100, 1, 1)).astype(dtype)
        q[[37, 63]] = np.array([[size / 2, 0, 0, 0], [0, size, 0, 0]])[:, None].astype(dtype)
    agree(q)
