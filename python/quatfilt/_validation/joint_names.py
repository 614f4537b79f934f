"""Joints by their names."""

import difflib
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

_CLOSE = 3
"""Names that a message suggests."""


def joint_names(value: Any, name: str, names: Sequence[str]) -> NDArray[np.int64]:
    """Return the indices of joints given by their names, each once."""
    if isinstance(value, str) or not isinstance(value, Sequence):
        raise TypeError(f"{name}: expected a sequence of names of joints, got {value!r}")
    if not value:
        raise ValueError(f"{name}: expected at least one joint, got none")
    index = {joint: place for place, joint in enumerate(names)}
    for joint in value:
        if joint not in index:
            raise ValueError(f"{name}: the database has no joint {joint!r}{_close(str(joint), names)}")
    twice = [joint for place, joint in enumerate(value) if joint in value[:place]]
    if twice:
        raise ValueError(f"{name}: {twice[0]!r} is named twice; name each joint once")
    return np.array([index[joint] for joint in value], np.int64)


def _close(name: str, names: Sequence[str]) -> str:
    by_lower = {joint.lower(): joint for joint in names}
    near = difflib.get_close_matches(name.lower(), by_lower, n=_CLOSE)
    if near:
        return f"; similar names: {', '.join(by_lower[joint] for joint in near)}"
    return f"; the joints are {', '.join(names[:8])}{', …' if len(names) > 8 else ''}"
