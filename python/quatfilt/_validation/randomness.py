"""Sources of random numbers."""

from typing import Any

import numpy as np

from quatfilt._validation.numbers import integer


def generator(value: Any, name: str) -> np.random.Generator:
    """Return a generator of random numbers: `value`, or a new one of that seed."""
    if isinstance(value, np.random.Generator):
        return value
    if isinstance(value, (bool, np.bool_)) or not isinstance(value, (int, np.integer)):
        raise TypeError(f"{name}: expected a numpy.random.Generator or a seed, got {type(value).__name__}")
    return np.random.default_rng(integer(value, name, at_least=0))
