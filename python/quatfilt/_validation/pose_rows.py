"""Poses as rows of numbers, clips that lie one after the other, and segments of them."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from quatfilt._typing import Array
from quatfilt._validation.arrays import floats


def features(value: Any, name: str) -> Array:
    """Return `value` as poses ``(poses, dims)``; a memory map stays one."""
    array = floats(value, name)
    if array.ndim != 2 or array.shape[1] == 0:
        raise ValueError(f"{name}: expected shape (poses, dims), got {array.shape}")
    return array


def starts(value: Any, name: str, poses: int) -> NDArray[np.int64]:
    """Return `value` as the first poses of clips, and the number of poses."""
    array = np.asarray(value)
    if array.dtype.kind not in "iu" and array.size:
        raise TypeError(f"{name}: expected integers, got dtype {array.dtype}")
    if array.ndim != 1 or len(array) == 0:
        raise ValueError(f"{name}: expected shape (clips + 1,), got {array.shape}")
    result = np.require(array, np.int64, ("C_CONTIGUOUS", "ALIGNED"))
    falls = np.flatnonzero(np.diff(result) < 0)
    if result[0] != 0 or result[-1] != poses or len(falls):
        got = (
            f"{result[falls[0] + 1]} after {result[falls[0]]}"
            if len(falls)
            else f"{result[0]} to {result[-1]}"
        )
        raise ValueError(
            f"{name}: expected indices that increase from 0 to {poses}, the number of poses, got {got}"
        )
    return result


def queries(value: Any, name: str, like: Array) -> tuple[Array, bool]:
    """Return `value` as segments ``(queries, m, dims)`` of poses as in `like`, and whether it was a single one."""
    array = floats(value, name)
    dims = like.shape[1]
    if array.ndim not in {2, 3} or array.shape[-1] != dims or array.shape[-2] == 0:
        raise ValueError(f"{name}: expected shape (queries, m, {dims}) or (m, {dims}), got {array.shape}")
    single = array.ndim == 2
    rows = array[None] if single else array
    return np.require(rows, like.dtype, ("C_CONTIGUOUS", "ALIGNED")), single


def ranges(value: Any, name: str, number: int) -> NDArray[np.int64]:
    """Return `value` as a pair of numbers for each query, or one pair for all."""
    array = np.asarray(value)
    if array.dtype.kind not in "iu":
        raise TypeError(f"{name}: expected integers, got dtype {array.dtype}")
    if array.shape not in {(2,), (number, 2)}:
        raise ValueError(f"{name}: expected shape (2,) or ({number}, 2), got {array.shape}")
    pairs = np.broadcast_to(np.clip(array, 0, None), (number, 2))
    return np.require(pairs, np.int64, ("C_CONTIGUOUS", "ALIGNED"))
