"""Writes the file of a database in one go, see `Replacement`."""

import json
import struct
import zlib
from pathlib import Path
from types import TracebackType
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from quatfilt.errors import FileAccessError
from quatfilt.formats._atomic import Replacement, reason

MAGIC = b"\x89quatfiltdb\r\n\x1a\n\0"
"""The first bytes: no text, and damaged by whatever changes the ends of lines."""

VERSION = 1

HEADER = struct.Struct("<16sIIQQQ12sI")

ALIGNMENT = 64
"""Bytes at whose multiples arrays begin: a cache line."""


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
            self._replacement = Replacement(Path(path).resolve())
            self._file = self._replacement.file
            self._file.seek(HEADER.size)  # written at the end
        except (OSError, ValueError) as error:
            raise FileAccessError(path, reason(error)) from None

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, value: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._replacement.__exit__(kind, value, trace)

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
            self._replacement.temporary,
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
            self._replacement.finish()
        except OSError as error:
            raise FileAccessError(self._path, reason(error)) from None


__all__ = ["ALIGNMENT", "HEADER", "MAGIC", "VERSION", "Writer"]
