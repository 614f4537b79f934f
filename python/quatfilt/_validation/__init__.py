"""Every check of arguments, and every message.

Arrays leave this package native, C-contiguous, aligned, float32 or float64, and scalar first.
"""

from quatfilt._validation.arrays import floats, pair, quaternions, scalar_order, vectors
from quatfilt._validation.choices import choice, known, switch
from quatfilt._validation.confidences import confidence, pose_confidence
from quatfilt._validation.control_points import control_points
from quatfilt._validation.frame_times import times, times_within
from quatfilt._validation.geodesics import centred, scores
from quatfilt._validation.graphs import graph
from quatfilt._validation.joint_names import joint_names
from quatfilt._validation.joints import frequencies, per_joint
from quatfilt._validation.libraries import library
from quatfilt._validation.masks import mask
from quatfilt._validation.numbers import integer, interval, number, odd
from quatfilt._validation.paths import path
from quatfilt._validation.pose_rows import features, queries, ranges, starts
from quatfilt._validation.poses import clip, pose
from quatfilt._validation.randomness import generator
from quatfilt._validation.rates import resampling
from quatfilt._validation.segments import joint_weights, root_steps, segments
from quatfilt._validation.skeletons import offsets, parents, posed

__all__ = [
    "centred",
    "choice",
    "clip",
    "confidence",
    "control_points",
    "features",
    "floats",
    "frequencies",
    "generator",
    "graph",
    "integer",
    "interval",
    "joint_names",
    "joint_weights",
    "known",
    "library",
    "mask",
    "number",
    "odd",
    "offsets",
    "pair",
    "parents",
    "path",
    "per_joint",
    "pose",
    "pose_confidence",
    "posed",
    "quaternions",
    "queries",
    "ranges",
    "resampling",
    "root_steps",
    "scalar_order",
    "scores",
    "segments",
    "starts",
    "switch",
    "times",
    "times_within",
    "vectors",
]
