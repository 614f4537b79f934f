"""Tables of control points: CSV files with a header."""

import csv
import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from quatfilt.errors import FileAccessError, FileFormatError

_AXES = ("x", "y", "z")

_TIMES = ("time", "t", "seconds")

_FRAMES = ("frame", "index")

_EVEN = 0.01
"""Share of a frame by which times may differ from a constant rate: tables round their seconds."""


@dataclass(frozen=True)
class Points:
    """Trajectories of some joints.

    Parameters
    ----------
    joints : tuple of str
        Their names, in the order of the columns.
    positions : ndarray, shape (frames, points, 3)
        NaN where a cell is empty.
    fps : float or None
        Frame rate of a column of seconds.
    """

    joints: tuple[str, ...]
    positions: NDArray[np.float64]
    fps: float | None


def read(path: Path) -> Points:
    """Read a table: columns ``joint.x``, ``joint.y`` and ``joint.z`` for each joint, and ``time`` in seconds or ``frame``.

    Empty cells and NaN are points that are not seen.

    Raises
    ------
    FileAccessError
        If the file cannot be read.
    FileFormatError
        If it is no such table.
    """
    try:
        text = path.read_text(encoding="utf-8-sig")
    except OSError as error:
        raise FileAccessError(path, error.strerror or "cannot be read") from None
    except UnicodeDecodeError:
        raise FileFormatError(path, None, "expected text in UTF-8") from None
    rows = _rows(path, text)
    if not rows:
        raise FileFormatError(path, None, "expected a header and rows, got an empty file")
    header = [cell.strip() for cell in rows[0][1]]
    joints = _joints(path, header)
    values = np.array([_numbers(path, line, row, len(header)) for line, row in rows[1:]])
    if not len(values):
        raise FileFormatError(path, None, "expected rows below the header, got none")
    columns = {name: values[:, place] for place, name in enumerate(header)}
    places = [np.stack([columns[f"{joint}.{axis}"] for axis in _AXES], axis=1) for joint in joints]
    return Points(joints, np.stack(places, axis=1), _rate(path, header, values))


def _rows(path: Path, text: str) -> list[tuple[int, list[str]]]:
    """Return the rows that are not blank, each with the number of its line."""
    reader = csv.reader(text.splitlines(), skipinitialspace=True)
    try:
        return [(reader.line_num, row) for row in reader if any(row)]
    except csv.Error as error:
        raise FileFormatError(path, reader.line_num, str(error)) from None


def _joints(path: Path, header: list[str]) -> tuple[str, ...]:
    twice = [name for place, name in enumerate(header) if name in header[:place]]
    if twice:
        raise FileFormatError(path, None, f"two columns are named {twice[0]!r}; name each column once")
    joints: dict[str, None] = {}
    for name in header:
        joint, dot, axis = name.rpartition(".")
        if dot and axis in _AXES:
            joints[joint] = None
        elif name.lower() not in (*_TIMES, *_FRAMES):
            raise FileFormatError(
                path, None, f"expected columns joint.x, joint.y, joint.z, time or frame, got {name!r}"
            )
    for joint in joints:
        for axis in _AXES:
            if f"{joint}.{axis}" not in header:
                raise FileFormatError(path, None, f"expected a column {joint}.{axis} beside those of {joint}")
    if not joints:
        raise FileFormatError(path, None, "expected columns joint.x, joint.y, joint.z, got none")
    return tuple(joints)


def _numbers(path: Path, line: int, row: list[str], columns: int) -> list[float]:
    if len(row) != columns:
        raise FileFormatError(path, line, f"expected {columns} cells as in the header, got {len(row)}")
    numbers = []
    for cell in row:
        try:
            number = float(cell) if cell.strip() else math.nan
        except ValueError:
            number = math.inf
        if math.isinf(number):
            raise FileFormatError(path, line, f"expected a number, got {cell!r}")
        numbers.append(number)
    return numbers


def _rate(path: Path, header: list[str], values: NDArray[np.float64]) -> float | None:
    """Return the frame rate of a column of seconds."""
    place = next((place for place, name in enumerate(header) if name.lower() in _TIMES), None)
    if place is None or len(values) < 2:
        return None
    times = values[:, place]
    step = (times[-1] - times[0]) / (len(times) - 1)
    even = times[0] + step * np.arange(len(times))
    if not (step > 0 and np.abs(times - even).max() <= _EVEN * step + 1e-3):
        raise FileFormatError(path, None, "the column time must have seconds at a constant frame rate")
    return float(1 / step)
