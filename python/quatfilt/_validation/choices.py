"""One of several names, or of True and False."""

from collections.abc import Collection, Mapping
from types import MappingProxyType
from typing import Any, TypeVar

import numpy as np

_Choice = TypeVar("_Choice", bound=str)


def choice(
    value: Any,
    name: str,
    options: tuple[_Choice, ...],
    *,
    elsewhere: Mapping[str, str] = MappingProxyType({}),
) -> _Choice:
    """Return `value` if it is one of `options`; `elsewhere` gives the reason why a value that other functions accept is refused here."""
    for option in options:
        if isinstance(value, str) and value == option:
            return option
    reason = elsewhere.get(value) if isinstance(value, str) else None
    expected = f"{name}: expected one of {', '.join(map(repr, options))}, got {value!r}"
    raise ValueError(f"{expected}: {reason}" if reason else expected)


def switch(value: Any, name: str) -> bool:
    """Return `value` if it is True or False."""
    if isinstance(value, (bool, np.bool_)):
        return bool(value)
    raise TypeError(f"{name}: expected True or False, got {type(value).__name__}")


def known(value: Any, name: str, names: Collection[str], expected: str) -> str:
    """Return `value` if it is one of many names; `expected` says of which."""
    if isinstance(value, str) and value in names:
        return value
    raise ValueError(f"{name}: expected {expected}, got {value!r}")
