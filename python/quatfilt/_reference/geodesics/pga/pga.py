"""Principal geodesic analysis of each joint's rotations."""

import numpy as np

from quatfilt._reference._arrays import Mask, Reals
from quatfilt._reference.geodesics.pga.circle import nearest_in_plane
from quatfilt._reference.geodesics.pga.objective import basis, value
from quatfilt._reference.geodesics.pga.sphere import nearest_geodesic, principal_axes
from quatfilt._reference.rotations.quaternion import between, is_missing, multiply, norm, normalize

NOTHING_LEFT = 1e-14
"""Radians on S³: residuals that are all nearer to 1 are roundings, and have no direction."""

FLAT = 1e-14
"""Distance from a plane through 0, of the longest, up to which vectors lie in it but for roundings."""

DECISIVE = 0.7
"""Share of the greatest parameter from which a sample may decide about the sign of an axis. No share that evenly spaced
samples of a swing have exactly, for then roundings would decide."""


def principal_geodesics(
    q: Reals, means: Reals, components: int, most: int, objective: str, tolerance: float
) -> tuple[Reals, Reals, Reals]:
    """Fit successive geodesics through the mean to each joint, each to the residuals of the previous ones.

    With `x = mean⁻¹ q`, in the half of S³ about 1, the first direction minimises the mean distance to its geodesic. The
    next one is fitted to the residuals `π_v(x)⁻¹ x`, and so on (Said et al. 2007, Algorithm 1). The vector parts of
    residuals lie across the direction before, and so does the next direction: it is sought in that plane.

    Parameters
    ----------
    q : array (frames, joints, 4)
        Rotations. Missing samples are left out.
    means : array (joints, 4)
        Unit quaternions.
    components : int
        Number of geodesics; 0 for as many as it takes until each joint's `R_k` is at most `tolerance`.
    most : int
        The most geodesics where `components` is 0.
    objective : {"geodesic", "squared", "chordal"}
        The objective: the mean of the distance `d` to the geodesic, of `d²`, or of `1 − cos d`.
    tolerance : float, radians of rotation

    Returns
    -------
    directions : array (k, joints, 3)
        Unit vectors. The first sample whose parameter is at least 0.7 of the greatest has a positive one. `(1, 0, 0)` where
        nothing is left to be fitted.
    residuals : array (k, joints), radians of rotation
        `R_k`, the mean angle that the first k geodesics leave; NaN for a joint without samples.
    descents : array (k, joints, steps)
        The objective, of distances on S³, at the steps of each descent; it never increases. NaN after the last step.
    """
    joints = q.shape[1]
    seen = ~is_missing(q)
    left = [centred(q[seen[:, j], j].astype(np.float64), means[j].astype(np.float64)) for j in range(joints)]
    directions: list[Reals] = []
    residuals: list[Reals] = []
    descents: list[list[list[float]]] = []
    angles = np.array([mean_angle(x) for x in left])
    # A comparison with NaN is false.
    while len(directions) < components or (
        not components and len(directions) < most and np.any(angles > tolerance)
    ):
        found = [
            next_geodesic(left[j], directions[-1][j] if directions else None, objective)
            for j in range(joints)
        ]
        directions.append(np.array([v for v, _ in found]).reshape(joints, 3))
        descents.append([values for _, values in found])
        left = [residual(left[j], directions[-1][j]) for j in range(joints)]
        angles = np.array([mean_angle(x) for x in left])
        residuals.append(angles)
    k = len(directions)
    steps = max((len(values) for row in descents for values in row), default=0)
    history = np.full((k, joints, steps), np.nan)
    for i, row in enumerate(descents):
        for j, values in enumerate(row):
            history[i, j, : len(values)] = values
    return (
        np.array(directions).reshape(k, joints, 3).astype(q.dtype),
        np.array(residuals).reshape(k, joints).astype(q.dtype),
        history.astype(q.dtype),
    )


def centred(q: Reals, mean: Reals) -> Reals:
    """Rotations `mean⁻¹ q` with `w ≥ 0`; `(n, 4)`, `(4,)`."""
    x = between(np.broadcast_to(normalize(mean), q.shape), normalize(q))
    return x * np.copysign(1, x[:, :1])


def next_geodesic(x: Reals, before: Reals | None, objective: str) -> tuple[Reals, list[float]]:
    """Direction of the geodesic nearest to the samples, and the objectives of the descent; `before` is the previous one."""
    if not np.any(norm(x[:, 1:]) > NOTHING_LEFT):
        v = np.array([1.0, 0.0, 0.0])
        return v, [value(x, v, objective)] if len(x) else []
    plane = None
    if objective == "geodesic":
        plane = plane_of(x) if before is None else basis(before)
    v, values = nearest_geodesic(x, objective) if plane is None else nearest_in_plane(x, plane)
    s = parameters(x, v)
    decisive = s[np.argmax(np.abs(s) >= DECISIVE * np.abs(s).max())]
    return v * np.copysign(1, decisive), values


def plane_of(x: Reals) -> Reals | None:
    """Two unit vectors in the plane of the vector parts, `(2, 3)`; None if they lie in no plane."""
    axes = principal_axes(x[:, 1:])
    off = np.abs(x[:, 1:] @ axes[2]).max()
    return axes[:2] if off <= FLAT * norm(x[:, 1:]).max() else None


def parameters(x: Reals, v: Reals) -> Reals:
    """Parameters `s* = atan2(v·u, w)` of the nearest points `c_v(s*)` of a geodesic, in `[−π/2, π/2]` for `w ≥ 0`."""
    return np.arctan2(x[:, 1:] @ v, x[:, 0])


def residual(x: Reals, v: Reals) -> Reals:
    """Return the residuals of a geodesic: `c_v(s*)⁻¹ x = (f, cos s* u⊥ − sin s* v × u⊥)`, `u⊥` being the part of `u` across `v`."""
    w, u = x[:, :1], x[:, 1:]
    p = (u @ v)[:, None]
    f = np.hypot(w, p)
    safe = np.where(f > 0, f, 1)
    across = u - p * v
    return normalize(np.concatenate([f, (w * across - p * np.cross(v, across)) / safe], axis=-1))


def mean_angle(x: Reals) -> float:
    """Mean rotation angle of the samples; NaN without any."""
    return float(np.mean(2 * np.arctan2(norm(x[:, 1:]), x[:, 0]))) if len(x) else np.nan


def geodesic_scores(q: Reals, means: Reals, directions: Reals) -> Reals:
    """Parameters of each sample's projections, one geodesic after the other, `(frames, joints, 4)` → `(frames, joints, k)`.

    In radians of rotation, `2 s*`, in `[−π, π]`; NaN for missing samples.
    """
    frames, joints = q.shape[:2]
    scores = np.full((frames, joints, len(directions)), np.nan)
    seen: Mask = ~is_missing(q)
    for joint in range(joints):
        x = centred(q[seen[:, joint], joint].astype(np.float64), means[joint].astype(np.float64))
        for k, v in enumerate(directions[:, joint].astype(np.float64)):
            scores[seen[:, joint], joint, k] = 2 * parameters(x, v)
            x = residual(x, v)
    return scores.astype(q.dtype)


def geodesic_product(scores: Reals, means: Reals, directions: Reals) -> Reals:
    """Rotations `mean · c_{v_1}(s_1) · c_{v_2}(s_2) · …`, `(frames, joints, k)` → `(frames, joints, 4)`, `w ≥ 0`."""
    frames, joints, components = scores.shape
    q: Reals = np.ascontiguousarray(np.broadcast_to(means.astype(np.float64), (frames, joints, 4)))
    for k in range(components):
        s = scores[..., k, None].astype(np.float64) / 2
        factor = np.concatenate([np.cos(s), np.sin(s) * directions[k].astype(np.float64)], axis=-1)
        q = multiply(q, factor)
    return (q * np.copysign(1, q[..., :1])).astype(scores.dtype)
