"""Charts: rotations as vectors, in which they can be compared and averaged."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from quatfilt._reference._arrays import Indices, Mask, Reals
from quatfilt._reference.rotations.mean import mean
from quatfilt._reference.rotations.quaternion import between, exp, log, log_short, multiply, norm, normalize

ChartName = Literal["mean", "identity", "local"]

LIMIT = 1.5 * np.pi
"""Length of a rotation vector (radians) beyond which one chart no longer serves: near 2π neighbouring rotations lie
far apart in it."""


@dataclass(frozen=True)
class Chart:
    """A path of rotations and its vectors."""

    rotations: Reals
    """Unit quaternions, continuous in sign, `(frames, joints, 4)`."""
    base: Reals
    """Where each joint's chart touches the rotations, `(joints, 4)`."""
    vectors: Reals
    """Rotation vectors `2 log(base⁻¹ q)` in radians, `(frames, joints, 3)`."""
    local: Mask
    """Which joints have no base: they are seen from each frame in turn, `(joints,)`."""

    def differences(self, u: Indices, v: Indices) -> Reals:
        """Rotation vectors that lead from the frames `u` to the frames `v`, `(len(u), joints, 3)`."""
        result = self.vectors[v] - self.vectors[u]
        local = self.local
        result[:, local] = 2 * log_short(between(self.rotations[u][:, local], self.rotations[v][:, local]))
        return result

    def moved(self, u: Indices, by: Reals) -> Reals:
        """Rotations at the frames `u` moved by rotation vectors `(len(u), joints, 3)`; the inverse of `differences`."""
        in_chart = multiply(self.base[None], exp((self.vectors[u] + by) / 2))
        from_itself = multiply(self.rotations[u], exp(by / 2))
        return normalize(np.where(self.local[:, None], from_itself, in_chart))


def choose_chart(rotations: Reals, own: Reals, name: ChartName) -> Chart:
    """Turn an extended path of rotations into vectors `2 log(base⁻¹ q)`, of lengths up to 2π.

    The path is continuous in sign and its logarithm is not folded back to `w ≥ 0`, so it does not jump where a joint
    turns by more than π away from the base. Of the two signs of the whole path, one has to be chosen:

    - `"identity"`: the base is 1, and the first component that is not 0 of the clip's first frame is positive.
    - `"mean"`: the base is the Karcher mean of the clip's own frames, and `Σ w ≥ 0` over them, seen from the base.
      A joint that nevertheless turns further than `LIMIT` is seen locally.
    - `"local"`: frame `v` is seen from frame `u` itself, `2 log(q_u⁻¹ q_v)` the shorter way.

    Parameters
    ----------
    rotations : array (N, joints, 4)
        The clip with its continuation beyond both ends; unit quaternions, continuous in sign.
    own : array (frames, joints, 4)
        The clip alone.
    name : "identity", "mean" or "local"
    """
    joints = own.shape[1]
    if name == "mean":
        base = mean(own, None)
        side = between(base[None], own)[..., 0].sum(axis=0)
    else:
        base = np.tile([1.0, 0.0, 0.0, 0.0], (joints, 1))
        side = first_nonzero(own[0])
    path = np.where(side < 0, -1, 1)[:, None] * rotations
    vectors = 2 * log(between(base[None], path))
    local = norm(vectors).max(axis=0) > LIMIT if name == "mean" else np.full(joints, name == "local")
    return Chart(path, base, vectors, local)


def first_nonzero(q: Reals) -> Reals:
    """First component that is not 0 of each quaternion, `(joints, 4)` → `(joints,)`."""
    return np.take_along_axis(q, np.argmax(q != 0, axis=1)[:, None], axis=1)[:, 0]
