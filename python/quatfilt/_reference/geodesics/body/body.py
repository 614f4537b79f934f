"""Principal geodesic analysis of whole poses."""

import numpy as np

from quatfilt._reference._arrays import Reals
from quatfilt._reference.geodesics.body.distance import parts
from quatfilt._reference.geodesics.body.nearest import nearest_geodesic
from quatfilt._reference.geodesics.body.projection import nearest_point
from quatfilt._reference.geodesics.pga.pga import DECISIVE, NOTHING_LEFT, next_geodesic
from quatfilt._reference.rotations.quaternion import between, is_missing, multiply, norm, normalize


def body_geodesics(
    q: Reals, means: Reals, components: int, most: int, objective: str, tolerance: float
) -> tuple[Reals, Reals, Reals]:
    """Fit successive geodesics of whole poses through the means, each to the residuals of the previous ones.

    A pose is a point of the product of all joints' rotations, and its distance to another one `√(Σ_j d_j²)`. The geodesic
    with the direction `v`, a unit vector of `R^{3J}`, is `c_v(s) = (exp(s v_1), …, exp(s v_J))`, up to where its fastest
    joint has turned by half a turn. What it leaves of a pose is `c_v(s)⁻¹ x`, joint by joint, where `s` is the parameter of
    the nearest point.

    Parameters
    ----------
    q : array (frames, joints, 4)
        Rotations. Missing samples are left out of the distance of their pose.
    means : array (joints, 4)
        Unit quaternions.
    components : int
        Number of geodesics; 0 for as many as it takes until `R_k` is at most `tolerance`.
    most : int
        The most geodesics where `components` is 0.
    objective : {"geodesic", "squared", "chordal"}
        The objective: the mean of the distance to the geodesic, of its square, or of the sum over the joints of
        `1 − cos d_j`, whose nearest point is taken for this.
    tolerance : float, radians of rotation

    Returns
    -------
    directions : array (k, joints, 3)
        Unit vectors of `R^{3J}`. The first pose whose parameter is at least 0.7 of the greatest has a positive one. The first
        axis of the first joint where nothing is left to be fitted.
    residuals : array (k,), radians of rotation
        `R_k`, the mean distance that the first k geodesics leave; NaN without poses.
    descents : array (k, steps)
        The objective, of distances on S³, at the steps of each descent; it never increases. NaN after the last step.
    """
    joints = q.shape[1]
    x = poses(q, means)
    x = x[np.any(x != 0, axis=(1, 2))]
    directions: list[Reals] = []
    residuals: list[float] = []
    descents: list[list[float]] = []
    angle = mean_distance(x)
    while len(directions) < components or (not components and len(directions) < most and angle > tolerance):
        v, values = next_direction(x, directions[-1] if directions else None, objective)
        s = parameters(x, v)
        decisive = s[np.argmax(np.abs(s) >= DECISIVE * np.abs(s).max(initial=0))] if len(s) else 1.0
        directions.append(v * np.copysign(1, decisive))
        descents.append(values)
        x = remainder(x, v, s)
        angle = mean_distance(x)
        residuals.append(angle)
    k = len(directions)
    history = np.full((k, max((len(values) for values in descents), default=0)), np.nan)
    for i, values in enumerate(descents):
        history[i, : len(values)] = values
    return (
        np.array(directions).reshape(k, joints, 3).astype(q.dtype),
        np.array(residuals).astype(q.dtype),
        history.astype(q.dtype),
    )


def poses(q: Reals, means: Reals) -> Reals:
    """See samples from the means with `w ≥ 0`, in float64; four zeros where they are missing."""
    x = between(
        np.broadcast_to(normalize(means.astype(np.float64)), q.shape), normalize(q.astype(np.float64))
    )
    x = x * np.copysign(1, x[..., :1])
    return np.where(is_missing(q)[..., None], 0.0, x)


def next_direction(x: Reals, before: Reals | None, objective: str) -> tuple[Reals, list[float]]:
    """Direction of the geodesic nearest to the poses, and the objectives of the descent; `before` is the previous one.

    Joints that do not move have zero components. If a single joint moves, its own nearest geodesic is the body's.
    """
    joints = x.shape[1]
    moving = np.any(norm(x[..., 1:]) > NOTHING_LEFT, axis=0)
    v = np.zeros((joints, 3))
    if not moving.any():
        v[:1, 0] = 1
        return v, [0.0] if len(x) else []
    if moving.sum() > 1:
        v[moving], values = nearest_geodesic(x[:, moving], objective)
        return v, values
    joint = int(np.argmax(moving))
    there = np.any(x[:, joint] != 0, axis=-1)
    last = None if before is None or np.any(np.delete(before, joint, axis=0)) else before[joint]
    v[joint], values = next_geodesic(x[there, joint], last, objective)
    share = float(np.mean(there))
    return v, [value * share for value in values]


def parameters(x: Reals, v: Reals) -> Reals:
    """Parameters of the points of a geodesic that are nearest to poses."""
    return nearest_point(x, parts(v), "geodesic")


def remainder(x: Reals, v: Reals, s: Reals) -> Reals:
    """Return the residuals of poses from a geodesic, `c_v(s)⁻¹ x` with `w ≥ 0`."""
    left = between(points(s, v), x)
    lengths = norm(left)[..., None]
    return left / np.where(lengths > 0, lengths, 1) * np.copysign(1, left[..., :1])


def points(s: Reals, v: Reals) -> Reals:
    """Points `c_v(s)` of a geodesic, `(poses,)`, `(joints, 3)` → `(poses, joints, 4)`."""
    part = parts(v)
    theta = s[:, None, None] * part.lengths[:, None]
    return np.concatenate([np.cos(theta), np.sin(theta) * part.axes], axis=-1)


def mean_distance(x: Reals) -> float:
    """Mean distance of poses from 1 as an angle of rotation; NaN without any."""
    if not len(x):
        return np.nan
    half_angles = np.arctan2(norm(x[..., 1:]), x[..., 0])
    return float(np.mean(2 * norm(half_angles)))


def body_scores(q: Reals, means: Reals, directions: Reals) -> Reals:
    """Parameters of each pose's projections, one geodesic after the other, `(frames, joints, 4)` → `(frames, k)`.

    In radians of rotation, `2 s`; NaN for poses without a sample.
    """
    x = poses(q, means)
    there = np.any(x != 0, axis=(1, 2))
    x = x[there]
    scores = np.full((len(q), len(directions)), np.nan)
    for k, v in enumerate(directions.astype(np.float64)):
        s = parameters(x, v)
        scores[there, k] = 2 * s
        x = remainder(x, v, s)
    return scores.astype(q.dtype)


def body_product(scores: Reals, means: Reals, directions: Reals) -> Reals:
    """Poses `mean · c_{v_1}(s_1) · c_{v_2}(s_2) · …`, `(frames, k)` → `(frames, joints, 4)`, `w ≥ 0`."""
    frames, components = scores.shape
    q: Reals = np.ascontiguousarray(np.broadcast_to(means.astype(np.float64), (frames, *means.shape)))
    for k in range(components):
        q = multiply(q, points(scores[:, k].astype(np.float64) / 2, directions[k].astype(np.float64)))
    return (q * np.copysign(1, q[..., :1])).astype(scores.dtype)
