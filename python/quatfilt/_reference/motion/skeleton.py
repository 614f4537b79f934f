"""Forward kinematics."""

import numpy as np
from numpy.typing import NDArray

from quatfilt._reference._arrays import Reals
from quatfilt._reference.rotations.quaternion import multiply


def forward_kinematics(
    rotations: Reals, translation: Reals, parents: NDArray[np.int64], offsets: Reals
) -> Reals:
    """Positions of the joints of a skeleton, `(frames, joints, 3)`.

    From the parent `p` of joint `j`: `g_j = g_p · q_j` and `x_j = x_p + g_p o_j g_p⁻¹`. At a root, `g = q` and `x` is the
    translation.

    Parameters
    ----------
    rotations : array (frames, joints, 4)
        Rotations `q` of each joint relative to its parent, unit quaternions.
    translation : array (frames, 3)
        Positions of the root.
    parents : array (joints,) of int64
        Index of each joint's parent, which comes before the joint; −1 for a root.
    offsets : array (joints, 3)
        Positions `o` of the joints relative to their parents.
    """
    global_rotations = rotations.astype(np.float64)
    positions = np.repeat(translation.astype(np.float64)[:, None], len(parents), axis=1)
    for joint, parent in enumerate(parents):
        if parent >= 0:
            above = global_rotations[:, parent]
            positions[:, joint] = positions[:, parent] + rotate(above, offsets[joint].astype(np.float64))
            global_rotations[:, joint] = multiply(above, global_rotations[:, joint])
    return positions.astype(rotations.dtype)


def forward_kinematics_moving(
    rotations: Reals, joint_translations: Reals, parents: NDArray[np.int64]
) -> Reals:
    """Positions of joints that move in their parents, `(frames, joints, 3)`.

    As `forward_kinematics`, with an offset for each frame: `x_j = x_p + g_p t_j g_p⁻¹`, and `x = t` at a root, of which
    there may be several.

    Parameters
    ----------
    rotations : array (frames, joints, 4)
        Rotations `q` of each joint relative to its parent, unit quaternions.
    joint_translations : array (frames, joints, 3)
        Positions `t` of the joints relative to their parents, and of the roots.
    parents : array (joints,) of int64
        Index of each joint's parent, which comes before the joint; −1 for a root.
    """
    global_rotations = rotations.astype(np.float64)
    positions = joint_translations.astype(np.float64)
    for joint, parent in enumerate(parents):
        if parent >= 0:
            above = global_rotations[:, parent]
            positions[:, joint] = positions[:, parent] + rotate(above, positions[:, joint])
            global_rotations[:, joint] = multiply(above, global_rotations[:, joint])
    return positions.astype(rotations.dtype)


def rotate(q: Reals, x: Reals) -> Reals:
    """Turn a vector by unit quaternions: `q x q⁻¹ = x + 2w (v × x) + 2 v × (v × x)` for `q = (w, v)`; `(..., 3)`."""
    w, v = q[..., :1], q[..., 1:]
    across = np.cross(v, x)
    return x + 2 * w * across + 2 * np.cross(v, across)
