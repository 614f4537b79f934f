"""Names for the types of the public signatures."""

from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array: TypeAlias = NDArray[np.floating[Any]]
"""A float32 or float64 array."""

Mask: TypeAlias = NDArray[np.bool_]
"""A boolean array."""

Rotations: TypeAlias = ArrayLike
"""What is accepted as rotations: ``(frames, joints, 4)`` or ``(frames, 4)``."""

PerJoint: TypeAlias = float | ArrayLike
"""A number, or one per joint."""

__all__ = ["Array", "Mask", "PerJoint", "Rotations"]
