"""Numbers within their bounds."""

import math
from typing import Any

import numpy as np


def number(
    value: Any,
    name: str,
    *,
    above: float | None = None,
    at_least: float | None = None,
    at_most: float | None = None,
    infinite: bool = False,
) -> float:
    """Return `value` as a float within its bounds; finite, unless it may be `infinite`.

    An array without dimensions is a number: so are those that ``np.load`` reads.
    """
    expected = "a number" + _bounds(above, at_least, at_most)
    if isinstance(value, np.ndarray) and value.ndim == 0:
        value = value[()]
    if isinstance(value, (bool, np.bool_, str)) or not np.isscalar(value):
        raise TypeError(f"{name}: expected {expected}, got {type(value).__name__}")
    try:
        result = float(value)  # type: ignore[arg-type]
    except (TypeError, ValueError):
        raise TypeError(f"{name}: expected {expected}, got {type(value).__name__}") from None
    if (
        math.isnan(result)
        or not (infinite or math.isfinite(result))
        or not _within(result, above, at_least, at_most)
    ):
        raise ValueError(f"{name}: expected {expected}, got {value!s}")
    return result


def integer(value: Any, name: str, *, at_least: int | None = None, at_most: int | None = None) -> int:
    """Return `value` as an int within its bounds."""
    expected = "an integer" + _bounds(None, at_least, at_most)
    if isinstance(value, (bool, np.bool_)) or not isinstance(value, (int, np.integer)):
        raise TypeError(f"{name}: expected {expected}, got {type(value).__name__}")
    result = int(value)
    if not _within(result, None, at_least, at_most):
        raise ValueError(f"{name}: expected {expected}, got {value}")
    return result


def odd(value: Any, name: str) -> int:
    """Return `value` as an odd int of at least 1."""
    result = integer(value, name, at_least=1)
    if result % 2 == 0:
        raise ValueError(f"{name}: expected an odd number, got {result}")
    return result


def interval(
    value: Any, name: str, *, at_least: float | None = None, at_most: float | None = None
) -> tuple[float, float]:
    """Return two numbers `(low, high)`, in this order and within their bounds."""
    try:
        low, high = value
    except (TypeError, ValueError):
        raise TypeError(f"{name}: expected two numbers (low, high), got {value!r}") from None
    low = number(low, f"{name}[0]", at_least=at_least, at_most=at_most)
    high = number(high, f"{name}[1]", at_least=at_least, at_most=at_most)
    if low > high:
        raise ValueError(f"{name}: expected two numbers (low, high) in this order, got {value!r}")
    return low, high


def _bounds(above: float | None, at_least: float | None, at_most: float | None) -> str:
    parts = [
        f"above {above:g}" if above is not None else "",
        f"of at least {at_least:g}" if at_least is not None else "",
        f"at most {at_most:g}" if at_most is not None else "",
    ]
    text = " and ".join(part for part in parts if part)
    return f" {text}" if text else ""


def _within(value: float, above: float | None, at_least: float | None, at_most: float | None) -> bool:
    return (
        (above is None or value > above)
        and (at_least is None or value >= at_least)
        and (at_most is None or value <= at_most)
    )
