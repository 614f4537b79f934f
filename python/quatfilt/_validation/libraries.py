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
    if isinstance(value, (list, tuple)) and not _is_clip(value, like.shape[1]):
        named = {f"library[{i}]": one for i, one in enumerate(value)}
        if not named:
            raise ValueError("library: expected a clip or a list of clips, got an empty list")
    clips = []
    for name, one in named.items():
        array, _ = clip(one, name, scalar_first=scalar_first)
        if array.shape[1] != like.shape[1]:
            raise ValueError(f"{name}: expected {like.shape[1]} joints as in the clip, got {array.shape[1]}")
        clips.append(array.astype(like.dtype, copy=False))
    together = np.concatenate(clips) if len(clips) > 1 else clips[0]
    return np.ascontiguousarray(together), [len(one) for one in clips]


def _is_clip(value: list[Any] | tuple[Any, ...], joints: int) -> bool:
    """Tell whether nested lists are the numbers of a single clip, and not several clips of a joint each."""
    shape: list[int] = []
    part: Any = value
    while isinstance(part, (list, tuple)) and part:
        shape.append(len(part))
        part = part[0]
    return np.isscalar(part) and (shape[1:] == [joints, 4] or (joints == 1 and shape[1:] == [4]))
