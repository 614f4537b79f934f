"""Times of frames."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from quatfilt._typing import Array
from quatfilt._validation.arrays import floats


def times(value: Any, name: str, frames: int) -> NDArray[np.float64]:
    """Return strictly increasing times, one per frame."""
    array = np.asarray(floats(value, name), np.float64)
    if array.shape != (frames,):
        raise ValueError(f"{name}: expected one time per frame, shape ({frames},), got {array.shape}")
    _finite(array, name)
    steps = np.flatnonzero(array[1:] <= array[:-1])
    if steps.size:
        at = int(steps[0])
        raise ValueError(
            f"{name}: expected strictly increasing times, got {array[at + 1]:g} after {array[at]:g} at index {at + 1}"
        )
    return array


def times_within(value: Any, name: str, span: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return times ``(n,)`` from the first to the last of `span`."""
    array = np.asarray(floats(value, name), np.float64)
    if array.ndim != 1:
        raise ValueError(f"{name}: expected shape (n,), got {array.shape}")
    _finite(array, name)
    if not span.size and array.size:
        raise ValueError(f"{name}: expected no times, since there are no frames, got {array.size}")
    outside = np.flatnonzero((array < span[0]) | (array > span[-1])) if array.size else array
    if outside.size:
        at = int(outside[0])
        raise ValueError(
            f"{name}: expected times from {span[0]:g} to {span[-1]:g}, got {array[at]:.17g} at index {at}"
        )
    return array


def _finite(array: Array, name: str) -> None:
    odd = np.flatnonzero(~np.isfinite(array))
    if odd.size:
        raise ValueError(f"{name}: expected finite times, got {array[odd[0]]} at index {int(odd[0])}")
