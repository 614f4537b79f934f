"""What the functions of rotations take and return: layouts, types, messages word for word, ownership."""

import numpy as np
import pytest
import quatfilt as qf
from layouts import LAYOUTS
from scipy.spatial.transform import Rotation

UNARY = {
    "conjugate": (qf.conjugate, 4),
    "exp": (qf.exp, 3),
    "log": (qf.log, 4),
    "normalize": (qf.normalize, 4),
}
"""Functions of one array, and the length of its last axis."""

BINARY = {"geodesic_distance": qf.geodesic_distance, "multiply": qf.multiply}
"""Functions of two arrays of quaternions."""

NAMES = [*UNARY, *BINARY]


def width(name):
    return UNARY[name][1] if name in UNARY else 4


def call(name, array):
    """Call the function, with `array` as every argument but the last, which is the array backwards."""
    if name in UNARY:
        return UNARY[name][0](array)
    return BINARY[name](array, array[::-1])


def rows(name, dtype=np.float64, shape=(6, 5)):
    values = np.random.default_rng(3).standard_normal((*shape, width(name)))
    return values.astype(dtype)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("layout", LAYOUTS)
@pytest.mark.parametrize("name", NAMES)
def test_the_layout_does_not_matter(name, layout, dtype):
    plain = rows(name, dtype)
    other = LAYOUTS[layout](plain)
    assert np.array_equal(other, plain)
    before = other.tobytes()
    result = call(name, other)
    assert result.dtype == dtype
    assert result.dtype.isnative
    assert result.tobytes() == call(name, plain).tobytes()
    assert other.tobytes() == before, "the input was written"


@pytest.mark.parametrize(
    ("dtype", "expected"),
    [
        (np.float16, np.float32),
        (np.float32, np.float32),
        (np.float64, np.float64),
        (np.longdouble, np.float64),
        (np.int8, np.float64),
        (np.int64, np.float64),
        (np.uint16, np.float64),
        (np.bool_, np.float64),
    ],
)
@pytest.mark.parametrize("name", NAMES)
def test_types(name, dtype, expected):
    array = np.ones((3, width(name)), dtype)
    result = call(name, array)
    assert result.dtype == expected
    assert np.array_equal(result, call(name, array.astype(expected)))


@pytest.mark.parametrize("name", BINARY)
def test_mixed_types_widen(name):
    a, b = rows(name, np.float32), rows(name, np.float64)
    assert BINARY[name](a, b).dtype == np.float64
    assert np.array_equal(BINARY[name](a, b), BINARY[name](a.astype(np.float64), b))


@pytest.mark.parametrize("name", NAMES)
def test_lists_and_objects_with_an_array(name):
    array = rows(name)

    class Wrapped:
        def __array__(self, dtype=None, copy=None):
            return array

    if name in UNARY:
        function = UNARY[name][0]
        assert np.array_equal(function(array.tolist()), function(array))
        assert np.array_equal(function(Wrapped()), function(array))
    else:
        function = BINARY[name]
        assert np.array_equal(function(array.tolist(), Wrapped()), function(array, array))


@pytest.mark.parametrize("name", [name for name in NAMES if name != "exp"])
def test_scipy_rotations(name):
    rotation = Rotation.random(7, rng=np.random.default_rng(5))
    array = np.roll(rotation.as_quat(), 1, axis=-1)
    if name in UNARY:
        assert np.array_equal(UNARY[name][0](rotation), UNARY[name][0](array))
    else:
        assert np.array_equal(BINARY[name](rotation, array), BINARY[name](array, rotation))


@pytest.mark.parametrize("name", NAMES)
def test_scalar_last(name):
    array = rows(name)
    last = np.roll(array, -1, axis=-1)
    if name == "exp":
        result, expected = qf.exp(array, scalar_first=False), np.roll(qf.exp(array), -1, axis=-1)
    elif name in UNARY:
        result, expected = UNARY[name][0](last, scalar_first=False), UNARY[name][0](array)
    else:
        result = BINARY[name](last, last[::-1], scalar_first=False)
        expected = BINARY[name](array, array[::-1])
    if name in ("conjugate", "multiply", "normalize"):
        expected = np.roll(expected, -1, axis=-1)
    assert np.array_equal(result, expected)


@pytest.mark.parametrize("shape", [(), (1,), (0,), (3, 0), (0, 2), (1, 1, 1, 2), (2, 3, 1, 4)])
@pytest.mark.parametrize("name", NAMES)
def test_any_number_of_axes(name, shape):
    array = rows(name, shape=shape)
    last = {"log": (3,), "geodesic_distance": ()}.get(name, (4,))
    result = UNARY[name][0](array) if name in UNARY else BINARY[name](array, array)
    assert np.shape(result) == shape + last


@pytest.mark.parametrize("name", BINARY)
def test_broadcasting(name):
    a, b = rows(name, shape=(6, 1)), rows(name, shape=(5,))
    full_a, full_b = np.broadcast_arrays(a, b)
    assert np.array_equal(BINARY[name](a, b), BINARY[name](full_a.copy(), full_b.copy()))


@pytest.mark.parametrize("name", NAMES)
def test_results_are_fresh_and_own_their_data(name):
    array = rows(name, np.float64)
    before = array.copy()
    result = call(name, array)
    assert not np.shares_memory(result, array)
    assert result.flags.c_contiguous
    assert result.flags.writeable
    owner = result
    while isinstance(owner.base, np.ndarray):
        owner = owner.base
    assert owner.flags.owndata
    assert owner.base is None
    result[...] = 7
    assert np.array_equal(array, before)
    assert not np.array_equal(call(name, array), result)


WRONG_LENGTH = [(3, 5), (2, 1), (4, 0), (6, 2)]


@pytest.mark.parametrize("shape", [(), *WRONG_LENGTH])
@pytest.mark.parametrize("name", UNARY)
def test_wrong_shapes(name, shape):
    argument = "v" if name == "exp" else "q"
    with pytest.raises(ValueError) as caught:
        UNARY[name][0](np.zeros(shape))
    assert str(caught.value) == f"{argument}: expected shape (..., {width(name)}), got {shape}"


@pytest.mark.parametrize("shape", [(), *WRONG_LENGTH])
@pytest.mark.parametrize("name", BINARY)
def test_wrong_shapes_of_pairs(name, shape):
    right = np.ones((2, 4))
    for argument, pair in (("a", (np.zeros(shape), right)), ("b", (right, np.zeros(shape)))):
        with pytest.raises(ValueError) as caught:
            BINARY[name](*pair)
        assert str(caught.value) == f"{argument}: expected shape (..., 4), got {shape}"


@pytest.mark.parametrize("name", BINARY)
def test_shapes_that_do_not_broadcast(name):
    with pytest.raises(ValueError) as caught:
        BINARY[name](np.ones((3, 4)), np.ones((2, 4)))
    assert str(caught.value) == "b: expected a shape that broadcasts with a's (3, 4), got (2, 4)"


@pytest.mark.parametrize(
    ("value", "message"),
    [
        (np.zeros((2, 4), np.complex128), "expected real numbers, got dtype complex128"),
        (np.zeros((2, 4), object), "expected real numbers, got dtype object"),
        (np.zeros((2, 4), "datetime64[s]"), "expected real numbers, got dtype datetime64[s]"),
        (["1", "0", "0", "0"], "expected real numbers, got dtype <U1"),
        (None, "expected real numbers, got None"),
    ],
)
@pytest.mark.parametrize("name", NAMES)
def test_wrong_types(name, value, message):
    argument = {"exp": "v", "geodesic_distance": "b", "multiply": "b"}.get(name, "q")
    arguments = [value] if name in UNARY else [np.ones(4), value]
    with pytest.raises(TypeError) as caught:
        getattr(qf, name)(*arguments)
    assert str(caught.value) == f"{argument}: {message}"


@pytest.mark.parametrize("name", UNARY)
def test_ragged_lists(name):
    argument = "v" if name == "exp" else "q"
    with pytest.raises(ValueError, match=rf"^{argument}: expected a rectangular array of numbers \("):
        UNARY[name][0]([[1.0, 0.0, 0.0, 0.0], [1.0, 0.0]])


@pytest.mark.parametrize("name", NAMES)
def test_options_are_keyword_only(name):
    arguments = [rows(name)] if name in UNARY else [rows(name), rows(name)]
    with pytest.raises(TypeError):
        getattr(qf, name)(*arguments, True)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("name", NAMES)
def test_values_that_are_not_finite_stay_in_their_rows(name, dtype):
    array = rows(name, dtype, shape=(200,))
    expected = np.array(call(name, array))
    for row, value in ((3, np.nan), (70, np.inf), (150, -np.inf)):
        array[row, 0] = value
    result = call(name, array)
    touched = np.zeros(200, bool)
    touched[[3, 70, 150]] = True
    if name in BINARY:
        touched |= touched[::-1]
    assert np.array_equal(result[~touched], expected[~touched])
    assert np.isnan(result[3]).any()
