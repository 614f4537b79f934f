import numpy as np
from numpy.typing import NDArray

from quatfilt._typing import Array

__all__ = [
    "conjugate",
    "exp",
    "geodesic_distance",
    "get_num_threads",
    "is_debug_build",
    "log",
    "mean",
    "multiply",
    "nonlocal_pose_means",
    "normalize",
    "set_num_threads",
    "simd_level",
]

# filters/nonlocal_pose_means
def nonlocal_pose_means(
    q: Array,
    translation: Array | None,
    confidence: Array | None,
    bandwidth: NDArray[np.float64],
    search_radius: int,
    patch_radius: int,
    distance: str,
    weights: str,
    neighbors: int,
    chart: str,
    boundary: str,
    lookahead: int,
    /,
) -> tuple[Array, Array | None]: ...

# rotations/mean
def mean(q: Array, weights: Array | None, /) -> Array: ...

# rotations/quaternion
def conjugate(q: Array, /) -> Array: ...
def exp(v: Array, /) -> Array: ...
def geodesic_distance(a: Array, b: Array, /) -> Array: ...
def log(q: Array, /) -> Array: ...
def multiply(a: Array, b: Array, /) -> Array: ...
def normalize(q: Array, /) -> Array: ...

# threads
def get_num_threads() -> int: ...
def is_debug_build() -> bool: ...
def set_num_threads(threads: int, /) -> None: ...
def simd_level() -> str: ...
