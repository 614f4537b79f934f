"""Lists of neighbours."""

from typing import Any

import numpy as np
from numpy.typing import NDArray


def graph(value: Any, name: str, nodes: int) -> NDArray[np.int32]:
    """Return `value` as lists of neighbours ``(nodes, degree)``, int32: indices of nodes, −1 where there are fewer."""
    array = np.asarray(value)
    if array.dtype.kind not in "iu":
        raise TypeError(f"{name}: expected integers, got dtype {array.dtype}")
    if array.ndim != 2 or len(array) != nodes:
        raise ValueError(f"{name}: expected shape ({nodes}, degree), got {array.shape}")
    if array.size and not (array.min() >= -1 and array.max() < nodes):
        raise ValueError(
            f"{name}: expected indices from −1 to {nodes - 1}, got {array.min()} to {array.max()}"
        )
    return np.ascontiguousarray(array, np.int32)
