"""What both rotations and positions can do: steps from one to the other, and distances."""

from quatfilt._reference._arrays import Reals
from quatfilt._reference.rotations.quaternion import between, exp, log_short, multiply, norm


def step(a: Reals, b: Reals) -> Reals:
    """Rotation vector, in radians, from the rotation `a` to `b`, the shorter way; or the way between two positions."""
    return b - a if a.shape[-1] == 3 else 2 * log_short(between(a, b))


def moved(a: Reals, vector: Reals) -> Reals:
    """Rotation or position that lies one `step` from `a`."""
    return a + vector if a.shape[-1] == 3 else multiply(a, exp(vector / 2))


def distance(a: Reals, b: Reals) -> Reals:
    """Length of the `step` from `a` to `b`."""
    return norm(step(a, b))
