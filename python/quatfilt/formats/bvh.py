"""Biovision hierarchy files."""

from dataclasses import dataclass

import numpy as np

from quatfilt import _backend
from quatfilt._backend import ops
from quatfilt.errors import FileFormatError
from quatfilt.formats import channels
from quatfilt.formats.channels import Turns, Values
from quatfilt.motion.motion import Motion
from quatfilt.motion.skeleton import EndSite, Skeleton

_POSITIONS = ("Xposition", "Yposition", "Zposition")
_ROTATIONS = ("Zrotation", "Yrotation", "Xrotation")
"""Channels of joints that came from elsewhere, in the commonest order."""

_BODY = 15
"""A skeleton of fewer joints is no CMU recording, whose conversions have 31 and more."""

_REST_ROOT = 1e-9
"""Radians by which a root is turned in a rest row: not at all, but for a rounding."""

_REST_JOINT = np.radians(1.0)
"""Most joints of a rest row are turned by less than this."""

_ROOT_JUMP, _JOINT_JUMP = np.radians(0.5), np.radians(10.0)
"""From a rest row to the recording, the root or another joint turns by more than this…"""

_LEAP = 5.0
"""…and by so many times what it does next; some conversions blend the joints, but the root, over several rows."""


@dataclass(frozen=True)
class Source:
    """What it takes to write a file again."""

    channels: tuple[tuple[str, ...], ...]
    parents: tuple[int, ...]
    seconds: float
    seconds_text: str
    values: Values
    """Channel values of the motion's frames."""
    rest: Values
    """The rest row that was left out: one row or none."""


def read(path: str, data: bytes, *, fps: float | None, first_frame: str) -> Motion:
    """Make a motion of the text of a file."""
    try:
        joints, (seconds, text), values, notes = _backend.files().read_bvh(data)
    except _backend.files().FormatError as error:
        raise FileFormatError(path, *error.args) from None
    skeleton = Skeleton(
        [joint[0] for joint in joints],
        np.array([joint[1] for joint in joints], np.int64),
        np.array([joint[2] for joint in joints], np.float64),
        end_sites=[
            EndSite(index, offset, name) for index, joint in enumerate(joints) for name, offset in joint[4]
        ],
    )
    names = tuple(tuple(joint[3]) for joint in joints)
    rotations = channels.rotations(values, _turns(names))
    left_out = 0
    if first_frame == "drop":
        values, rotations = values[1:], rotations[1:]
    elif first_frame == "auto" and _begins_at_rest(rotations, skeleton):
        left_out = 1
        notes.append("the first row is a rest pose, no recording: left out, and put back when written")
    rest, values, rotations = values[:left_out], values[left_out:], rotations[left_out:]
    local = _positions(values, names, skeleton)
    moves = any(_moves(names[joint], skeleton, joint) for joint in range(1, len(skeleton)))
    return Motion._read(  # noqa: SLF001 - the readers' door
        rotations,
        np.ascontiguousarray(local[:, 0]),
        fps=fps or 1 / seconds,
        skeleton=skeleton,
        joint_translations=local if moves else None,
        notes=tuple(notes),
        source=Source(names, tuple(skeleton.parents), seconds, text, values, rest),
    )


def _turns(names: tuple[tuple[str, ...], ...]) -> list[Turns]:
    joints = []
    column = 0
    for joint in names:
        turning = [i for i, name in enumerate(joint) if name not in _POSITIONS]
        axes = "".join(joint[i][0] for i in turning)
        joints.append(Turns(axes, tuple(column + i for i in turning)))
        column += len(joint)
    return joints


def _places(names: tuple[tuple[str, ...], ...]) -> dict[tuple[int, int], int]:
    """Return the column of each joint's position along each axis that it has a channel for."""
    columns = {}
    column = 0
    for joint, own in enumerate(names):
        for name in own:
            if name in _POSITIONS:
                columns[joint, _POSITIONS.index(name)] = column
            column += 1
    return columns


def _moves(names: tuple[str, ...], skeleton: Skeleton, joint: int) -> bool:
    """Tell whether a joint moves in its parent, or stands elsewhere than the first root."""
    return skeleton.parents[joint] < 0 or any(name in _POSITIONS for name in names)


def _positions(values: Values, names: tuple[tuple[str, ...], ...], skeleton: Skeleton) -> Values:
    """Return the joints' positions in their parents, ``(frames, joints, 3)``, or of the first root alone.

    Channels replace the offset; what has none stays there.
    """
    places = _places(names)
    joints = len(names) if any(_moves(names[j], skeleton, j) for j in range(1, len(names))) else 1
    result = np.repeat(skeleton.offsets[None, :joints], len(values), axis=0)
    for (joint, axis), column in places.items():
        result[:, joint, axis] = values[:, column]
    return result


def _begins_at_rest(rotations: Values, skeleton: Skeleton) -> bool:
    """Tell whether the first row is a rest pose: every comparison with a missing sample says no."""
    if len(rotations) < 3 or len(skeleton) < _BODY:
        return False
    identity = np.zeros_like(rotations[0])
    identity[:, 0] = 1
    turned = ops().geodesic_distance(rotations[0], identity)
    jump = ops().geodesic_distance(rotations[0], rotations[1])
    step = ops().geodesic_distance(rotations[1], rotations[2])
    roots = skeleton.parents < 0
    at_rest = turned[roots].max() <= _REST_ROOT and np.median(turned) <= _REST_JOINT
    root_leaps = jump[roots].max() > max(_ROOT_JUMP, _LEAP * step[roots].max())
    joints_leap = jump.max() > _JOINT_JUMP and jump.mean() > _LEAP * step.mean()
    return bool(at_rest and (root_leaps or joints_leap))


def write(path: str, motion: Motion) -> bytes:
    """Return the text of a file."""
    source = motion._source  # noqa: SLF001 - what the reader left for the writer
    if not isinstance(source, Source) or source.parents != tuple(motion.skeleton.parents):
        source = None
    names = _channel_names(motion, source)
    same_frames = source is not None and len(source.values) == len(motion)
    original = _rearranged(source, names) if source is not None and same_frames else None
    table = np.zeros((len(motion), sum(map(len, names))))
    channels.write_rotations(table, motion.rotations, _turns(names), original)
    local = motion.joint_translations
    for (joint, axis), column in _places(names).items():
        if joint == 0:
            values = motion.translation[:, axis]
        elif local is not None:
            values = local[:, joint, axis]
        else:
            values = np.full(len(motion), motion.skeleton.offsets[joint, axis])
        table[:, column] = channels.rounded(values, None if original is None else original[:, column])
    seconds, text = 1 / motion.fps, repr(1 / motion.fps)
    if source is not None:
        if motion.fps == 1 / source.seconds:
            seconds, text = source.seconds, source.seconds_text
        if same_frames and len(source.rest):
            table = np.concatenate([_rearranged(source, names, rest=True), table])
    joints = _joints(motion.skeleton, names, close=source is None)
    try:
        return bytes(_backend.files().write_bvh(joints, (seconds, text), np.ascontiguousarray(table)))
    except _backend.files().FormatError as error:
        raise FileFormatError(path, *error.args) from None


def _channel_names(motion: Motion, source: Source | None) -> tuple[tuple[str, ...], ...]:
    """Return the channels of the file that the motion came from, or common ones, and those that are needed besides."""
    skeleton, local = motion.skeleton, motion.joint_translations
    result = []
    for joint in range(len(skeleton)):
        places = motion.translation if joint == 0 else None if local is None else local[:, joint]
        if source is None:
            names: tuple[str, ...] = _ROTATIONS if places is None else _POSITIONS + _ROTATIONS
        else:
            names = source.channels[joint]
            if places is not None:
                offset = skeleton.offsets[joint].astype(places.dtype)
                missing = [
                    name
                    for axis, name in enumerate(_POSITIONS)
                    if name not in names and (places[:, axis] != offset[axis]).any()
                ]
                names = (*missing, *names)
            axes = "".join(name[0] for name in names if name not in _POSITIONS)
            if channels.lacking_axes(motion.rotations[:, joint], axes):
                names = (*names, *(f"{axis}rotation" for axis in channels.completed(axes)[len(axes) :]))
        result.append(names)
    return tuple(result)


def _rearranged(source: Source, names: tuple[tuple[str, ...], ...], *, rest: bool = False) -> Values:
    """Return the values of a file in the columns of `names`; zeros in channels that it does not have."""
    values = source.rest if rest else source.values
    if names == source.channels:
        return values
    old = [(joint, name) for joint, own in enumerate(source.channels) for name in own]
    place = {key: column for column, key in enumerate(old)}
    result = np.zeros((len(values), sum(map(len, names))))
    for column, key in enumerate((joint, name) for joint, own in enumerate(names) for name in own):
        if key in place:
            result[:, column] = values[:, place[key]]
    return result


def _joints(
    skeleton: Skeleton, names: tuple[tuple[str, ...], ...], *, close: bool
) -> list[tuple[str, int, tuple[float, ...], list[str], list[tuple[str | None, tuple[float, float, float]]]]]:
    """Return the joints as the core takes them; `close` ends bones that have no end site, which many programs expect."""
    sites: list[list[tuple[str | None, tuple[float, float, float]]]] = [[] for _ in names]
    for site in skeleton.end_sites:
        sites[site.joint].append((site.name, site.offset))
    if close:
        parents = set(skeleton.parents)
        for joint, own in enumerate(sites):
            if joint not in parents and not own:
                own.append((None, (0.0, 0.0, 0.0)))
    return [
        (name, int(parent), tuple(map(float, offset)), list(own), ends)
        for name, parent, offset, own, ends in zip(
            skeleton.names, skeleton.parents, skeleton.offsets, names, sites, strict=True
        )
    ]


__all__ = ["Source", "read", "write"]
