"""Every kernel in plain NumPy, written to be read: this package is the definition.

The functions have the names and the positional arguments of those in the compiled `quatfilt._core`, and a test compares
the two surfaces. Arguments are already validated: arrays are C-contiguous, in native byte order, float32 or float64.
All arithmetic is in float64; results are rounded to the type of the input. Nothing writes to its inputs.

Quaternions are Hamilton's, scalar first: `q = (w, x, y, z) = (cos φ, sin φ · u)` turns by the angle `2φ` about the unit
axis `u`, and `q` and `−q` are the same rotation. A *missing* sample is a quaternion with a component that is not finite,
or with four zeros.
"""

from quatfilt._reference.filters.bilateral import bilateral
from quatfilt._reference.filters.butterworth import butterworth
from quatfilt._reference.filters.confidence import pulled_by_confidence
from quatfilt._reference.filters.despike import find_spikes, find_swaps
from quatfilt._reference.filters.development import develop, undevelop
from quatfilt._reference.filters.gaps import fill_gaps
from quatfilt._reference.filters.gaussian import gaussian
from quatfilt._reference.filters.kalman.ratio import kalman_process_noise, kalman_vectors_ratio
from quatfilt._reference.filters.kalman.rotations import kalman
from quatfilt._reference.filters.kalman.vectors import kalman_vectors
from quatfilt._reference.filters.nonlocal_pose_means.nonlocal_pose_means import nonlocal_pose_means
from quatfilt._reference.filters.one_euro import one_euro
from quatfilt._reference.filters.orientation_filter import orientation_filter
from quatfilt._reference.filters.savgol import savgol, savgol_derivative
from quatfilt._reference.filters.smooth.body import smooth_body
from quatfilt._reference.filters.smooth.gains import smooth_gains
from quatfilt._reference.filters.smooth.low_pass import low_pass
from quatfilt._reference.filters.smooth.patches import smooth_patches
from quatfilt._reference.filters.smooth.rank import smooth_rank
from quatfilt._reference.filters.smooth.smooth import smooth
from quatfilt._reference.filters.weighted_moving_mean import weighted_moving_mean
from quatfilt._reference.geodesics.body.body import body_geodesics, body_product, body_scores
from quatfilt._reference.geodesics.compress.compress import compress, decompress
from quatfilt._reference.geodesics.compress.frames import principal_frames
from quatfilt._reference.geodesics.pga.centre import geodesic_centre
from quatfilt._reference.geodesics.pga.pga import geodesic_product, geodesic_scores, principal_geodesics
from quatfilt._reference.geodesics.segment import segment
from quatfilt._reference.motion.feet.displacements import foot_displacements
from quatfilt._reference.motion.feet.place import place_feet
from quatfilt._reference.motion.skeleton import forward_kinematics, forward_kinematics_moving
from quatfilt._reference.noise.along_time import noise_along_time
from quatfilt._reference.noise.axes import noise_axes
from quatfilt._reference.noise.colour import noise_colour
from quatfilt._reference.noise.motion import noise_over_motion
from quatfilt._reference.noise.noise import noise_level
from quatfilt._reference.noise.outliers import drawn_towards
from quatfilt._reference.noise.repeats import find_repeats
from quatfilt._reference.noise.whiten import unwhiten, whiten
from quatfilt._reference.reconstruction.features import pose_features
from quatfilt._reference.reconstruction.heading import split_heading
from quatfilt._reference.reconstruction.local_models.predict import predict_pose
from quatfilt._reference.reconstruction.solver import solve_pose
from quatfilt._reference.reconstruction.tracker import track
from quatfilt._reference.rotations.euler import continuous_euler, from_euler, to_euler
from quatfilt._reference.rotations.mean import mean
from quatfilt._reference.rotations.quaternion import (
    conjugate,
    continuous,
    exp,
    geodesic_distance,
    log,
    multiply,
    normalize,
    scan,
)
from quatfilt._reference.rotations.resample import slerp
from quatfilt._reference.sampling.sampling import sampling
from quatfilt._reference.sampling.spline import knots, spline
from quatfilt._reference.sampling.tracker_noise import tracker_noise
from quatfilt._reference.search.patch_neighbors import patch_neighbors
from quatfilt._reference.search.poses import nearest_segments, neighbor_graph
from quatfilt._reference.search.walk import segment_walk

__all__ = [
    "bilateral",
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
    "kalman",
    "kalman_process_noise",
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
    "normalize",
    "one_euro",
    "orientation_filter",
    "patch_neighbors",
    "place_feet",
    "pose_features",
    "predict_pose",
    "principal_frames",
    "principal_geodesics",
    "pulled_by_confidence",
    "sampling",
    "savgol",
    "savgol_derivative",
    "scan",
    "segment",
    "segment_walk",
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
    "tracker_noise",
    "undevelop",
    "unwhiten",
    "weighted_moving_mean",
    "whiten",
]
