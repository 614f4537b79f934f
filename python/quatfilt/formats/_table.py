"""The formats of motion files: a new one is a line of this table."""

import os
from collections.abc import Callable
from dataclasses import dataclass
from typing import Final, TypeAlias

from quatfilt import _validation
from quatfilt.formats import acclaim, bvh, npz
from quatfilt.formats._bytes import read_bytes
from quatfilt.motion.motion import Motion
from quatfilt.motion.skeleton import Skeleton

SkeletonLike: TypeAlias = str | os.PathLike[str] | Skeleton | None
Reader: TypeAlias = Callable[[str, bytes, float | None, str, SkeletonLike], Motion]
"""Path, contents, frame rate, first frame and skeleton → motion."""
Writer: TypeAlias = Callable[[str, Motion], bytes]


@dataclass(frozen=True)
class Format:
    """A format of motion files.

    Parameters
    ----------
    read : callable
        From the path, the contents and the options of `read_motion` to a motion.
    write : callable or None
        From the path and a motion to the contents; None for formats that are read only.
    needs_skeleton : bool
        Whether the skeleton is in a file of its own.
    note : str
        For help texts.
    """

    read: Reader
    write: Writer | None
    needs_skeleton: bool = False
    note: str = ""


def _read_bvh(path: str, data: bytes, fps: float | None, first_frame: str, skeleton: SkeletonLike) -> Motion:
    del skeleton
    return bvh.read(path, data, fps=fps, first_frame=first_frame)


def _read_npz(path: str, data: bytes, fps: float | None, first_frame: str, skeleton: SkeletonLike) -> Motion:
    del skeleton
    return npz.read(path, data, fps=fps, first_frame=first_frame)


def _read_amc(path: str, data: bytes, fps: float | None, first_frame: str, skeleton: SkeletonLike) -> Motion:
    if not isinstance(skeleton, Skeleton):
        asf = acclaim.find_skeleton(path) if skeleton is None else _validation.path(skeleton, "skeleton")
        skeleton = acclaim.read_skeleton(asf, read_bytes(asf))
    return acclaim.read(path, data, skeleton, fps=fps, first_frame=first_frame)


def _write_bvh(path: str, motion: Motion) -> bytes:
    return bvh.write(path, motion)


def _write_npz(path: str, motion: Motion) -> bytes:
    del path
    return npz.write(motion)


FORMATS: Final[dict[str, Format]] = {
    ".bvh": Format(_read_bvh, _write_bvh),
    ".amc": Format(_read_amc, None, needs_skeleton=True, note="with its .asf"),
    ".npz": Format(_read_npz, _write_npz),
}
"""By extension; the first format that can be written stands in for those that cannot."""

READABLE: Final = tuple(FORMATS)
WRITABLE: Final = tuple(extension for extension, entry in FORMATS.items() if entry.write is not None)


def needs_skeleton(extension: str) -> bool:
    """Return whether motions of that extension have their skeleton in a file of its own."""
    known = FORMATS.get(extension.lower())
    return known is not None and known.needs_skeleton


def written_as(extension: str) -> str:
    """Return the extension of the output that is made of such an input by default."""
    known = FORMATS.get(extension.lower())
    return WRITABLE[0] if known is not None and known.write is None else extension


def listed(extensions: tuple[str, ...], *, notes: bool = False) -> str:
    """Return extensions for a message: ``.bvh, .amc or .npz``."""
    words = [f"{x} ({FORMATS[x].note})" if notes and FORMATS[x].note else x for x in extensions]
    return " or ".join(filter(None, [", ".join(words[:-1]), words[-1]]))


__all__ = ["FORMATS", "READABLE", "WRITABLE", "Format", "listed", "needs_skeleton", "written_as"]
