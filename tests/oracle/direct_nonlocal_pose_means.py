"""Non-local pose means frame by frame, candidate by candidate, offset by offset, on SciPy's rotations.

Written from the paper and the conventions of the project alone: nothing here comes from the package, so that it can
disagree with it.
"""

import math

import numpy as np
from scipy.spatial.transform import Rotation

CLOSE = 1e-12
"""Relative difference of patch distances that rounding can explain."""


def rotation(q):
    return Rotation.from_quat(q, scalar_first=True)


def signed_vector(q):
    """The rotation vector of a quaternion as it is, of length up to 2π."""
    vector = rotation(q).as_rotvec()
    length = np.linalg.norm(vector)
    if q[0] >= 0 or length == 0:
        return vector
    return vector * (length - 2 * math.pi) / length


def unfolded(path):
    """Flips signs so that consecutive quaternions lie in one hemisphere."""
    path = [q / np.linalg.norm(q) for q in path]
    for i in range(1, len(path)):
        if np.dot(path[i - 1], path[i]) < 0:
            path[i] = -path[i]
    return np.array(path)


def mirrored(index, frames):
    period = 2 * (frames - 1)
    index %= period
    return min(index, period - index)


class ExtendedJoint:
    """One joint, at any frame, also before the first and after the last."""

    def __init__(self, q, chart, boundary, reach):
        self.frames = len(q)
        self.boundary = boundary
        self.own = unfolded(q)
        everywhere = unfolded([self.quaternion(t) for t in range(-reach, self.frames + reach)])
        if np.dot(everywhere[reach], self.own[0]) < 0:
            everywhere = -everywhere
        self.local = chart == "local"
        self.reach = reach
        self.rotations = rotation(everywhere)
        if chart == "mean":
            mean = rotation(self.own).mean()
            for _ in range(200):
                mean = mean * Rotation.from_rotvec((mean.inv() * rotation(self.own)).as_rotvec().mean(axis=0))
            base = mean.as_quat(scalar_first=True)
            self.base = mean
        else:
            base = np.array([1.0, 0, 0, 0])
            self.base = Rotation.identity()
        # The product with the conjugate of the base, as a matrix, keeps the sign that SciPy would lose.
        w, x, y, z = base
        from_base = np.array([[w, x, y, z], [-x, w, z, -y], [-y, -z, w, x], [-z, y, -x, w]])
        seen = everywhere @ from_base.T
        own_w = seen[reach : reach + self.frames, 0]
        if (own_w.sum() if chart == "mean" else own_w[0]) < 0:
            seen = -seen
        self.vectors = np.array([signed_vector(q) for q in seen])
        if chart == "mean" and np.linalg.norm(self.vectors, axis=1).max() > 1.5 * math.pi:
            self.local = True

    def quaternion(self, t):
        last = self.frames - 1
        if 0 <= t <= last:
            return self.own[t]
        if self.boundary == "nearest":
            return self.own[0 if t < 0 else last]
        if self.boundary == "mirror":
            return self.own[mirrored(t, self.frames)]
        first, second, steps = (0, 1, t) if t < 0 else (last - 1, last, t - last)
        velocity = (rotation(self.own[first]).inv() * rotation(self.own[second])).as_rotvec()
        start = rotation(self.own[0 if t < 0 else last])
        return (start * Rotation.from_rotvec(steps * velocity)).as_quat(scalar_first=True)

    def difference(self, u, v):
        u, v = u + self.reach, v + self.reach
        if self.local:
            return (self.rotations[u].inv() * self.rotations[v]).as_rotvec()
        return self.vectors[v] - self.vectors[u]

    def moved(self, t, vector):
        t += self.reach
        if self.local:
            return self.rotations[t] * Rotation.from_rotvec(vector)
        return self.base * Rotation.from_rotvec(self.vectors[t] + vector)


def extended_scalar(values, t, boundary, *, straight):
    last = len(values) - 1
    if 0 <= t <= last:
        return values[t]
    if boundary == "mirror":
        return values[mirrored(t, len(values))]
    end = 0 if t < 0 else last
    if boundary == "linear" and straight:
        slope = values[1] - values[0] if t < 0 else values[last] - values[last - 1]
        return values[end] + (t - end) * slope
    return values[end]


def direct_nonlocal_pose_means(
    q,
    translation,
    confidence,
    bandwidth,
    search_radius,
    patch_radius,
    distance,
    weights,
    neighbors,
    chart,
    boundary,
    lookahead,
):
    """Rotations as a SciPy object of shape (frames · joints), positions or None, and where the answer is ambiguous.

    Where two candidates are equally good but for rounding, and only one of them may be kept, either answer is right:
    ``ambiguous`` is a mask (frames, joints).
    """
    frames, joints = q.shape[:2]
    reach = patch_radius + max(search_radius, 0)
    clip = [ExtendedJoint(q[:, j], chart, boundary, reach) for j in range(joints)]

    def trust(t, j):
        if confidence is None:
            return 1.0
        return extended_scalar(confidence[:, j], t, boundary, straight=False)

    def place(t):
        return extended_scalar(translation, t, boundary, straight=True)

    def patch_distance(t, s, group):
        last = patch_radius if lookahead < 0 else min(patch_radius, lookahead)
        total, trusted = 0.0, 0.0
        for o in range(-patch_radius, last + 1):
            for j in group:
                c = trust(t + o, j) * trust(s + o, j)
                difference = clip[j].difference(t + o, s + o)
                total += c * np.dot(difference, difference) / (2 * bandwidth[j] ** 2)
                trusted += c
        if trusted == 0:
            return math.inf
        return total / (3 * trusted) if distance == "mean" else total

    def candidates(t):
        first, last = (0, frames - 1) if search_radius < 0 else (t - search_radius, t + search_radius)
        if lookahead >= 0:
            last = min(last, t + lookahead - min(patch_radius, lookahead))
        return [s for s in range(first, last + 1) if s != t]

    def weights_of(t, group):
        likeness = {s: patch_distance(t, s, group) for s in candidates(t)}
        best = sorted(likeness, key=lambda s: (likeness[s], abs(s - t), s))
        unclear = False
        if 0 <= neighbors < len(best):
            last, next_one = likeness[best[neighbors - 1]], likeness[best[neighbors]]
            unclear = last < math.inf and math.isclose(last, next_one, rel_tol=CLOSE)
            best = best[:neighbors]
        result = {s: math.exp(-likeness[s]) for s in best if likeness[s] <= 120}
        result[t] = max([*result.values(), math.exp(-80)])
        return result, unclear

    rotations, positions = [], []
    ambiguous = np.zeros((frames, joints), bool)
    groups = [range(joints)] * joints if weights == "pose" else [[j] for j in range(joints)]
    for t in range(frames):
        for j in range(joints):
            f, ambiguous[t, j] = weights_of(t, groups[j])
            total = sum(weight * trust(s, j) for s, weight in f.items())
            vector = np.zeros(3)
            if total > 0:
                vector = sum(w * trust(s, j) * clip[j].difference(t, s) for s, w in f.items()) / total
            rotations.append(clip[j].moved(t, vector).as_quat())
            if j == 0 and translation is not None:
                position = place(t)
                if total > 0:
                    position = sum(w * trust(s, 0) * place(s) for s, w in f.items()) / total
                positions.append(position)
    positions = None if translation is None else np.array(positions)
    return Rotation.from_quat(np.array(rotations)), positions, ambiguous
