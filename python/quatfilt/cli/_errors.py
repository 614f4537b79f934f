"""Messages of errors in one line, and exit statuses."""

from quatfilt.cli._output import one_line
from quatfilt.errors import QuatfiltError

BAD_INPUT = (QuatfiltError, ValueError, TypeError, OSError, ImportError)
"""Errors that a user can correct."""

OF_THE_USER, OF_QUATFILT = 2, 1
"""Exit statuses."""


def explained(error: Exception) -> tuple[str, int]:
    """Return the message of an error, in one line, and the exit status.

    Parameters
    ----------
    error : Exception
        The exception.

    Returns
    -------
    message : str
        Without the program's name.
    status : int
        2 for bad input and too little memory, 1 for an error in quatfilt itself.
    """
    message = getattr(error, "format_message", None)
    if message is not None:  # a usage error of the command line's library
        return f"{one_line(message())} (see quatfilt --help)", OF_THE_USER
    if isinstance(error, MemoryError):
        return f"not enough memory{one_line(f': {error}') if str(error) else ''}", OF_THE_USER
    if isinstance(error, OSError) and error.filename is not None and error.strerror:
        return one_line(f"{error.filename}: {error.strerror}"), OF_THE_USER
    if isinstance(error, BAD_INPUT):
        return one_line(str(error) or type(error).__name__), OF_THE_USER
    return f"internal error: {one_line(repr(error))}; --debug shows where it comes from", OF_QUATFILT
