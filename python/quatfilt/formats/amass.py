"""AMASS and SMPL: poses as rotation vectors of the joints of a body model."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from quatfilt._backend import ops
from quatfilt.errors import FileFormatError
from quatfilt.formats import channels
from quatfilt.motion.motion import Motion
from quatfilt.motion.skeleton import Skeleton

_CENTIMETRES_PER_METRE = 100.0

_RATES = ("mocap_framerate", "mocap_frame_rate", "framerate", "frame_rate", "fps")

_BODY = [
    "pelvis",
    "left_hip",
    "right_hip",
    "spine1",
    "left_knee",
    "right_knee",
    "spine2",
    "left_ankle",
    "right_ankle",
    "spine3",
    "left_foot",
    "right_foot",
    "neck",
    "left_collar",
    "right_collar",
    "head",
    "left_shoulder",
    "right_shoulder",
    "left_elbow",
    "right_elbow",
    "left_wrist",
    "right_wrist",
]
_BODY_PARENTS = [-1, 0, 0, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 9, 9, 12, 13, 14, 16, 17, 18, 19]
_HEAD, _LEFT_WRIST, _RIGHT_WRIST = 15, 20, 21

_PARTS = {
    66: {"root_orient": (0, 3), "pose_body": (3, 66)},
    72: {"root_orient": (0, 3), "pose_body": (3, 72)},
    156: {"root_orient": (0, 3), "pose_body": (3, 66), "pose_hand": (66, 156)},
    165: {
        "root_orient": (0, 3),
        "pose_body": (3, 66),
        "pose_jaw": (66, 69),
        "pose_eye": (69, 75),
        "pose_hand": (75, 165),
    },
}
"""Numbers of columns of `poses`, and what other arrays repeat of them."""


@dataclass(frozen=True)
class Source:
    """What it takes to write an archive again."""

    arrays: dict[str, Any]
    start: int
    fps: float


def _hands(first: int) -> tuple[list[str], list[int]]:
    """Return the fingers' joints, which begin at the joint `first`."""
    names: list[str] = []
    parents: list[int] = []
    for side, wrist in (("left", _LEFT_WRIST), ("right", _RIGHT_WRIST)):
        for finger in ("index", "middle", "pinky", "ring", "thumb"):
            for knuckle in (1, 2, 3):
                parents.append(wrist if knuckle == 1 else first + len(names) - 1)
                names.append(f"{side}_{finger}{knuckle}")
    return names, parents


def joints(columns: int) -> tuple[list[str], list[int]]:
    """Return names and parents of the joints of SMPL (66, 72 columns), SMPL-H (156) or SMPL-X (165)."""
    names, parents = list(_BODY), list(_BODY_PARENTS)
    if columns == 72:
        names += ["left_hand", "right_hand"]
        parents += [_LEFT_WRIST, _RIGHT_WRIST]
    if columns == 165:
        names += ["jaw", "left_eye_smplhf", "right_eye_smplhf"]
        parents += [_HEAD] * 3
    if columns in (156, 165):
        fingers, above = _hands(len(names))
        names += fingers
        parents += above
    return names, parents


def read(
    path: str, arrays: dict[str, Any], notes: list[str], *, fps: float | None, first_frame: str
) -> Motion:
    """Make a motion of the arrays of an archive."""
    poses = np.asarray(arrays["poses"])
    if poses.ndim == 3 and poses.shape[2] == 3:
        poses = poses.reshape(len(poses), -1)
    if poses.ndim != 2 or poses.shape[1] not in _PARTS:
        raise FileFormatError(
            path, None, f"poses: expected shape (frames, 66, 72, 156 or 165), got {arrays['poses'].shape}"
        )
    trans = np.asarray(arrays.get("trans", np.zeros((len(poses), 3))))
    if trans.shape != (len(poses), 3):
        raise FileFormatError(path, None, f"trans: expected shape ({len(poses)}, 3), got {trans.shape}")
    start = int(first_frame == "drop")
    rate = fps or _rate(path, arrays)
    names, parents = joints(poses.shape[1])
    if "trans" not in arrays:
        notes.append("no `trans`: the root stays at the origin")
    notes.append("bone lengths are not in the file: all joints lie at the root")
    skeleton = Skeleton(
        names, parents, np.zeros((len(names), 3)), centimetres_per_unit=_CENTIMETRES_PER_METRE
    )
    return Motion._read(  # noqa: SLF001 - the readers' door
        _rotations(poses[start:].astype(np.float64)),
        trans[start:].astype(np.float64),
        fps=rate,
        skeleton=skeleton,
        notes=tuple(notes),
        source=Source(arrays, start, rate),
    )


def _rate(path: str, arrays: dict[str, Any]) -> float:
    for name in _RATES:
        if name in arrays:
            rate = np.asarray(arrays[name])
            if rate.size != 1 or rate.dtype.kind not in "iuf" or not 0 < float(rate.ravel()[0]) < np.inf:
                raise FileFormatError(path, None, f"{name}: expected a positive number, got {rate}")
            return float(rate.ravel()[0])
    raise FileFormatError(path, None, "no `mocap_framerate` or `mocap_frame_rate`: give fps=")


def _rotations(poses: channels.Values) -> channels.Values:
    rotations: channels.Values = ops().exp(poses.reshape(-1, 3) / 2)
    return rotations.reshape(len(poses), -1, 4)


def arrays(motion: Motion, source: Source) -> dict[str, Any]:
    """Return the arrays of an archive with the poses of `motion`, and all else that it held."""
    before = np.asarray(source.arrays["poses"])
    old = before.reshape(len(before), -1)[source.start :].astype(np.float64)
    q = motion.rotations
    poses = 2 * _log(q.astype(np.float64))
    trans = motion.translation.astype(np.float64)
    result = dict(source.arrays)
    if len(old) == len(motion):
        old = old.reshape(poses.shape)
        # The rotation vector is one of two, by the sign of the quaternion: the nearer to that of the file.
        other = 2 * _log(-q.astype(np.float64))
        poses = np.where(_length(other - old) < _length(poses - old), other, poses)
        poses = np.where(
            channels.same_rotations(q, _rotations(old.reshape(len(old), -1)))[..., None], old, poses
        )
    if len(motion) != len(before):
        for name, array in source.arrays.items():
            if np.ndim(array) and len(array) == len(before) and name not in ("poses", "trans", "betas"):
                del result[name]
    flat = poses.reshape(len(motion), -1)
    for name, (start, end) in _PARTS[flat.shape[1]].items():
        if name in result or name in source.arrays:
            result[name] = flat[:, start:end].astype(np.asarray(source.arrays[name]).dtype)
    result["poses"] = flat.reshape(len(motion), *before.shape[1:]).astype(before.dtype)
    if "trans" in source.arrays or trans.any():
        result["trans"] = trans.astype(np.asarray(source.arrays.get("trans", trans)).dtype)
    if motion.fps != source.fps or not any(name in result for name in _RATES):
        name = next((name for name in _RATES if name in result), "mocap_framerate")
        result[name] = np.array(motion.fps)
    return result


def _log(q: channels.Values) -> channels.Values:
    result: channels.Values = ops().log(q.reshape(-1, 4))
    return result.reshape(*q.shape[:-1], 3)


def _length(vectors: channels.Values) -> channels.Values:
    length: channels.Values = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return length


__all__ = ["Source", "arrays", "joints", "read"]
