"""Weights of the network of the learned last step of automatic smoothing."""

from functools import cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

Layer = NDArray[np.float32]

FILE = Path(__file__).with_name("smooth_gains.npz")
"""Written by `make train-gains`; its checksum and where the recordings come from stand beside it."""


@cache
def weights() -> tuple[Layer, Layer, Layer]:
    """Return the weights of three layers, as `smooth_gains` takes them; they are read once."""
    with np.load(FILE) as layers:
        return layers["first"], layers["second"], layers["last"]
