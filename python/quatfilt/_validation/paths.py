"""Names of files."""

import os
from typing import Any


def path(value: Any, name: str) -> str:
    """Return the name of a file as a string.

    Raises
    ------
    TypeError
        For what names no file.
    """
    if isinstance(value, (str, os.PathLike)):
        text = os.fspath(value)
        if isinstance(text, str):
            return text
    raise TypeError(f"{name}: expected a path, got {type(value).__name__}")
