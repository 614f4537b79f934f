"""Every tolerance of the tests, with its reason. Angles are rotation angles in radians."""

import numpy as np

ALGEBRA = 1e-14
"""A handful of float64 roundings on numbers of size 1 to π."""

ALGEBRA_FLOAT32 = 2e-6
"""The same in float32."""

KARCHER_MEAN = 1e-13
"""The iteration ends at steps of 1e-14; the last of them, and the roundings of the sum over the frames, remain."""

FLOAT64 = 1e-12
"""Filters in float64: roundings in a patch distance are amplified by up to 80, the largest exponent that counts."""

GAINS = 3e-6
"""Corrections with gains are computed in float32: roundings of columns of some ten units of the noise, and of sums of a network."""

FLOAT32 = 1e-5
"""Filters in float32: an ulp near 1 is 6e-8; amplified as in `FLOAT64`."""

RATIO = 1e-6
"""Relative, of automatic process noises: they lie at the flat bottom of a parabola through nearly equal numbers."""

PRINCIPAL_AXES = 5e-9
"""Filters along principal axes in float64. The stiffest penalty has the softness 1e-10 and makes 1 / (2·√1e-10) = 5e4 of a rounding,
third differences add up eight of them, and there are two rounds: 2e-10 of an angle of one radian. Where nothing moves and much noise
is taken for granted, 1.3e-9 was measured between core and reference in four hundred clips, and 4e-10 between the reference and the
same in 80 bits in fewer."""

PRINCIPAL_AXES_OF_SHORT_CLIPS = 1e-7
"""The same for clips that are shorter than the mask of the reference path: that hardly moves, and squares of its least steps are
1e-10 of the greatest. 2e-9 was measured in thousands of clips."""

RISK_BIAS = 0.005
"""In noise variances per frequency, how far the mean of Stein's risk over 4000 draws may lie from the mean squared error: its
deviation is 0.002 of them, and bins of frequencies add as much."""

DIRECTED = 1e-6
"""Radians of mean rotation angle that must be left for the direction of the next geodesic to be compared: roundings move it by
their ratio to what is left."""

DIRECTION = 1e-9
"""Directions of geodesics in float64: what the issue of principal geodesic analysis asks of their convergence."""

MOMENTS = 1e-11
"""Sums of eigenvalues of moments of up to 2000 unit quaternions, in float64: roundings of the sums, and of the largest eigenvalue."""

SHORTER_THAN_MASK = 25
"""Frames of such clips, at most: the reach of the mask."""

WHITE_NOISE_LEVEL = 0.03
"""Relative bias of the estimated noise level for 30 frames or more: at most 2.4 % was measured."""

LOCAL_MODELS = 1e-8
"""Predictions of local models: roundings grow by what the ridge leaves of the examples' smallest variance, and in deviations, which
divide by what is left of an example where it is left out, once more. 1e-9 was measured on recordings."""

LOCAL_MODELS_ORACLE = 1e-9
"""The same of well-conditioned examples against other ways to the same numbers."""

FEET = 1e-8
"""Displacements in centimetres, and rotations of legs, in float64: smoothing along principal axes, whose roundings `PRINCIPAL_AXES` bounds
in radians, of paths of some hundred centimetres."""

SEGMENT_DISTANCE = {np.dtype(np.float32): 1e-6, np.dtype(np.float64): 2e-15}
"""Relative, of distances of segments: the squares add up in 16 lanes, so that of four hundred numbers 32 roundings meet in one
sum, and halve under the root."""

EULER = 1e-12
"""Euler angles, and rotations made of them: beside a gimbal lock, an angle moves by a rounding times up to a thousand."""

FILE_ANGLE = 1e-9
"""Rotations that went through a file, in radians: its angles have eight decimals of a degree, 1e-10 radians each."""

PAIR_ANGLE = 0.01
"""Degrees between an AMC and its conversion to BVH, whose angles have four decimals."""

PAIR_POSITION = 1e-3
"""Units between an AMC and its conversion to BVH: four decimals of the root, of angles and of five of offsets."""

SOLUTION = 1e-9
"""Coordinates and energies of the most probable pose: the energy is flat there, so a rounding of it, 1e-16, moves the pose by
its root."""

TRACK = 1e-7
"""Units and energies of a motion of tens of frames, each of which starts from the one before: `SOLUTION` at the end of a body of a
hundred units."""


def distance(dtype):
    """Return the relative tolerance for distances of segments by the dtype of the poses."""
    return SEGMENT_DISTANCE[np.dtype(dtype)]


def filtered(dtype):
    """Return the tolerance for filters by the dtype of their rotations."""
    return FLOAT32 if np.dtype(dtype) == np.float32 else FLOAT64


def gains(dtype):
    """Return the tolerance for corrections with gains, whose columns are float32, by the dtype of their rotations."""
    return FLOAT32 if np.dtype(dtype) == np.float32 else GAINS


def principal_axes(dtype, frames):
    """Return the tolerance for filters along principal axes by the dtype of their rotations and the length of the clip."""
    if np.dtype(dtype) == np.float32:
        return FLOAT32
    return PRINCIPAL_AXES_OF_SHORT_CLIPS if frames < SHORTER_THAN_MASK else PRINCIPAL_AXES


def algebra(dtype):
    """Return the tolerance for the algebra by dtype."""
    return ALGEBRA_FLOAT32 if np.dtype(dtype) == np.float32 else ALGEBRA


def direction(dtype):
    """Return the tolerance for directions of geodesics by the dtype of the rotations."""
    return FLOAT32 if np.dtype(dtype) == np.float32 else DIRECTION
