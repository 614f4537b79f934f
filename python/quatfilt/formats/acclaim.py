"""Acclaim files: skeletons (ASF) and motions of them (AMC)."""

from pathlib import Path
from typing import Any

import numpy as np

from quatfilt import _backend
from quatfilt._backend import ops
from quatfilt.errors import FileFormatError
from quatfilt.formats import channels
from quatfilt.formats.channels import Turns, Values
from quatfilt.motion.motion import Motion
from quatfilt.motion.skeleton import EndSite, Skeleton

_FPS = 120.0
"""Frames per second of an AMC, which does not say: what CMU recorded at."""

_CMU_LENGTH = 0.45
_CENTIMETRES_PER_INCH = 2.54
"""A length of 0.45 in a skeleton of CMU means that a unit is 1/0.45 inches."""


def find_skeleton(path: str) -> str:
    """Return the skeleton beside a motion: that of its name up to the first ``_``, else the only one."""
    motion = Path(path)
    try:
        found = sorted(file for file in motion.parent.iterdir() if file.suffix.lower() in (".asf", ".asx"))
    except OSError:
        found = []
    named = [file for file in found if file.stem in (motion.stem, motion.stem.partition("_")[0])]
    chosen = named or found
    if not chosen:
        raise FileFormatError(path, None, "no skeleton: expected an .asf file beside it, or skeleton=")
    if len(chosen) > 1:
        names = ", ".join(file.name for file in chosen[:4]) + (", …" if len(chosen) > 4 else "")
        raise FileFormatError(path, None, f"several skeletons beside it ({names}): choose with skeleton=")
    return str(chosen[0])


def read_skeleton(path: str, data: bytes) -> Skeleton:
    """Make a skeleton of the text of an ASF file: the root, and the bones, each a joint where the bone begins."""
    asf = _parse(path, data)
    names, parents, offsets, ends = ["root"], [-1], [asf["root_position"]], [(0.0, 0.0, 0.0)]
    for name, parent, direction, length, *_ in asf["bones"]:
        names.append(name)
        parents.append(parent + 1)
        offsets.append(ends[parent + 1])
        ends.append(tuple(length * x for x in direction))
    leaves = sorted(set(range(1, len(names))) - set(parents))
    cmu = asf["length"] == _CMU_LENGTH
    skeleton = Skeleton(
        names,
        parents,
        offsets,
        centimetres_per_unit=_CENTIMETRES_PER_INCH / _CMU_LENGTH if cmu else 1.0,
        end_sites=[EndSite(leaf, ends[leaf]) for leaf in leaves],
    )
    skeleton._acclaim = data  # noqa: SLF001 - what it takes to read motions of it
    return skeleton


def read(path: str, data: bytes, skeleton: Skeleton, *, fps: float | None, first_frame: str) -> Motion:
    """Make a motion of the text of an AMC file."""
    text = skeleton._acclaim  # noqa: SLF001 - what `read_skeleton` left
    if text is None:
        raise ValueError("skeleton: expected one that was read with an .asf file")
    asf = _parse(path, text)
    try:
        values, unit, notes = _backend.files().read_amc(data, text)
    except _backend.files().FormatError as error:
        raise FileFormatError(path, *error.args) from None
    if first_frame == "drop":
        values = values[1:]
    notes = [*(f"skeleton: {note}" for note in asf["notes"]), *notes]
    if fps is None:
        notes.append(f"AMC has no frame rate: {_FPS:g} fps assumed")
    freedoms = [asf["root_order"], *(bone[6] for bone in asf["bones"])]
    starts = np.cumsum([0, *map(len, freedoms)])
    turns = [_turns(own, int(start)) for own, start in zip(freedoms, starts[:-1], strict=True)]
    frames = _frames(asf)
    turned = channels.rotations(values, turns, unit=unit)
    rotations = _between(frames, turned)
    moved = np.repeat(skeleton.offsets[None], len(values), axis=0)
    for joint, (own, start) in enumerate(zip(freedoms, starts[:-1], strict=True)):
        _move(moved[:, joint], values, own, int(start), None if joint == 0 else frames[joint])
    if any("l" in own for own in freedoms):
        notes.append("the degree of freedom `l`, which stretches a bone, is left out")
    slides = any(name[0] == "t" for own in freedoms[1:] for name in own)
    return Motion._read(  # noqa: SLF001 - the readers' door
        rotations,
        np.ascontiguousarray(moved[:, 0]),
        fps=fps or _FPS,
        skeleton=skeleton,
        joint_translations=moved if slides else None,
        notes=tuple(notes),
        source=None,
    )


def _parse(path: str, data: bytes) -> dict[str, Any]:
    try:
        asf: dict[str, Any] = _backend.files().read_asf(data)
    except _backend.files().FormatError as error:
        raise FileFormatError(path, *error.args) from None
    return asf


def _turns(freedoms: list[str], start: int) -> Turns:
    """Return the rotation channels: the first degree of freedom turns first, so it is the innermost."""
    turning = [(name[1].upper(), start + i) for i, name in enumerate(freedoms) if name[0] == "r"]
    turning.reverse()
    return Turns("".join(axis for axis, _ in turning), tuple(column for _, column in turning))


def _frames(asf: dict[str, Any]) -> Values:
    """Return the rotations ``(joints, 4)`` that turn the global frame into that of each bone."""
    turned = [(asf["root_orientation"], asf["root_axis_order"])]
    turned += [(axis, order) for _, _, _, _, axis, order, _ in asf["bones"]]
    result = np.empty((len(turned), 4))
    for row, (angles, order) in zip(result, turned, strict=True):
        radians = np.array(angles) if asf["angle"] == "radians" else np.radians(angles)
        row[:] = ops().from_euler(np.ascontiguousarray(radians[None, ::-1]), order[::-1])[0]
    return result


def _between(frames: Values, turned: Values) -> Values:
    """Return ``C·R·C⁻¹``: rotations about the axes of the bones, as seen from the global frame at rest."""
    shape = turned.shape
    there = np.ascontiguousarray(np.broadcast_to(frames, shape)).reshape(-1, 4)
    result: Values = ops().multiply(ops().multiply(there, turned.reshape(-1, 4)), ops().conjugate(there))
    return result.reshape(shape)


def _move(place: Values, values: Values, freedoms: list[str], start: int, frame: Values | None) -> None:
    """Move a joint ``(frames, 3)`` as its degrees of freedom say: the root to there, a bone from its place at rest."""
    along = {"xyz".index(name[1]): start + i for i, name in enumerate(freedoms) if name[0] == "t"}
    if frame is None:
        for axis, column in along.items():
            place[:, axis] = values[:, column]
    elif along:
        moved = np.zeros((len(values), 4))
        for axis, column in along.items():
            moved[:, 1 + axis] = values[:, column]
        place += _between(frame[None], moved[:, None])[:, 0, 1:]


__all__ = ["find_skeleton", "read", "read_skeleton"]
