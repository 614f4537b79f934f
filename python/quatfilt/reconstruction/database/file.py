"""The file of a database: a header, arrays that are mapped where they lie, and a description at the end.

Numbers are little-endian. The first 64 bytes are the header: 16 bytes that tell what the file is, the version (32 bits), the CRC-32
of the description (32), where the description begins, how long it is and how long the file is (64 each), 12 zeros, and the CRC-32 of
the 60 bytes before. The description is JSON: joints, clips, and for each array its place, type, shape and CRC-32. Arrays begin at
multiples of 64 bytes.
"""

import json
import mmap
import sys
import zlib
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from quatfilt import _validation
from quatfilt.errors import FileAccessError, FileFormatError
from quatfilt.formats._atomic import reason
from quatfilt.reconstruction.database.contents import Clips, Contents, EndSites
from quatfilt.reconstruction.database.writer import ALIGNMENT, HEADER, MAGIC, VERSION, Writer

_PIECE = 16 << 20
"""Bytes that are checked or written at once."""

_DTYPES = {
    "rotations": "<f4",
    "features": "<f4",
    "heading": "<f4",
    "translation": "<f4",
    "starts": "<i8",
    "skeleton_indices": "<i8",
    "offsets": "<f8",
    "end_sites": "<f8",
    "mean_rotations": "<f8",
    "joint_weights": "<f8",
    "graph": "<i4",
}
"""The arrays, and what they hold."""

_OPTIONAL = ("graph",)

_LONG = ("rotations", "features", "heading", "translation", "graph")
"""The arrays with a row for each pose: to read them takes longer than a file may take to be opened."""


def write(path: str, contents: Contents, graph: NDArray[np.int32] | None) -> None:
    """Write a database.

    Raises
    ------
    FileAccessError
        If the file cannot be written.
    """
    with Writer(path) as writer:
        _append(writer, "rotations", contents.rotations)
        _append(writer, "features", contents.features)
        finish(writer, contents.clips, contents.mean_rotations, contents.joint_weights, graph)


def finish(
    writer: Writer,
    clips: Clips,
    means: NDArray[np.float64],
    weights: NDArray[np.float64],
    graph: NDArray[np.int32] | None,
) -> None:
    """Write what comes after rotations and features, and give the file its name."""
    _append(writer, "heading", clips.heading)
    _append(writer, "translation", clips.translation)
    for name in ("starts", "skeleton_indices", "offsets"):
        _append(writer, name, getattr(clips, name))
    _append(writer, "end_sites", clips.end_sites.places)
    _append(writer, "mean_rotations", means)
    _append(writer, "joint_weights", weights)
    if graph is not None:
        _append(writer, "graph", graph)
    writer.finish(
        {
            "names": list(clips.names),
            "parents": clips.parents.tolist(),
            "centimetres_per_unit": clips.centimetres_per_unit,
            "fps": clips.fps,
            "up": clips.up,
            "clip_names": list(clips.clip_names),
            "end_site_names": list(clips.end_sites.names),
            "notes": list(clips.notes),
        }
    )


def _append(writer: Writer, name: str, array: NDArray[Any]) -> None:
    """Write an array in pieces, so that an interruption does not wait for all of it."""
    rows = max(1, _PIECE // max(1, array[:1].nbytes))
    for start in range(0, max(1, len(array)), rows):
        writer.append(name, np.ascontiguousarray(array[start : start + rows], _DTYPES[name]))


def read(path: str, *, verify: bool) -> Contents:
    """Map the file of a database.

    Raises
    ------
    FileFormatError
        If it is no database, a damaged one, or one of a newer version.
    FileAccessError
        If it cannot be read.
    """
    if sys.byteorder != "little":
        raise FileFormatError(path, None, "databases are little-endian, and this machine is not")
    try:
        with Path(path).open("rb") as file:
            header = file.read(HEADER.size)
            length = file.seek(0, 2)
            place, size, checksum = _checked_header(path, header, length)
            buffer = mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ)
    except (OSError, ValueError) as error:
        if isinstance(error, FileFormatError):
            raise
        raise FileAccessError(path, reason(error)) from None
    text = buffer[place : place + size]
    if zlib.crc32(text) != checksum:
        raise FileFormatError(
            path, None, "a damaged motion database: its description is not what was written"
        )
    try:
        description = json.loads(text)
        contents = _contents(buffer, description, length)
    except (KeyError, TypeError, ValueError, AttributeError, RecursionError) as error:
        raise FileFormatError(path, None, f"a damaged motion database: {_told(error)}") from None
    _verify(path, buffer, description, () if verify else _LONG)
    return contents


def _told(error: Exception) -> str:
    return f"no {error}" if isinstance(error, KeyError) else str(error)


def _checked_header(path: str, header: bytes, length: int) -> tuple[int, int, int]:
    """Return where the description is, how long, and its check sum."""
    if not header:
        raise FileFormatError(path, None, "not a motion database: the file is empty")
    if header[: len(MAGIC)] != MAGIC[: len(header)]:
        raise FileFormatError(path, None, "not a motion database")
    if len(header) < HEADER.size:
        raise FileFormatError(path, None, f"a damaged motion database: it ends after {length} bytes")
    _, version, checksum, place, size, expected, _, own = HEADER.unpack(header)
    if version > VERSION:
        raise FileFormatError(
            path,
            None,
            f"a motion database of version {version}, and this quatfilt reads up to {VERSION}: get a newer one",
        )
    if zlib.crc32(header[:-4]) != own:
        raise FileFormatError(path, None, "a damaged motion database: its header is not what was written")
    if length != expected:
        raise FileFormatError(
            path, None, f"a damaged motion database: expected {expected} bytes, got {length}"
        )
    if place + size > length:
        raise FileFormatError(path, None, "a damaged motion database: its description lies outside")
    return place, size, checksum


def _contents(buffer: mmap.mmap, description: dict[str, Any], length: int) -> Contents:
    """Return what a description describes; `ValueError` and `KeyError` where it does not."""
    sections = description["sections"]
    arrays = {
        name: _array(buffer, name, sections[name], length)
        for name in _DTYPES
        if name in sections or name not in _OPTIONAL
    }
    names = tuple(map(str, description["names"]))
    clip_names = tuple(map(str, description["clip_names"]))
    starts = arrays["starts"]
    _expect("starts", starts.shape, (len(clip_names) + 1,))
    if starts[0] != 0 or (np.diff(starts) < 1).any():
        raise ValueError("starts: expected numbers that increase from 0")
    poses, joints, skeletons = int(starts[-1]), len(names), len(arrays["offsets"])
    for name, shape in {
        "rotations": (poses, joints, 4),
        "features": (poses, 3 * joints),
        "heading": (poses,),
        "translation": (poses, 3),
        "skeleton_indices": (len(clip_names),),
        "offsets": (skeletons, joints, 3),
        "end_sites": (len(description["end_site_names"]), 5),
        "mean_rotations": (joints, 4),
        "joint_weights": (joints,),
    }.items():
        _expect(name, arrays[name].shape, shape)
    indices = arrays["skeleton_indices"]
    if (indices < 0).any() or (indices >= skeletons - 1).any():
        raise ValueError(f"skeleton_indices: expected numbers from 0 to {skeletons - 2}")
    graph = arrays.get("graph")
    if graph is not None:
        _expect("graph", graph.shape, (poses, *graph.shape[1:2]))
    clips = Clips(
        names,
        _validation.parents(description["parents"], joints),
        _validation.number(description["centimetres_per_unit"], "centimetres_per_unit", above=0),
        _validation.number(description["fps"], "fps", above=0),
        _validation.integer(description["up"], "up", at_least=0, at_most=2),
        arrays["offsets"],
        EndSites(arrays["end_sites"], tuple(description["end_site_names"])),
        indices,
        clip_names,
        starts,
        arrays["heading"],
        arrays["translation"],
        tuple(map(str, description["notes"])),
    )
    return Contents(
        clips,
        arrays["rotations"],
        arrays["mean_rotations"],
        arrays["joint_weights"],
        arrays["features"],
        graph,
    )


def _array(buffer: mmap.mmap, name: str, section: dict[str, Any], length: int) -> NDArray[Any]:
    """Map an array."""
    dtype = np.dtype(_DTYPES[name])
    if section["dtype"] != _DTYPES[name]:
        raise ValueError(f"{name}: expected dtype {_DTYPES[name]}, got {section['dtype']}")
    shape = tuple(_validation.integer(n, name, at_least=0) for n in section["shape"])
    offset = _validation.integer(section["offset"], name, at_least=HEADER.size)
    count = int(np.prod(shape, dtype=object))
    if offset % ALIGNMENT or offset + count * dtype.itemsize > length:
        raise ValueError(f"{name}: expected a place in the file, got {shape} at {offset} of {length} bytes")
    array = np.frombuffer(buffer, dtype, count, offset) if count else np.zeros(0, dtype)
    return array.reshape(shape)


def _expect(name: str, got: tuple[int, ...], expected: tuple[int, ...]) -> None:
    if got != expected:
        raise ValueError(f"{name}: expected shape {expected}, got {got}")


def _verify(path: str, buffer: mmap.mmap, description: dict[str, Any], unread: tuple[str, ...]) -> None:
    """Compare the arrays with their check sums, but for some that are not read."""
    for name, section in description["sections"].items():
        if name in unread:
            continue
        size = int(np.prod(section["shape"], dtype=object)) * np.dtype(section["dtype"]).itemsize
        end = section["offset"] + size
        sum_of_bytes = 0
        for start in range(section["offset"], end, _PIECE):
            sum_of_bytes = zlib.crc32(buffer[start : min(start + _PIECE, end)], sum_of_bytes)
        if sum_of_bytes != section.get("crc32"):
            raise FileFormatError(path, None, f"a damaged motion database: {name} is not what was written")


__all__ = ["Writer", "finish", "read", "write"]
