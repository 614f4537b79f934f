"""The types of arrays that the reference takes and gives."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

Reals = NDArray[np.floating[Any]]
"""An array of float32 or float64."""

Mask = NDArray[np.bool_]
"""An array of truth values."""

Indices = NDArray[np.intp]
"""An array of indices or of lags."""
