"""Writes the file of a database in one go, under a temporary name.

A process that is killed leaves the file that was there before, and one of the temporary name beside it, which the next one that
writes there removes.
"""

import glob
import json
import os
import secrets
import shutil
import struct
import sys
import tempfile
import zlib
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from types import TracebackType
from typing import IO, Any, Self

import numpy as np
from numpy.typing import NDArray

from quatfilt.errors import FileAccessError
from quatfilt.formats.files import check_writable, reason

if sys.platform != "win32":
    import fcntl

MAGIC = b"\x89quatfiltdb\r\n\x1a\n\0"
"""The first bytes: no text, and damaged by whatever changes the ends of lines."""

VERSION = 1

HEADER = struct.Struct("<16sIIQQQ12sI")

ALIGNMENT = 64
"""Bytes at whose multiples arrays begin: a cache line."""

_UNFINISHED = ".unfinished"


class Writer:
    """A file that is being written, of arrays that are appended piece by piece.

    Used in a ``with`` statement, at whose end an unfinished file is removed.

    Parameters
    ----------
    path : str
        Where the file goes.

    Raises
    ------
    FileAccessError
        If it cannot be written.
    """

    def __init__(self, path: str) -> None:
        self._path = path
        self._sections: dict[str, dict[str, Any]] = {}
        self._last = ""
        try:
            self._target = Path(path).resolve()
            check_writable(self._target)
            _check_regular(self._target)
            _remove_leftovers(self._target)
            stem = self._target.name[:40]
            self._temporary = self._target.with_name(f".{stem}.{secrets.token_hex(6)}{_UNFINISHED}")
            self._file = self._begun()
        except (OSError, ValueError) as error:
            raise FileAccessError(path, reason(error)) from None

    def _begun(self) -> IO[bytes]:
        """Return the temporary file, or leave none, even where Ctrl-C comes in between."""
        try:
            file = self._temporary.open("xb")
            _lock(file)
            file.write(bytes(HEADER.size))
        except BaseException:
            with suppress(OSError):
                self._temporary.unlink()
            raise
        return file

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, value: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._file.close()
        with suppress(OSError):
            self._temporary.unlink()

    def append(self, name: str, rows: NDArray[Any]) -> None:
        """Append rows to an array, which is begun unless it is the last one that was appended to.

        Parameters
        ----------
        name : str
            The array.
        rows : ndarray
            C-contiguous and little-endian.

        Raises
        ------
        FileAccessError
            If they cannot be written.
        """
        try:
            if name != self._last:
                self._begin(name, rows)
            section = self._sections[name]
            section["shape"][0] += len(rows)
            data = rows.reshape(-1).view(np.uint8).data
            section["crc32"] = zlib.crc32(data, section["crc32"])
            self._file.write(data)
        except OSError as error:
            raise FileAccessError(self._path, reason(error)) from None

    def _begin(self, name: str, rows: NDArray[Any]) -> None:
        self._pad()
        self._sections[name] = {
            "offset": self._file.tell(),
            "dtype": rows.dtype.newbyteorder("<").str,
            "shape": [0, *rows.shape[1:]],
            "crc32": 0,
        }
        self._last = name

    def _pad(self) -> None:
        self._file.write(bytes(-self._file.tell() % ALIGNMENT))

    def mapped(self, name: str) -> NDArray[Any]:
        """Return an array as it was written so far, mapped from the file.

        Parameters
        ----------
        name : str
            The array.

        Returns
        -------
        ndarray
            Read-only.
        """
        self._file.flush()
        section = self._sections[name]
        return np.memmap(
            self._temporary,
            section["dtype"],
            mode="r",
            offset=section["offset"],
            shape=tuple(section["shape"]),
        ).view(np.ndarray)

    def finish(self, description: dict[str, Any]) -> None:
        """Describe the arrays and give the file its name.

        Parameters
        ----------
        description : dict
            What JSON can hold.

        Raises
        ------
        FileAccessError
            If it cannot be written.
        """
        whole = {**description, "sections": self._sections}
        text = json.dumps(whole, ensure_ascii=False, sort_keys=True, separators=(",", ":")).encode()
        try:
            self._pad()
            place = self._file.tell()
            self._file.write(text)
            length = self._file.tell()
            header = HEADER.pack(MAGIC, VERSION, zlib.crc32(text), place, len(text), length, bytes(12), 0)[
                :-4
            ]
            self._file.seek(0)
            self._file.write(header + struct.pack("<I", zlib.crc32(header)))
            self._file.flush()
            # Renamed before its contents are on the disk, a file could be empty after a power failure.
            os.fsync(self._file.fileno())
            if self._target.exists():
                shutil.copymode(self._target, self._temporary)
            if sys.platform == "win32":
                self._file.close()
            self._temporary.replace(self._target)
        except OSError as error:
            raise FileAccessError(self._path, reason(error)) from None


def _check_regular(target: Path) -> None:
    """Refuse a pipe or a terminal, which cannot be written from the middle."""
    if target.exists() and not target.is_file():
        raise OSError(None, "Not a regular file")


@contextmanager
def folder_beside(path: str) -> Iterator[Path]:
    """Yield an empty folder beside a file that is to be written, for what is written on the way to it.

    It is removed at the end; where the process is killed, by the next one that writes the file.

    Raises
    ------
    FileAccessError
        If the file or the folder cannot be written.
    """
    try:
        target = Path(path).resolve()
        check_writable(target)
        _check_regular(target)
        _remove_leftovers(target)
        folder = tempfile.TemporaryDirectory(
            prefix=f".{target.name[:40]}.", suffix=_UNFINISHED, dir=target.parent
        )
    except (OSError, ValueError) as error:
        raise FileAccessError(path, reason(error)) from None
    with folder as name:
        if sys.platform == "win32":
            yield Path(name)
            return
        handle = os.open(name, os.O_RDONLY)
        try:
            _lock(handle)
            yield Path(name)
        finally:
            os.close(handle)


def _lock(file: IO[bytes] | int) -> None:
    """Hold the file or folder until it is closed; `OSError` where somebody else does."""
    if sys.platform != "win32":
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)


def _remove_leftovers(target: Path) -> None:
    """Remove what killed processes left, but not what others are writing."""
    pattern = f".{glob.escape(target.name[:40])}.*{_UNFINISHED}"
    for leftover in target.parent.glob(pattern):
        # Windows does not remove what is open.
        with suppress(OSError):
            if sys.platform == "win32":
                _remove(leftover)
                continue
            handle = os.open(leftover, os.O_RDONLY)
            try:
                _lock(handle)
                _remove(leftover)
            finally:
                os.close(handle)


def _remove(leftover: Path) -> None:
    if leftover.is_dir():
        shutil.rmtree(leftover)
    else:
        leftover.unlink()


__all__ = ["ALIGNMENT", "HEADER", "MAGIC", "VERSION", "Writer", "folder_beside"]
