"""Arrays of numbers: floats, quaternions, vectors, and pairs of them."""

from typing import Any

import numpy as np

from quatfilt._typing import Array
from quatfilt._validation.choices import switch

_WIDEST_INTEGERS = "biu"


def floats(value: Any, name: str) -> Array:
    """Return `value` as a native float32 or float64 array, without a copy where it already is one.

    Masked elements become NaN.
    """
    if isinstance(value, np.ma.MaskedArray):
        value = _unmasked(value)
    elif _is_rotation(value):  # SciPy's, scalar last
        value = np.roll(value.as_quat(), 1, axis=-1)
    elif hasattr(value, "__dlpack__") and not hasattr(value, "__array__"):
        value = np.from_dlpack(value)
    try:
        array = np.asarray(value)
    except ValueError as error:
        raise ValueError(f"{name}: expected a rectangular array of numbers ({error})") from None
    if array.dtype.kind in _WIDEST_INTEGERS:
        dtype: np.dtype[Any] = np.dtype(np.float64)
    elif array.dtype.kind == "f":
        dtype = np.dtype(np.float32 if array.dtype.itemsize <= 4 else np.float64)
    else:
        came = "None" if value is None else f"dtype {array.dtype}"
        raise TypeError(f"{name}: expected real numbers, got {came}")
    return np.require(array, dtype, ("C_CONTIGUOUS", "ALIGNED"))


def _unmasked(array: "np.ma.MaskedArray[Any, Any]") -> Any:
    """Return a masked array as an array of floats, with NaN for what is masked."""
    if array.dtype.kind in _WIDEST_INTEGERS:
        return np.ma.filled(array.astype(np.float64), np.nan)
    return array.filled(np.nan) if array.dtype.kind == "f" else array.data


def scalar_order(array: Array, *, scalar_first: bool) -> Array:
    """Return quaternions that are scalar first in the order of `scalar_first`."""
    first = switch(scalar_first, "scalar_first")
    return array if first else np.ascontiguousarray(np.roll(array, -1, axis=-1))


def quaternions(value: Any, name: str, *, scalar_first: bool = True) -> Array:
    """Return `value` as an array ``(..., 4)``, scalar first."""
    array = floats(value, name)
    if array.ndim < 1 or array.shape[-1] != 4:
        raise ValueError(f"{name}: expected shape (..., 4), got {array.shape}")
    # SciPy's rotations have an order of their own; `scalar_first` applies to the result only.
    first = switch(scalar_first, "scalar_first") or _is_rotation(value)
    return array if first else np.ascontiguousarray(np.roll(array, 1, axis=-1))


def _is_rotation(value: Any) -> bool:
    return hasattr(value, "as_quat")


def vectors(value: Any, name: str) -> Array:
    """Return `value` as an array ``(..., 3)``."""
    array = floats(value, name)
    if array.ndim < 1 or array.shape[-1] != 3:
        raise ValueError(f"{name}: expected shape (..., 3), got {array.shape}")
    return array


def pair(a: Array, b: Array, name_a: str, name_b: str) -> tuple[Array, Array]:
    """Return two arrays of rows broadcast against each other, of one dtype, C-contiguous."""
    dtype = np.result_type(a.dtype, b.dtype)
    try:
        shape = np.broadcast_shapes(a.shape, b.shape)
    except ValueError:
        raise ValueError(
            f"{name_b}: expected a shape that broadcasts with {name_a}'s {a.shape}, got {b.shape}",
        ) from None
    return (
        np.require(np.broadcast_to(a, shape), dtype, ("C_CONTIGUOUS", "ALIGNED")),
        np.require(np.broadcast_to(b, shape), dtype, ("C_CONTIGUOUS", "ALIGNED")),
    )
