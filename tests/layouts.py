"""One array, laid out in memory in every way that NumPy knows."""

import numpy as np


def _strided(array):
    wide = np.zeros((array.shape[0] * 2, *array.shape[1:]), array.dtype)
    wide[::2] = array
    return wide[::2]


def _read_only(array):
    array = array.copy()
    array.flags.writeable = False
    return array


def _misaligned(array):
    room = np.zeros(array.nbytes + 1, np.uint8)
    view = room[1:].view(array.dtype).reshape(array.shape)
    view[...] = array
    return view


LAYOUTS = {
    "column-major": np.asfortranarray,
    "misaligned": _misaligned,
    "other byte order": lambda array: array.astype(array.dtype.newbyteorder()),
    "read-only": _read_only,
    "reversed": lambda array: np.ascontiguousarray(array[::-1])[::-1],
    "reversed components": lambda array: np.ascontiguousarray(array[..., ::-1])[..., ::-1],
    "strided": _strided,
    "transposed": lambda array: np.ascontiguousarray(np.swapaxes(array, 0, 1)).swapaxes(0, 1),
}
"""From the name to a function that returns an equal array."""
