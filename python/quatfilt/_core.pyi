import numpy as np
from numpy.typing import NDArray

from quatfilt._typing import Array, Mask

__all__ = [
    "conjugate",
    "continuous",
    "exp",
    "fill_gaps",
    "forward_kinematics",
    "geodesic_distance",
    "get_num_threads",
    "is_debug_build",
    "log",
    "mean",
    "multiply",
    "noise_level",
    "nonlocal_pose_means",
    "normalize",
    "scan",
    "set_num_threads",
    "simd_level",
    "slerp",
]

# filters/gaps
def fill_gaps(q: Array, max_gap: int, /) -> tuple[Array, Mask]: ...

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

# motion/skeleton
def forward_kinematics(
    rotations: Array, translation: Array, parents: NDArray[np.int64], offsets: Array, /
) -> Array: ...

# noise/noise
def noise_level(q: Array, /) -> Array: ...

# rotations/continuity
def continuous(q: Array, /) -> Array: ...

# rotations/mean
def mean(q: Array, weights: Array | None, /) -> Array: ...

# rotations/quaternion
def conjugate(q: Array, /) -> Array: ...
def exp(v: Array, /) -> Array: ...
def geodesic_distance(a: Array, b: Array, /) -> Array: ...
def log(q: Array, /) -> Array: ...
def multiply(a: Array, b: Array, /) -> Array: ...
def normalize(q: Array, /) -> Array: ...
def scan(q: Array, /) -> tuple[int, float, int]: ...

# rotations/resample
def slerp(q: Array, times: NDArray[np.float64], new_times: NDArray[np.float64], /) -> Array: ...

# threads
def get_num_threads() -> int: ...
def is_debug_build() -> bool: ...
def set_num_threads(threads: int, /) -> None: ...
def simd_level() -> str: ...
