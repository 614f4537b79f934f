"""Whole files in memory."""

from collections.abc import Callable
from pathlib import Path

from quatfilt.errors import FileAccessError, FileFormatError
from quatfilt.formats._atomic import Replacement, check_writable, reason


def read_bytes(path: str) -> bytes:
    """Return what a file holds."""
    try:
        with Path(path).open("rb") as file:
            return file.read()
    except (OSError, ValueError) as error:
        raise FileAccessError(path, reason(error)) from None


def write_bytes(path: str, content: Callable[[], bytes]) -> None:
    """Write what `content` returns; an older file stays as it was until the new one is complete."""
    try:
        target = Path(path).resolve()
        check_writable(target)
        data = content()
        if target.exists() and not target.is_file():  # a pipe, a terminal
            target.write_bytes(data)
            return
        with Replacement(target) as replacement:
            replacement.file.write(data)
            replacement.finish()
    except (OSError, ValueError) as error:
        if isinstance(error, FileFormatError):
            raise
        raise FileAccessError(path, reason(error)) from None


__all__ = ["read_bytes", "write_bytes"]
