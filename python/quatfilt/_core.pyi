from typing import Any, TypeAlias, final

import numpy as np
from numpy.typing import NDArray

from quatfilt._typing import Array, Mask

__all__ = [
    "FormatError",
    "MotionTracker",
    "PoseStream",
    "SegmentWalk",
    "TrackerTables",
    "bilateral",
    "bilateral_stream",
    "body_geodesics",
    "body_product",
    "body_scores",
    "butterworth",
    "compress",
    "conjugate",
    "continuous",
    "continuous_euler",
    "decompress",
    "develop",
    "drawn_towards",
    "exp",
    "fill_gaps",
    "find_repeats",
    "find_spikes",
    "find_swaps",
    "foot_displacements",
    "forward_kinematics",
    "forward_kinematics_moving",
    "from_euler",
    "gaussian",
    "geodesic_centre",
    "geodesic_distance",
    "geodesic_product",
    "geodesic_scores",
    "get_num_threads",
    "is_debug_build",
    "kalman",
    "kalman_process_noise",
    "kalman_stream",
    "kalman_vectors",
    "kalman_vectors_ratio",
    "knots",
    "log",
    "low_pass",
    "mean",
    "multiply",
    "nearest_segments",
    "neighbor_graph",
    "noise_along_time",
    "noise_axes",
    "noise_colour",
    "noise_level",
    "noise_over_motion",
    "nonlocal_pose_means",
    "nonlocal_pose_means_stream",
    "normalize",
    "one_euro",
    "one_euro_stream",
    "orientation_filter",
    "patch_neighbors",
    "place_feet",
    "pose_features",
    "predict_pose",
    "principal_frames",
    "principal_geodesics",
    "pulled_by_confidence",
    "read_amc",
    "read_asf",
    "read_bvh",
    "sampling",
    "savgol",
    "savgol_derivative",
    "scan",
    "segment",
    "segment_walk",
    "set_num_threads",
    "simd_level",
    "slerp",
    "smooth",
    "smooth_body",
    "smooth_gains",
    "smooth_patches",
    "smooth_rank",
    "solve_pose",
    "spline",
    "split_heading",
    "to_euler",
    "track",
    "track_stream",
    "tracker_noise",
    "undevelop",
    "unwhiten",
    "weighted_moving_mean",
    "whiten",
    "write_bvh",
]

# filters/bilateral
def bilateral(
    q: Array,
    translation: Array | None,
    radius: int,
    sigma_time: float,
    sigma_angle: NDArray[np.float64],
    kernel: str,
    iterations: int,
    boundary: str,
    lookahead: int,
    /,
) -> tuple[Array, Array | None]: ...

# filters/butterworth
def butterworth(
    q: Array,
    translation: Array | None,
    confidence: Array | None,
    reference_sigma: NDArray[np.float64],
    sections: NDArray[np.float64],
    states: NDArray[np.float64],
    padding: int,
    /,
) -> tuple[Array, Array | None]: ...

# filters/confidence
def pulled_by_confidence(q: Array, confidence: Array, /) -> Array: ...

# filters/despike
def find_spikes(
    x: Array,
    confidence: Array | None,
    noise: NDArray[np.float64],
    smallest: NDArray[np.float64],
    radius: int,
    threshold: float,
    longest: int,
    /,
) -> Mask: ...
def find_swaps(
    q: Array,
    confidence: Array | None,
    noise: NDArray[np.float64],
    smallest: NDArray[np.float64],
    threshold: float,
    longest: int,
    /,
) -> NDArray[np.int64]: ...

# filters/development
def develop(
    q: Array, confidence: Array | None, reference_sigma: NDArray[np.float64], /
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]: ...
def undevelop(
    q: Array,
    reference: NDArray[np.float64],
    development: NDArray[np.float64],
    vectors: NDArray[np.float64],
    /,
) -> Array: ...

# filters/gaps
def fill_gaps(q: Array, max_gap: int, method: str, /) -> tuple[Array, Mask]: ...

# filters/gaussian
def gaussian(
    q: Array,
    translation: Array | None,
    confidence: Array | None,
    reference_sigma: NDArray[np.float64],
    sigma: NDArray[np.float64],
    boundary: str,
    /,
) -> tuple[Array, Array | None]: ...

# filters/kalman
def kalman(
    q: Array,
    confidence: Array | None,
    process_noise: NDArray[np.float64],
    measurement_noise: NDArray[np.float64],
    lookahead: int,
    /,
) -> Array: ...
def kalman_process_noise(
    q: Array,
    confidence: Array | None,
    measurement_noise: NDArray[np.float64],
    block: int,
    lookahead: int,
    /,
) -> NDArray[np.float64]: ...
def kalman_vectors(x: Array, ratio: NDArray[np.float64], lookahead: int, /) -> Array: ...
def kalman_vectors_ratio(x: Array, block: int, lookahead: int, /) -> NDArray[np.float64]: ...

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
    library: Array | None,
    lengths: list[int],
    /,
) -> tuple[Array, Array | None]: ...

# filters/one_euro
def one_euro(
    q: Array,
    translation: Array | None,
    confidence: Array | None,
    min_cutoff: NDArray[np.float64],
    beta: NDArray[np.float64],
    derivative_cutoff: NDArray[np.float64],
    /,
) -> tuple[Array, Array | None]: ...

# filters/orientation_filter
def orientation_filter(
    q: Array, translation: Array | None, mask: NDArray[np.float64], iterations: int, boundary: str, /
) -> tuple[Array, Array | None]: ...

# filters/savgol
def savgol(
    q: Array,
    translation: Array | None,
    confidence: Array | None,
    reference_sigma: NDArray[np.float64],
    fit: NDArray[np.float64],
    values: NDArray[np.float64],
    /,
) -> tuple[Array, Array | None]: ...
def savgol_derivative(
    q: Array,
    confidence: Array | None,
    reference_sigma: NDArray[np.float64],
    fit: NDArray[np.float64],
    values: NDArray[np.float64],
    derivatives: NDArray[np.float64],
    /,
) -> Array: ...

# filters/smooth
def smooth(
    q: Array,
    translation: Array | None,
    confidence: Array | None,
    noise: NDArray[np.float64],
    translation_noise: float,
    /,
) -> tuple[Array, Array | None]: ...
def smooth_body(q: Array, pilot: Array, confidence: Array | None, noise: NDArray[np.float64], /) -> Array: ...

# filters/smooth/gains
def smooth_gains(
    q: Array,
    patches: Array,
    pilot: Array,
    confidence: Array | None,
    noise: NDArray[np.float64],
    share: float,
    first: NDArray[np.float32],
    second: NDArray[np.float32],
    last: NDArray[np.float32],
    /,
) -> Array: ...

# filters/smooth/low_pass
def low_pass(
    q: Array,
    translation: Array | None,
    confidence: Array | None,
    reference_sigma: NDArray[np.float64],
    softness: float,
    /,
) -> tuple[Array, Array | None]: ...

# filters/smooth/patches
def smooth_patches(
    q: Array, pilot: Array, confidence: Array | None, noise: NDArray[np.float64], rounds: int, /
) -> Array: ...

# filters/smooth/rank
def smooth_rank(q: Array, pilot: Array, confidence: Array | None, noise: NDArray[np.float64], /) -> Array: ...

# filters/stream
@final
class PoseStream:
    @property
    def latency(self) -> int: ...
    def push(
        self, pose: NDArray[np.float64], confidence: NDArray[np.float64] | None, /
    ) -> NDArray[np.float64] | None: ...
    def flush(self, /) -> NDArray[np.float64]: ...

# filters/stream/bilateral
def bilateral_stream(
    radius: int,
    sigma_time: float,
    sigma_angle: NDArray[np.float64],
    kernel: str,
    iterations: int,
    boundary: str,
    lookahead: int,
    /,
) -> PoseStream: ...

# filters/stream/kalman
def kalman_stream(
    process_noise: NDArray[np.float64], measurement_noise: NDArray[np.float64], lookahead: int, /
) -> PoseStream: ...

# filters/stream/nonlocal_pose_means
def nonlocal_pose_means_stream(
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
) -> PoseStream: ...

# filters/stream/one_euro
def one_euro_stream(
    min_cutoff: NDArray[np.float64],
    beta: NDArray[np.float64],
    derivative_cutoff: NDArray[np.float64],
    /,
) -> PoseStream: ...

# filters/weighted_moving_mean
def weighted_moving_mean(
    q: Array,
    translation: Array | None,
    confidence: Array | None,
    reference_sigma: NDArray[np.float64],
    iterations: int,
    /,
) -> tuple[Array, Array | None]: ...

# formats
class FormatError(ValueError): ...

_Offset: TypeAlias = tuple[float, float, float]
_Joint: TypeAlias = tuple[str, int, _Offset, list[str], list[tuple[str | None, _Offset]]]

def read_amc(data: bytes, skeleton: bytes, /) -> tuple[NDArray[np.float64], str, list[str]]: ...
def read_asf(data: bytes, /) -> dict[str, Any]: ...
def read_bvh(data: bytes, /) -> tuple[list[_Joint], tuple[float, str], NDArray[np.float64], list[str]]: ...
def write_bvh(
    joints: list[_Joint], frame_time: tuple[float, str], values: NDArray[np.float64], /
) -> bytes: ...

# geodesics/body
def body_geodesics(
    q: Array, means: Array, components: int, most: int, objective: str, tolerance: float, /
) -> tuple[Array, Array, Array]: ...
def body_product(scores: Array, means: Array, directions: Array, /) -> Array: ...
def body_scores(q: Array, means: Array, directions: Array, /) -> Array: ...

# geodesics/compress
def compress(
    q: Array, frames: NDArray[np.float64], tolerance: NDArray[np.float64], quantised: bool, /
) -> tuple[bytes, float]: ...
def decompress(data: bytes, frames: int, joints: int, double: bool, /) -> Array: ...
def principal_frames(q: Array, /) -> NDArray[np.float64]: ...

# geodesics/pga
def geodesic_centre(q: Array, /) -> tuple[Array, Array, Mask]: ...
def geodesic_product(scores: Array, means: Array, directions: Array, /) -> Array: ...
def geodesic_scores(q: Array, means: Array, directions: Array, /) -> Array: ...
def principal_geodesics(
    q: Array, means: Array, components: int, most: int, objective: str, tolerance: float, /
) -> tuple[Array, Array, Array]: ...

# geodesics/segment
def segment(
    q: Array, components: int, window: int, min_length: int, lag: int, threshold: float, /
) -> tuple[NDArray[np.intp], NDArray[np.float64], NDArray[np.float64]]: ...

# motion/feet
def foot_displacements(
    before: Array,
    after: Array,
    lengths: NDArray[np.float64],
    up: int,
    fps: float,
    given: Mask | None,
    lock: bool,
    /,
) -> tuple[NDArray[np.float64], Mask]: ...
def place_feet(
    rotations: Array,
    translation: Array,
    local: Array,
    parents: NDArray[np.int64],
    pelvis: int,
    legs: NDArray[np.int64],
    lengths: NDArray[np.float64],
    displacements: NDArray[np.float64],
    root: bool,
    lock: bool,
    /,
) -> tuple[Array, Array]: ...

# motion/skeleton
def forward_kinematics(
    rotations: Array, translation: Array, parents: NDArray[np.int64], offsets: Array, /
) -> Array: ...
def forward_kinematics_moving(
    rotations: Array, joint_translations: Array, parents: NDArray[np.int64], /
) -> Array: ...

# noise/model
def noise_along_time(q: Array, level: Array, /) -> NDArray[np.float64]: ...
def noise_axes(q: Array, /) -> tuple[NDArray[np.float64], NDArray[np.float64]]: ...
def noise_colour(q: Array, /) -> float: ...
def noise_over_motion(q: Array, level: Array, /) -> float: ...

# noise/noise
def noise_level(q: Array, /) -> Array: ...

# noise/repeats
def find_repeats(q: Array, /) -> Mask: ...

# noise/whiten
def drawn_towards(q: Array, estimate: Array, share: NDArray[np.float64], /) -> Array: ...
def unwhiten(
    q: Array,
    reference: NDArray[np.float64],
    development: NDArray[np.float64],
    colour: float,
    spread: NDArray[np.float64],
    axes: NDArray[np.float64],
    /,
) -> NDArray[np.float64]: ...
def whiten(
    reference: NDArray[np.float64],
    development: NDArray[np.float64],
    vectors: NDArray[np.float64],
    colour: float,
    spread: NDArray[np.float64],
    axes: NDArray[np.float64],
    /,
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]: ...

# reconstruction/features
def pose_features(q: Array, means: NDArray[np.float64], weights: NDArray[np.float64], /) -> Array: ...

# reconstruction/heading
def split_heading(roots: Array, up: int, /) -> tuple[Array, Array]: ...

# reconstruction/local_models
def predict_pose(
    segments: Array,
    root_steps: Array,
    signals: Array,
    recent: Array,
    joint_weights: NDArray[np.float64],
    model: str,
    target: str,
    deviation: str,
    bandwidth: float,
    ridge: float,
    share: float,
    /,
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]: ...

# reconstruction/solver
def solve_pose(
    parents: NDArray[np.int64],
    offsets: NDArray[np.float64],
    points: NDArray[np.int64],
    up: int,
    centres: NDArray[np.float64],
    place: NDArray[np.float64],
    heading: float,
    mean: NDArray[np.float64],
    deviation: NDArray[np.float64],
    axes: NDArray[np.float64],
    positions: NDArray[np.float64],
    position_deviations: NDArray[np.float64],
    orientations: NDArray[np.float64],
    orientation_deviations: NDArray[np.float64],
    start: NDArray[np.float64],
    most: int,
    /,
) -> tuple[Array, Array, Array, float, float, int]: ...

# reconstruction/tracker
def track(
    parents: NDArray[np.int64],
    offsets: NDArray[np.float64],
    points: NDArray[np.int64],
    up: int,
    poses: tuple[NDArray[Any] | None, ...],
    options: tuple[Any, ...],
    model: tuple[str, str, str, float, float, float],
    initial: tuple[NDArray[np.float64], NDArray[np.float64], float] | None,
    positions: NDArray[np.float64],
    position_deviations: NDArray[np.float64],
    orientations: NDArray[np.float64],
    orientation_deviations: NDArray[np.float64],
    /,
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]: ...
def track_stream(
    parents: NDArray[np.int64],
    offsets: NDArray[np.float64],
    points: NDArray[np.int64],
    up: int,
    poses: tuple[NDArray[Any] | None, ...],
    options: tuple[Any, ...],
    model: tuple[str, str, str, float, float, float],
    initial: tuple[NDArray[np.float64], NDArray[np.float64], float] | None,
    /,
) -> MotionTracker: ...

@final
class TrackerTables:
    def __new__(cls) -> TrackerTables: ...
    def __reduce__(self, /) -> tuple[type[TrackerTables], tuple[()]]: ...

@final
class MotionTracker:
    def push(
        self,
        positions: NDArray[np.float64],
        position_deviations: NDArray[np.float64],
        orientations: NDArray[np.float64],
        orientation_deviations: NDArray[np.float64],
        /,
    ) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]: ...

# rotations/continuity
def continuous(q: Array, /) -> Array: ...

# rotations/euler
def continuous_euler(
    angles: NDArray[np.float64], start: NDArray[np.float64], axes: str, /
) -> NDArray[np.float64]: ...
def from_euler(angles: NDArray[np.float64], axes: str, /) -> NDArray[np.float64]: ...
def to_euler(q: NDArray[np.float64], axes: str, /) -> NDArray[np.float64]: ...

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

# sampling/sampling
def sampling(q: Array, fps: float, /) -> tuple[int, NDArray[np.float64], Mask]: ...

# sampling/spline
def knots(q: Array, times: NDArray[np.float64], /) -> Array: ...
def spline(
    q: Array, times: NDArray[np.float64], new_times: NDArray[np.float64], cutoff: float, /
) -> Array: ...

# sampling/tracker_noise
def tracker_noise(q: Array, fps: float, /) -> NDArray[np.float64]: ...

# search/patch_neighbors
def patch_neighbors(
    q: Array,
    library: Array | None,
    lengths: list[int],
    patch_radius: int,
    k: int,
    exclusion: int,
    weights: NDArray[np.float64],
    /,
) -> tuple[NDArray[np.int64], Array]: ...

# search/poses
def nearest_segments(
    features: Array,
    starts: NDArray[np.int64],
    queries: Array,
    k: int,
    successors: int,
    excluded: NDArray[np.int64] | None,
    /,
) -> tuple[NDArray[np.int64], Array]: ...
def neighbor_graph(
    features: Array,
    starts: NDArray[np.int64],
    degree: int,
    length: int,
    successors: int,
    exclusion: int,
    spacing: int,
    /,
) -> tuple[NDArray[np.int32], Array]: ...

# search/walk
@final
class SegmentWalk:
    def next(self, query: Array, first: int, last: int, /) -> tuple[NDArray[np.int64], Array, bool]: ...
    def reset(self, /) -> None: ...

def segment_walk(
    features: Array,
    starts: NDArray[np.int64],
    graph: NDArray[np.int32] | None,
    k: int,
    length: int,
    successors: int,
    breadth: int,
    refresh: int,
    ratio: float,
    /,
) -> SegmentWalk: ...

# threads
def get_num_threads() -> int: ...
def is_debug_build() -> bool: ...
def set_num_threads(threads: int, /) -> None: ...
def simd_level() -> str: ...
