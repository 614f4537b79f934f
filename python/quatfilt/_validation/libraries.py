"""Clips beside a clip."""

from typing import Any

import numpy as np

from quatfilt._typing import Array
from quatfilt._validation.poses import clip


def library(value: Any, like: Array, *, scalar_first: bool) -> tuple[Array | None, list[int]]:
    """Return the clip, or the clips of a list, one after the other in the dtype of `like`, and their lengths.

    Raises
    ------
    ValueError
        If a list is empty, or a clip has other joints than `like`.
    """
    if value is None:
        return None, []
    named = {"library": value}
    if isinstance(value, (list, tuple)):
        named = {f"library[{i}]": one for i, one in enumerate(value)}
        if not named:
            raise ValueError("library: expected a clip or a list of at least one, got none")
    clips = []
    for name, one in named.items():
        array, _ = clip(one, name, scalar_first=scalar_first)
        if array.shape[1] != like.shape[1]:
            raise ValueError(f"{name}: expected {like.shape[1]} joints as in the clip, got {array.shape[1]}")
        clips.append(array.astype(like.dtype, copy=False))
    together = np.concatenate(clips) if len(clips) > 1 else clips[0]
    return np.ascontiguousarray(together), [len(one) for one in clips]
