"""Paths of the root: what stands where nobody knows it."""

import numpy as np

from quatfilt._typing import Array, Mask


def straightened(path: Array, known: Mask) -> Array:
    """Lead a path ``(frames, 3)`` along straight lines where it is not known, if it is known anywhere."""
    if known.all() or not known.any():
        return path
    frames = np.arange(len(path))
    columns = [np.interp(frames, frames[known], column[known]) for column in path.T]
    return np.stack(columns, axis=1).astype(path.dtype)


__all__ = ["straightened"]
