"""A strength: one number, or one per joint."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from quatfilt._validation.arrays import floats
from quatfilt._validation.numbers import number

_LOWEST_FREQUENCY = 1e-6
"""Periods per frame: the coefficients of filters for lower ones have lost too many digits."""

_RATE_MISSING = "; pass the frame rate to give it in hertz, for example fps=30 (frames per second)"
"""Hint where `fps` has its default 1, so that frequencies are per frame."""


def per_joint(
    value: Any,
    name: str,
    joints: int,
    *,
    above: float | None = None,
    at_least: float | None = None,
    at_most: float | None = None,
    infinite: bool = False,
) -> NDArray[np.float64]:
    """Return a number, or one number per joint, as a float64 array ``(joints,)``."""
    bounds = {"above": above, "at_least": at_least, "at_most": at_most}
    if np.isscalar(value):
        return np.full(joints, number(value, name, **bounds, infinite=infinite))
    if value is None:
        raise TypeError(f"{name}: expected a number or one per joint, got None")
    array = floats(value, name).astype(np.float64)
    if array.ndim == 0:
        return np.full(joints, number(array.item(), name, **bounds, infinite=infinite))
    if array.shape != (joints,):
        raise ValueError(f"{name}: expected a number or one per joint, shape ({joints},), got {array.shape}")
    for joint, one in enumerate(array):
        number(one, f"{name}[{joint}]", **bounds, infinite=infinite)
    return array


def frequencies(value: Any, name: str, joints: int, fps: float) -> NDArray[np.float64]:
    """Return a frequency below the Nyquist frequency, or one per joint, as a float64 array ``(joints,)``."""
    array = per_joint(value, name, joints, above=0)
    lowest, nyquist = _LOWEST_FREQUENCY * fps, fps / 2
    for joint, one in enumerate(array):
        if not lowest <= one < nyquist:
            place = name if np.ndim(value) == 0 else f"{name}[{joint}]"
            raise ValueError(
                f"{place}: expected a number of at least {lowest:g} and below the Nyquist frequency "
                f"fps / 2 = {nyquist:g}, got {one:g}{_RATE_MISSING if fps == 1 and one >= nyquist else ''}"
            )
    return array
