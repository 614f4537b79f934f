"""The algebra of unit quaternions.

The logarithm of `q = (cos φ, sin φ · u)` is the vector `φ·u`, half of the rotation vector, and `exp` is its inverse.
`log`, `exp`, `multiply`, `conjugate` and `normalize` take quaternions as they are; what speaks of rotations
(`geodesic_distance`, and every mean and filter) does not depend on their signs.
"""

import numpy as np

from quatfilt._reference._arrays import Mask, Reals

ZERO_SINE = np.sqrt(np.finfo(np.float64).tiny)
"""Length of the vector part (unit: 1) below which its square underflows: the axis is then lost."""


def norm(x: Reals) -> Reals:
    """Euclidean length of the vectors along the last axis."""
    length: Reals = np.sqrt(np.sum(x * x, axis=-1))
    return length


def multiply(a: Reals, b: Reals) -> Reals:
    """Hamilton product `a·b`: first the rotation `b`, then `a`.

    `(aw, av)·(bw, bv) = (aw bw − av·bv,  aw bv + bw av + av × bv)`, for `(n, 4)` and `(n, 4)`.
    """
    aw, ax, ay, az = np.moveaxis(a.astype(np.float64), -1, 0)
    bw, bx, by, bz = np.moveaxis(b.astype(np.float64), -1, 0)
    product = np.stack(
        [
            aw * bw - ax * bx - ay * by - az * bz,
            aw * bx + ax * bw + ay * bz - az * by,
            aw * by - ax * bz + ay * bw + az * bx,
            aw * bz + ax * by - ay * bx + az * bw,
        ],
        axis=-1,
    )
    return product.astype(a.dtype)


def conjugate(q: Reals) -> Reals:
    """Conjugate `(w, −v)`, the inverse of a unit quaternion; `(n, 4)`."""
    return q * np.array([1, -1, -1, -1], q.dtype)


def between(a: Reals, b: Reals) -> Reals:
    """Rotation `a⁻¹·b` that leads from `a` to `b`, for unit quaternions.

    Terms that cancel between equal ones stand side by side: the rotation between them is 1 to the last bit.
    """
    (aw, ax, ay, az), (bw, bx, by, bz) = np.moveaxis(a, -1, 0), np.moveaxis(b, -1, 0)
    return np.stack(
        [
            (aw * bw + ax * bx) + (ay * by + az * bz),
            (aw * bx - ax * bw) + (az * by - ay * bz),
            (aw * by - ay * bw) + (ax * bz - az * bx),
            (aw * bz - az * bw) + (ay * bx - ax * by),
        ],
        axis=-1,
    )


def normalize(q: Reals) -> Reals:
    """Quaternions `q / |q|` of length 1, `(n, 4)`; NaN where the length is 0 or NaN."""
    wide = q.astype(np.float64)
    with np.errstate(invalid="ignore"):
        return (wide / norm(wide)[..., None]).astype(q.dtype)


def log(q: Reals) -> Reals:
    """Quaternion logarithm: half of the rotation vector, `(n, 4)` → `(n, 3)`.

    `log (w, v) = φ · v/|v|` with `φ = atan2(|v|, w)` in `[0, π]`. At `−1`, which has no axis, it is `(π, 0, 0)`.
    """
    w, v = q[..., 0].astype(np.float64), q[..., 1:].astype(np.float64)
    sine = norm(v)
    small = sine < ZERO_SINE
    with np.errstate(divide="ignore", invalid="ignore"):
        factor = np.where(small, 1 / w, np.arctan2(sine, w) / sine)
        vector = v * factor[..., None]
    opposite = small & (w <= 0)
    vector[opposite] = [np.pi, 0, 0]
    return vector.astype(q.dtype)


def log_short(q: Reals) -> Reals:
    """Logarithm of `q` or `−q`, whichever has `w ≥ 0`: half of the rotation vector of the shorter rotation."""
    return log(q * np.copysign(1, q[..., :1]))


def exp(v: Reals) -> Reals:
    """Quaternion exponential, `(n, 3)` → `(n, 4)`: `exp (φ·u) = (cos φ, sin φ · u)`."""
    wide = v.astype(np.float64)
    angle = norm(wide)[..., None]
    small = angle < ZERO_SINE
    sine_over_angle = np.where(small, 1, np.sin(angle) / np.where(small, 1, angle))
    return np.concatenate([np.cos(angle), wide * sine_over_angle], axis=-1).astype(v.dtype)


def geodesic_distance(a: Reals, b: Reals) -> Reals:
    """Rotation angle between two rotations in `[0, π]` radians, `(n, 4)` and `(n, 4)` → `(n,)`.

    `2·atan2(|v|, |w|)` of `(w, v) = a⁻¹·b`: accurate for small angles and for large ones, which `acos` is not. The
    lengths of the quaternions do not matter.
    """
    between_them = between(a.astype(np.float64), b.astype(np.float64))
    w, v = between_them[..., 0], between_them[..., 1:]
    return np.asarray(2 * np.arctan2(norm(v), np.abs(w)), a.dtype)


def is_missing(q: Reals) -> Mask:
    """Tell the missing samples, those with a component that is not finite or with four zeros: `(..., 4)` → `(...)`."""
    missing: Mask = ~np.isfinite(q).all(axis=-1) | (q == 0).all(axis=-1)
    return missing


def continuous(q: Reals) -> Reals:
    """Flip signs so that a path of quaternions does not jump between `q` and `−q`; `(frames, joints, 4)`.

    Each valid sample takes the sign that makes its inner product with the valid sample before it `≥ 0`; the first one
    keeps its sign, and so does the path where two samples are exactly half a turn apart. Missing samples stay as they
    are, and continuity goes across them.
    """
    result = q.copy()
    valid = ~is_missing(q)
    for joint in range(q.shape[1]):
        path = q[valid[:, joint], joint].astype(np.float64)
        dots = np.sum(path[1:] * path[:-1], axis=-1)
        signs = np.cumprod(np.where(dots < 0, -1.0, 1.0))
        path[1:] *= signs[:, None]
        result[valid[:, joint], joint] = path
    return result


def scan(q: Reals) -> tuple[int, float, int]:
    """Check a clip `(frames, joints, 4)`: missing samples and lengths.

    Returns
    -------
    missing : int
        Number of missing samples.
    worst : float
        The largest `| |q| − 1 |` over the others, 0 if there are none.
    index : int
        Index of that sample, as `frame · joints + joint`; the first one.
    """
    flat = q.reshape(-1, 4).astype(np.float64)
    missing = is_missing(flat)
    if missing.all():
        return int(missing.sum()), 0.0, 0
    with np.errstate(invalid="ignore", over="ignore"):
        error = np.where(missing, -1, np.abs(norm(flat) - 1))
    index = int(np.argmax(error))
    return int(missing.sum()), float(error[index]), index
