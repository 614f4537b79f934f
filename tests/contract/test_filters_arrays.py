"""Which arrays filters take, what they refuse and in which words, and what they leave alone."""

import clips
import numpy as np
import pytest
import tolerances
from contract.filters import FILTERS, FRAMES, clip, every_filter, every_filter_of_all_samples, refused
from layouts import LAYOUTS
from scipy.spatial.transform import Rotation

# ---- shapes and types of rotations


@pytest.mark.parametrize("shape", [(), (0,), (5, 3), (5, 3, 3), (4, 5), (2, 0)])
@every_filter
def test_rows_that_are_no_quaternions(name, shape):
    message = refused(ValueError, FILTERS[name], np.zeros(shape))
    assert message == f"rotations: expected shape (..., 4), got {shape}"


@pytest.mark.parametrize("shape", [(4,), (2, 5, 3, 4)])
@every_filter
def test_arrays_that_are_no_clip(name, shape):
    message = refused(ValueError, FILTERS[name], np.ones(shape) / 2)
    assert message == f"rotations: expected shape (frames, joints, 4) or (frames, 4), got {shape}"


@pytest.mark.parametrize(
    ("value", "came"),
    [
        (np.zeros((5, 4), np.complex128), "dtype complex128"),
        (np.zeros((5, 4), "datetime64[s]"), "dtype datetime64[s]"),
        (np.full((5, 4), None), "dtype object"),
        ([["1", "0", "0", "0"]], "dtype <U1"),
        ("walk.bvh", "dtype <U8"),
        (None, "None"),
    ],
)
@every_filter
def test_what_is_no_number(name, value, came):
    message = refused(TypeError, FILTERS[name], value)
    assert message == f"rotations: expected real numbers, got {came}"


@every_filter
def test_ragged_lists(name):
    message = refused(ValueError, FILTERS[name], [[1.0, 0, 0, 0], [1.0, 0]])
    assert message.startswith("rotations: expected a rectangular array of numbers (")


@pytest.mark.parametrize("shape", [(0, 4), (0, 3, 4), (5, 0, 4), (0, 0, 4)])
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@every_filter
def test_nothing_comes_back(name, shape, dtype):
    result = FILTERS[name](np.zeros(shape, dtype))
    assert result.shape == shape
    assert result.dtype == dtype


@pytest.mark.parametrize("sample", [[-0.6, 0.0, 0.8, 0.0], [np.nan] * 4, [0.0] * 4, [0.63, 0.0, 0.8, 0.0]])
@every_filter
def test_one_frame_comes_back_unchanged(name, sample):
    q = np.array([[sample, [1.0, 0, 0, 0]]])
    result = FILTERS[name](q)
    np.testing.assert_array_equal(result, q)
    assert not np.shares_memory(result, q)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("layout", LAYOUTS)
@every_filter
def test_the_layout_does_not_matter(name, layout, dtype):
    plain = clip().astype(dtype)
    other = LAYOUTS[layout](plain)
    before = other.tobytes()
    result = FILTERS[name](other)
    np.testing.assert_array_equal(result, FILTERS[name](plain))
    assert result.dtype == dtype
    assert result.dtype.isnative
    assert result.flags.c_contiguous
    assert result.flags.writeable
    assert not np.shares_memory(result, other)
    assert other.tobytes() == before, "the input was written"


@pytest.mark.parametrize("dtype", [np.int8, np.int64, np.uint16, np.bool_])
@every_filter
def test_integers_become_float64(name, dtype):
    q = np.zeros((20, 2, 4), dtype)
    q[..., 1] = 1
    result = FILTERS[name](q)
    assert result.dtype == np.float64
    np.testing.assert_array_equal(result, q)


@pytest.mark.parametrize(("dtype", "expected"), [(np.float16, np.float32), (np.longdouble, np.float64)])
@every_filter
def test_other_floats(name, dtype, expected):
    q = clip().astype(dtype)
    result = FILTERS[name](q)
    assert result.dtype == expected
    np.testing.assert_array_equal(result, FILTERS[name](q.astype(expected)))


class WithArray:
    """As a torch tensor on the CPU."""

    def __init__(self, array):
        self.array = array

    def __array__(self, dtype=None):
        return self.array if dtype is None else self.array.astype(dtype)


class WithDlpack:
    """As an array of a library that NumPy does not know."""

    def __init__(self, array):
        self.array = array

    def __dlpack__(self, **options):
        return self.array.__dlpack__(**options)

    def __dlpack_device__(self):
        return self.array.__dlpack_device__()


@pytest.mark.parametrize("wrap", [np.ndarray.tolist, WithArray, WithDlpack, memoryview])
@every_filter
def test_whatever_becomes_an_array(name, wrap):
    q = clip()
    np.testing.assert_array_equal(FILTERS[name](wrap(q)), FILTERS[name](q))


@pytest.mark.parametrize("scalar_first", [True, False])
@every_filter
def test_scipy_rotations(name, scalar_first):
    q = clip(joints=1)[:, 0]
    rotations = Rotation.from_quat(q, scalar_first=True)
    result = FILTERS[name](rotations, scalar_first=scalar_first)
    expected = FILTERS[name](rotations.as_quat(scalar_first=scalar_first), scalar_first=scalar_first)
    np.testing.assert_array_equal(result, expected)
    back = Rotation.from_quat(result, scalar_first=scalar_first)
    assert (back.inv() * rotations).magnitude().max() < 0.3


@every_filter
def test_scalar_last(name):
    q = clip()
    result = FILTERS[name](np.roll(q, -1, axis=-1), scalar_first=False)
    np.testing.assert_array_equal(result, np.roll(FILTERS[name](q), -1, axis=-1))


@every_filter
def test_a_single_series_is_one_joint(name):
    q = clip(joints=1)
    np.testing.assert_array_equal(FILTERS[name](q[:, 0]), FILTERS[name](q)[:, 0])


# ---- lengths and signs of quaternions


@pytest.mark.parametrize("scale", [0.92, 1.08])
@every_filter_of_all_samples
def test_lengths_near_one_are_normalised(name, scale):
    q = clip()
    result = FILTERS[name](scale * q)
    np.testing.assert_allclose(np.linalg.norm(result, axis=-1), 1, atol=tolerances.ALGEBRA)
    # The length of the first quaternions is lost in the last digit.
    assert clips.angles(result, FILTERS[name](q)).max() < tolerances.FLOAT64


@pytest.mark.parametrize(("scale", "norm"), [(0.5, "0.5"), (2.0, "2"), (1.125, "1.125"), (1e200, "1e+200")])
@every_filter
def test_lengths_far_from_one_are_refused(name, scale, norm):
    q = np.tile([0.0, 0.0, -1.0, 0.0], (FRAMES, 3, 1))
    q[17, 2] *= scale
    message = refused(ValueError, FILTERS[name], q)
    assert message == f"rotations: expected unit quaternions, got norm {norm} at frame 17, joint 2"


@every_filter
def test_signs_do_not_matter(name):
    q = clip()
    flipped = clips.flipped(np.random.default_rng(1), q)
    flipped[0] = q[0]
    np.testing.assert_array_equal(FILTERS[name](flipped), FILTERS[name](q))
