"""What goes wrong with files."""

import os


class QuatfiltError(Exception):
    """What all errors of this package about files have in common.

    Wrong values and types of arguments are plain `ValueError` and `TypeError`.

    Examples
    --------
    >>> import quatfilt as qf
    >>> try:
    ...     qf.read_motion("missing.bvh")
    ... except qf.QuatfiltError as error:
    ...     print(error)
    missing.bvh: No such file or directory
    """


class FileFormatError(QuatfiltError, ValueError):
    """A file does not hold what its name promises; the message is ``path: line 12: reason``.

    Parameters
    ----------
    path : str or path
        The file.
    line : int or None
        Its line, counted from 1; None where the whole file is meant.
    reason : str
        What was expected and what came.

    Examples
    --------
    >>> import quatfilt as qf
    >>> print(qf.FileFormatError("walk.bvh", 12, "expected three numbers"))
    walk.bvh: line 12: expected three numbers
    """

    def __init__(self, path: "str | os.PathLike[str]", line: int | None, reason: str) -> None:
        super().__init__(path, line, reason)
        self.path = os.fspath(path)
        self.line = line
        self.reason = reason

    def __str__(self) -> str:
        where = "" if self.line is None else f"line {self.line}: "
        return f"{self.path}: {where}{self.reason}"


class FileAccessError(QuatfiltError, OSError):
    """A file cannot be read or written; the message is ``path: reason``.

    Parameters
    ----------
    path : str or path
        The file.
    reason : str
        What the system says.

    Examples
    --------
    >>> import quatfilt as qf
    >>> print(qf.FileAccessError("walk.bvh", "Permission denied"))
    walk.bvh: Permission denied
    """

    def __init__(self, path: "str | os.PathLike[str]", reason: str) -> None:
        super().__init__(path, reason)
        self.path = os.fspath(path)
        self.reason = reason

    def __str__(self) -> str:
        return f"{self.path}: {self.reason}"


__all__ = ["FileAccessError", "FileFormatError", "QuatfiltError"]
