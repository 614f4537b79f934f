"""NumPy archives: AMASS and SMPL, and motions as this package keeps them."""

import io
import zipfile
import zlib
from typing import Any

import numpy as np

from quatfilt.errors import FileFormatError
from quatfilt.formats import amass
from quatfilt.motion.motion import Motion
from quatfilt.motion.skeleton import EndSite, Skeleton

_NEEDED = ("rotations", "translation", "fps", "names", "parents", "offsets")


def read(path: str, data: bytes, *, fps: float | None, first_frame: str) -> Motion:
    """Make a motion of an archive."""
    arrays, notes = _arrays(path, data)
    try:
        if "poses" in arrays:
            return amass.read(path, arrays, notes, fps=fps, first_frame=first_frame)
        if "rotations" in arrays:
            return _read_own(path, arrays, notes, fps=fps, first_frame=first_frame)
    except FileFormatError:
        raise
    except (ValueError, TypeError) as error:
        raise FileFormatError(path, None, str(error)) from None
    found = ", ".join(sorted(arrays)[:8]) or "nothing"
    raise FileFormatError(path, None, f"expected the arrays `poses` and `trans`, or `rotations`, got {found}")


def _arrays(path: str, data: bytes) -> tuple[dict[str, Any], list[str]]:
    if not zipfile.is_zipfile(io.BytesIO(data)):
        raise FileFormatError(path, None, "not an .npz archive")
    arrays, notes = {}, []
    try:
        with np.load(io.BytesIO(data), allow_pickle=False) as archive:
            for name in archive.files:
                try:
                    arrays[name] = archive[name]
                except ValueError:
                    notes.append(f"`{name}` holds Python objects, which are not read: left out")
    except (OSError, ValueError, EOFError, KeyError, zlib.error, zipfile.BadZipFile, NotImplementedError):
        raise FileFormatError(path, None, "not an .npz archive, or a damaged one") from None
    return arrays, notes


def _read_own(
    path: str, arrays: dict[str, Any], notes: list[str], *, fps: float | None, first_frame: str
) -> Motion:
    for name in _NEEDED:
        if name not in arrays and not (name == "fps" and fps is not None):
            hint = ": give fps=" if name == "fps" else ""
            raise FileFormatError(path, None, f"no `{name}`{hint}")
    sites = zip(
        arrays.get("end_site_joints", []),
        arrays.get("end_site_offsets", []),
        arrays.get("end_site_names", []),
        strict=True,
    )
    skeleton = Skeleton(
        arrays["names"].tolist(),
        arrays["parents"],
        arrays["offsets"],
        centimetres_per_unit=float(arrays.get("centimetres_per_unit", 1.0)),
        end_sites=[EndSite(int(joint), tuple(offset), str(name) or None) for joint, offset, name in sites],
    )
    start = int(first_frame == "drop")
    moving = arrays.get("joint_translations")
    return Motion._read(  # noqa: SLF001 - the readers' door
        arrays["rotations"][start:],
        arrays["translation"][start:],
        fps=fps or float(arrays["fps"]),
        skeleton=skeleton,
        joint_translations=None if moving is None else moving[start:],
        notes=tuple(notes),
        source=None,
    )


def write(motion: Motion) -> bytes:
    """Return an archive: that of AMASS where the motion came from one, else our own."""
    source = motion._source  # noqa: SLF001 - what the reader left for the writer
    arrays = amass.arrays(motion, source) if isinstance(source, amass.Source) else _own(motion)
    buffer = io.BytesIO()
    np.savez(buffer, **arrays)
    return buffer.getvalue()


def _own(motion: Motion) -> dict[str, Any]:
    skeleton = motion.skeleton
    arrays = {
        "rotations": motion.rotations,
        "translation": motion.translation,
        "fps": motion.fps,
        "names": np.array(skeleton.names, np.str_),
        "parents": skeleton.parents,
        "offsets": skeleton.offsets,
        "centimetres_per_unit": skeleton.centimetres_per_unit,
    }
    if skeleton.end_sites:
        arrays["end_site_joints"] = np.array([site.joint for site in skeleton.end_sites])
        arrays["end_site_offsets"] = np.array([site.offset for site in skeleton.end_sites])
        arrays["end_site_names"] = np.array([site.name or "" for site in skeleton.end_sites])
    if motion.joint_translations is not None:
        arrays["joint_translations"] = motion.joint_translations
    return arrays


__all__ = ["read", "write"]
