"""Files that appear whole or not at all.

A file is written under a temporary name beside its target, flushed to the disk and renamed. A process that is killed leaves the older
file as it was and the temporary one beside it, which the next write to that target removes.
"""

import glob
import os
import secrets
import shutil
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from types import TracebackType
from typing import IO, Self

from quatfilt.errors import FileAccessError

if sys.platform != "win32":
    import fcntl

_UNFINISHED = ".unfinished"


class Replacement:
    """A file that is being written and takes the place of its target at the end.

    Used in a ``with`` statement, at whose end an unfinished file is removed.

    Parameters
    ----------
    target : Path
        The file to write, resolved.

    Raises
    ------
    OSError
        If no regular file can be written there.
    """

    file: IO[bytes]
    """Where the contents go."""
    temporary: Path

    def __init__(self, target: Path) -> None:
        _check(target)
        self._target = target
        self.temporary = target.with_name(f"{_start(target)}{secrets.token_hex(6)}{_UNFINISHED}")
        # Ctrl-C may come between the two.
        try:
            self.file = self.temporary.open("xb")
            _lock(self.file)
        except BaseException:
            with suppress(OSError):
                self.temporary.unlink()
            raise

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, value: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.file.close()
        with suppress(OSError):
            self.temporary.unlink()

    def finish(self) -> None:
        """Give the file the name and the mode of its target.

        Raises
        ------
        OSError
            If that fails; the target is as it was.
        """
        self.file.flush()
        # Renamed before its contents are on the disk, a file could be empty after a power failure.
        os.fsync(self.file.fileno())
        if self._target.exists():
            shutil.copymode(self._target, self.temporary)
        if sys.platform == "win32":
            self.file.close()
        self.temporary.replace(self._target)
        _flush_folder(self._target.parent)


def check_writable(target: Path) -> None:
    """Raise `OSError` where no file can be written."""
    if target.is_dir():
        raise IsADirectoryError(None, "Is a directory")
    if target.exists() and not os.access(target, os.W_OK):
        raise PermissionError(None, "Permission denied")
    if not target.parent.is_dir():
        raise FileNotFoundError(None, "No such directory")


@contextmanager
def folder_beside(path: str) -> Iterator[Path]:
    """Yield an empty temporary folder beside a file that is to be written; it is removed at the end.

    Raises
    ------
    FileAccessError
        If the file or the folder cannot be written.
    """
    try:
        target = Path(path).resolve()
        _check(target)
        folder = tempfile.TemporaryDirectory(prefix=_start(target), suffix=_UNFINISHED, dir=target.parent)
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


def reason(error: Exception) -> str:
    """Return the message of the system."""
    return getattr(error, "strerror", None) or str(error)


def _check(target: Path) -> None:
    check_writable(target)
    if target.exists() and not target.is_file():
        raise OSError(None, "Not a regular file")
    _remove_leftovers(target)


def _start(target: Path) -> str:
    """Return how the names of temporary files for a target begin; names have a limit of 255 bytes."""
    return f".{target.name[:40]}."


def _lock(file: IO[bytes] | int) -> None:
    """Hold a new file or folder until it is closed, on file systems that have locks."""
    if sys.platform != "win32":
        with suppress(OSError):
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)


def _flush_folder(folder: Path) -> None:
    """Put the new name on the disk, where folders can be flushed."""
    if sys.platform != "win32":
        with suppress(OSError):
            handle = os.open(folder, os.O_RDONLY)
            try:
                os.fsync(handle)
            finally:
                os.close(handle)


def _remove_leftovers(target: Path) -> None:
    """Remove temporary files of killed processes, and keep those that another process holds."""
    for leftover in target.parent.glob(f"{glob.escape(_start(target))}*{_UNFINISHED}"):
        # Windows does not remove open files.
        with suppress(OSError):
            if sys.platform == "win32":
                _remove(leftover)
                continue
            handle = os.open(leftover, os.O_RDONLY)
            try:
                fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
                _remove(leftover)
            finally:
                os.close(handle)


def _remove(leftover: Path) -> None:
    if leftover.is_dir():
        shutil.rmtree(leftover)
    else:
        leftover.unlink()


__all__ = ["Replacement", "check_writable", "folder_beside", "reason"]
