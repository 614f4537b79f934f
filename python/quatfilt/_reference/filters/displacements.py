"""Ways from one rotation to another: rotation vectors in the frame of their start; arrays `(n, 4)` and `(n, 3)`."""

from quatfilt._reference._arrays import Reals
from quatfilt._reference.motion.skeleton import rotate
from quatfilt._reference.rotations.quaternion import between, exp, log_short, multiply


def moved(rotation: Reals, displacement: Reals) -> Reals:
    """Return the rotation at the end of a way, a rotation vector in the frame of its start."""
    return multiply(rotation, exp(displacement / 2))


def displacement_between(start: Reals, end: Reals) -> Reals:
    """Return the shorter way from one rotation to another, a rotation vector in the frame of its start."""
    return 2 * log_short(between(start, end))


def carried(vector: Reals, displacement: Reals) -> Reals:
    """Carry a vector of the tangent space along a way by parallel transport, into the frame of the way's end.

    Of the turn of the frame along a geodesic, parallel transport makes up for one half.
    """
    return rotate(exp(-displacement / 4), vector)
