"""Frames of principal geodesic coordinates: the centre of a joint's motion, and its axes in order of importance.

Two for each joint. The first are the principal geodesics of the squared sine: the point and the geodesic through it that leave the
least mean `sin² d`, which are the main eigenvector of `Σ q qᵀ` and the great circle through the first two; the axis that does
so for what is left, an eigenvector of `Σ u uᵀ` over its samples `(w, u)`; and the axis orthogonal to both. They exist whether or not there is
a unique mean. The second is for joints of two degrees of freedom, whatever their angles:
where `q = c exp(s₁ v₁) exp(s₂ v₂)`, the vectors `l = R(c) v₁` and `v₂` keep `l · R(q) v₂ = 0` in every frame, so `l` and `v₂` are sought
that leave the least mean square of it.
"""

import numpy as np

from quatfilt._reference._arrays import Reals
from quatfilt._reference.geodesics.compress.arithmetic import Doubles
from quatfilt._reference.geodesics.compress.chart import conjugate, product
from quatfilt._reference.rotations.quaternion import is_missing

SAMPLES = 1024
"""Axes are found from about as many frames, evenly spaced."""

ROUNDS = 40
"""Number of alternating improvements of the two vectors of the second frame."""


def principal_frames(q: Reals) -> Reals:
    """Frames `(joints, 2, 2, 4)` of rotations `(frames, joints, 4)`: two for each joint, each a centre and its axes; float64.

    A joint without valid samples has unit quaternions.
    """
    result = np.zeros((q.shape[1], 2, 2, 4))
    result[..., 0] = 1.0
    some = q[:: max(-(-len(q) // SAMPLES), 1)].astype(np.float64)
    for joint in range(q.shape[1]):
        valid = some[~is_missing(some[:, joint]), joint]
        if len(valid):
            path = _unit(valid)
            main = _eigenvectors(path.T @ path)
            result[joint, 0] = _geodesics(path, main[:, 3], main[:, 2])
            result[joint, 1] = _surface(path, main[:, 3])
    return result


def _geodesics(path: Doubles, centre: Doubles, beside: Doubles) -> tuple[Doubles, Doubles]:
    """Take the geodesic through two orthogonal points, the second a right angle (on S³) from the first."""
    seen = product(conjugate(centre), path)
    first = product(conjugate(centre), beside)[1:]
    s = np.arctan2(seen[:, 1:] @ first, seen[:, 0])
    back = np.column_stack([np.cos(s), -np.sin(s)[:, None] * first])
    left = product(back, seen)[:, 1:]
    # Far below all others, so that the second axis is orthogonal to the first, though nothing be left.
    moments = left.T @ left - 4.0 * len(path) * np.outer(first, first)
    second = _eigenvectors(moments)[:, -1]
    return centre, _turning_into(first, second)


def _surface(path: Doubles, centre: Doubles) -> tuple[Doubles, Doubles]:
    turned = matrices(path).reshape(-1, 9)
    moments = (turned.T @ turned).reshape(3, 3, 3, 3)
    least = _eigenvectors(moments.reshape(9, 9))[:, 0].reshape(3, 3)
    outer = _eigenvectors(least @ least.T)[:, -1]
    for _ in range(ROUNDS):
        inner = _eigenvectors(np.einsum("i,ijkl,k->jl", outer, moments, outer))[:, 0]
        outer = _eigenvectors(np.einsum("j,ijkl,l->ik", inner, moments, inner))[:, 0]
    at_centre = matrices(centre)
    first = at_centre.T @ outer
    first = first - inner * (inner @ first)
    length = np.sqrt(first @ first)
    if length < 0.5:  # the vectors do not belong together: no such surface
        return centre, np.array([1.0, 0.0, 0.0, 0.0])
    first = first / length
    way = np.concatenate([[1.0 + at_centre @ first @ outer], np.cross(at_centre @ first, outer)])
    return product(_unit(way), centre), _turning_into(first, inner)


def matrices(q: Doubles) -> Doubles:
    """Rotation matrices, `(…, 4)` → `(…, 3, 3)`."""
    w, x, y, z = np.moveaxis(q, -1, 0)
    rows = [
        [w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z],
    ]
    return np.moveaxis(np.array(rows), (0, 1), (-2, -1))


def _turning_into(first: Doubles, second: Doubles) -> Doubles:
    """Return the rotation that takes x and y to two orthonormal vectors, with `w ≥ 0`."""
    m = np.column_stack([first, second, np.cross(first, second)])
    # Four times the products of the components; the row with the largest square has all digits.
    outer = np.array(
        [
            [1 + m[0, 0] + m[1, 1] + m[2, 2], m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1]],
            [m[2, 1] - m[1, 2], 1 + m[0, 0] - m[1, 1] - m[2, 2], m[0, 1] + m[1, 0], m[0, 2] + m[2, 0]],
            [m[0, 2] - m[2, 0], m[0, 1] + m[1, 0], 1 - m[0, 0] + m[1, 1] - m[2, 2], m[1, 2] + m[2, 1]],
            [m[1, 0] - m[0, 1], m[0, 2] + m[2, 0], m[1, 2] + m[2, 1], 1 - m[0, 0] - m[1, 1] + m[2, 2]],
        ]
    )
    row = _unit(outer[np.argmax(np.diagonal(outer))])
    return -row if row[0] < 0.0 else row


def _unit(q: Doubles) -> Doubles:
    return np.asarray(q / np.sqrt((q * q).sum(axis=-1, keepdims=True)))


def _eigenvectors(matrix: Doubles) -> Doubles:
    """Eigenvectors of a symmetric matrix as columns, that of the least eigenvalue first; their largest component is positive."""
    vectors = np.linalg.eigh(matrix)[1]
    largest = np.take_along_axis(vectors, np.abs(vectors).argmax(axis=0)[None], axis=0)
    return np.asarray(vectors * np.copysign(1.0, largest))
