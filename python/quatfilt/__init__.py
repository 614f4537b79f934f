"""Clean, analyse and reconstruct motion-capture rotations.

Rotations are unit quaternions ``(frames, joints, 4)``, scalar first; angles are rotation angles in radians; times are
seconds with ``fps=``, and frames without it.
"""

import warnings

from quatfilt._backend import get_backend, get_num_threads, set_num_threads, simd_level, use_backend
from quatfilt._core import is_debug_build as _is_debug_build
from quatfilt.denoise import denoise
from quatfilt.errors import FileAccessError, FileFormatError, QuatfiltError
from quatfilt.filters.bilateral import bilateral
from quatfilt.filters.butterworth import butterworth
from quatfilt.filters.despike import despike
from quatfilt.filters.gaps import fill_gaps
from quatfilt.filters.gaussian import gaussian
from quatfilt.filters.kalman import kalman, kalman_noises
from quatfilt.filters.nonlocal_pose_means import nonlocal_pose_means
from quatfilt.filters.one_euro import one_euro
from quatfilt.filters.orientation_filter import orientation_filter
from quatfilt.filters.savgol import savgol
from quatfilt.filters.smooth import smooth
from quatfilt.filters.stream.bilateral import BilateralStream
from quatfilt.filters.stream.kalman import KalmanStream
from quatfilt.filters.stream.nonlocal_pose_means import NonlocalPoseMeansStream
from quatfilt.filters.stream.one_euro import OneEuroStream
from quatfilt.filters.wavelet import wavelet
from quatfilt.filters.weighted_moving_mean import weighted_moving_mean
from quatfilt.formats.files import read_motion, write_motion
from quatfilt.geodesics.compress import compress
from quatfilt.geodesics.compressed import Compressed
from quatfilt.geodesics.pga import PrincipalGeodesicAnalysis
from quatfilt.geodesics.segment import segment
from quatfilt.motion import metrics
from quatfilt.motion.feet import lock_feet
from quatfilt.motion.motion import Motion
from quatfilt.motion.report import Report, report
from quatfilt.motion.skeleton import EndSite, Skeleton
from quatfilt.noise.model import NoiseModel, noise_model
from quatfilt.noise.noise import add_gaussian_noise, add_impulse_noise, noise_level
from quatfilt.reconstruction.database import MotionDatabase
from quatfilt.reconstruction.gplvm import PoseGPLVM
from quatfilt.reconstruction.local_models import PosePrediction, predict_pose
from quatfilt.reconstruction.reconstructor import (
    MotionReconstructor,
    ReconstructedPose,
    ReconstructionStream,
)
from quatfilt.rotations.continuity import continuous
from quatfilt.rotations.mean import mean
from quatfilt.rotations.quaternion import conjugate, exp, geodesic_distance, log, multiply, normalize
from quatfilt.rotations.resample import resample, slerp
from quatfilt.search.patch_neighbors import patch_neighbors
from quatfilt.search.poses import nearest_segments, neighbor_graph
from quatfilt.search.walk import PoseSearch

if _is_debug_build():
    warnings.warn(
        "quatfilt was built without optimisation: it is ten times slower than it should be",
        RuntimeWarning,
        stacklevel=2,
    )

__all__ = [
    "BilateralStream",
    "Compressed",
    "EndSite",
    "FileAccessError",
    "FileFormatError",
    "KalmanStream",
    "Motion",
    "MotionDatabase",
    "MotionReconstructor",
    "NoiseModel",
    "NonlocalPoseMeansStream",
    "OneEuroStream",
    "PoseGPLVM",
    "PosePrediction",
    "PoseSearch",
    "PrincipalGeodesicAnalysis",
    "QuatfiltError",
    "ReconstructedPose",
    "ReconstructionStream",
    "Report",
    "Skeleton",
    "add_gaussian_noise",
    "add_impulse_noise",
    "bilateral",
    "butterworth",
    "compress",
    "conjugate",
    "continuous",
    "denoise",
    "despike",
    "exp",
    "fill_gaps",
    "gaussian",
    "geodesic_distance",
    "get_backend",
    "get_num_threads",
    "kalman",
    "kalman_noises",
    "lock_feet",
    "log",
    "mean",
    "metrics",
    "multiply",
    "nearest_segments",
    "neighbor_graph",
    "noise_level",
    "noise_model",
    "nonlocal_pose_means",
    "normalize",
    "one_euro",
    "orientation_filter",
    "patch_neighbors",
    "predict_pose",
    "read_motion",
    "report",
    "resample",
    "savgol",
    "segment",
    "set_num_threads",
    "simd_level",
    "slerp",
    "smooth",
    "use_backend",
    "wavelet",
    "weighted_moving_mean",
    "write_motion",
]
