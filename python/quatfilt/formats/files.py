"""Reading and writing motions, whatever the format."""

import os
from pathlib import Path
from typing import Literal, TypeAlias

from quatfilt import _validation
from quatfilt.errors import FileFormatError
from quatfilt.formats._bytes import read_bytes, write_bytes
from quatfilt.formats._table import FORMATS, READABLE, WRITABLE, listed
from quatfilt.motion.motion import Motion
from quatfilt.motion.skeleton import Skeleton

FirstFrame: TypeAlias = Literal["auto", "keep", "drop"]
PathLike: TypeAlias = str | os.PathLike[str]


def read_motion(
    path: PathLike,
    *,
    fps: float | None = None,
    skeleton: PathLike | Skeleton | None = None,
    first_frame: FirstFrame = "auto",
) -> Motion:
    r"""Read a motion from a file.

    Parameters
    ----------
    path : str or path
        ``.bvh``; ``.amc`` with a skeleton; ``.npz`` of AMASS or SMPL (``poses``, ``trans``), or as `write_motion` makes them.
    fps : float, hertz, optional
        Frames per second, instead of what the file says. AMC files say nothing: 120 unless told. An ``.npz`` without a frame
        rate is refused unless told.
    skeleton : str, path or Skeleton, optional
        For ``.amc``: an ``.asf`` (or ``.asx``) file, or the skeleton of a motion read with one. By default the file beside
        the motion that has its name up to the first ``_``, or the only one there.
    first_frame : {"auto", "keep", "drop"}
        CMU's recordings as BVH begin with a row that is no recording but a rest pose. ``"auto"`` leaves out such a row of a BVH
        file (the root not turned at all, most joints hardly, and a jump to the next row), says so in ``notes``, and
        `write_motion` puts it back. ``"keep"`` takes the first row for what the others are, ``"drop"`` drops it for good.

    Returns
    -------
    Motion
        float64. Its ``notes`` say what was repaired or assumed.

    Raises
    ------
    FileFormatError
        If the file does not hold what its name promises: path, line and reason.
    FileAccessError
        If it cannot be read.
    ValueError, TypeError
        For other options than those above.

    See Also
    --------
    write_motion

    Notes
    -----
    A 100 MB BVH file takes about half a second.

    Examples
    --------
    >>> import quatfilt as qf, tempfile, pathlib
    >>> text = "ROOT hips { OFFSET 0 0 0 CHANNELS 1 Xrotation }\nMOTION\nFrames: 2\nFrame Time: .025\n12.5\n13\n"
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = pathlib.Path(folder) / "two.bvh"
    ...     _ = path.write_text(text)
    ...     motion = qf.read_motion(path)
    >>> motion
    Motion(2 frames of 1 joint, 40 fps, 0.05 s, float64)
    >>> motion.notes
    ('line 1: HIERARCHY missing: the file starts with a root',)
    """
    rate = None if fps is None else _validation.number(fps, "fps", above=0)
    first = _validation.choice(first_frame, "first_frame", ("auto", "keep", "drop"))
    name = _validation.path(path, "path")
    extension = Path(name).suffix.lower()
    if extension in (".asf", ".asx"):
        raise FileFormatError(name, None, "a skeleton holds no motion: read the .amc, with this as skeleton=")
    if extension not in FORMATS:
        raise FileFormatError(name, None, f"expected {listed(READABLE)}, got {extension or 'no extension'}")
    entry = FORMATS[extension]
    if skeleton is not None and not entry.needs_skeleton:
        raise TypeError(f"skeleton: expected None for {extension}, which has its own")
    data = read_bytes(name)
    if not data:
        raise FileFormatError(name, None, "the file is empty")
    return entry.read(name, data, rate, first, skeleton)


def write_motion(path: PathLike, motion: Motion) -> None:
    """Write a motion to a file.

    The file is written under a temporary name and renamed, so that an interrupted run leaves an older file as it was.

    Parameters
    ----------
    path : str or path
        ``.bvh`` or ``.npz``. What came from a BVH file keeps its names, hierarchy, offsets, channels, end sites and frame time;
        what came from AMASS keeps its layout and all else that the file held.
    motion : Motion
        What is written. Samples that are the same as in the file that the motion came from get the same numbers; the curves of
        others are continuous.

    Raises
    ------
    FileFormatError
        If the extension is another, or the format cannot hold the motion.
    FileAccessError
        If the file cannot be written.
    TypeError
        If `motion` is no motion.

    See Also
    --------
    read_motion

    Examples
    --------
    >>> import quatfilt as qf, tempfile, pathlib
    >>> arm = qf.Skeleton(["shoulder", "elbow"], [-1, 0], [[0.0, 0, 0], [0, -30, 0]])
    >>> motion = qf.Motion([[[0.6, 0.8, 0, 0]] * 2] * 60, fps=30, skeleton=arm)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = pathlib.Path(folder) / "arm.bvh"
    ...     qf.write_motion(path, motion)
    ...     print(len(qf.read_motion(path)))
    60
    """
    if not isinstance(motion, Motion):
        raise TypeError(f"motion: expected a Motion, got {type(motion).__name__}")
    name = _validation.path(path, "path")
    extension = Path(name).suffix.lower()
    entry = FORMATS.get(extension)
    if entry is None:
        raise FileFormatError(name, None, f"expected {listed(WRITABLE)}, got {extension or 'no extension'}")
    write = entry.write
    if write is None:
        raise FileFormatError(name, None, f"{extension[1:].upper()} is read only: write {listed(WRITABLE)}")
    write_bytes(name, lambda: write(name, motion))


__all__ = ["FirstFrame", "PathLike", "read_motion", "write_motion"]
