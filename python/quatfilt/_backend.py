"""The one place that chooses who computes: the Rust core or the NumPy reference.

A backend is a module of free functions. Both have the same functions with the same positional arguments.
"""

import importlib
import os
import threading
from types import ModuleType, TracebackType
from typing import Literal, Self

from quatfilt import _core

Backend = Literal["rust", "numpy"]

_MODULES: dict[str, str] = {"rust": "quatfilt._core", "numpy": "quatfilt._reference"}
"""The modules by name; the reference is loaded when it is chosen."""


def _checked(name: object) -> ModuleType:
    if name not in _MODULES:
        raise ValueError(f"backend: expected 'rust' or 'numpy', got {name!r}")
    return importlib.import_module(_MODULES[str(name)])


_current = _checked(os.environ.get("QUATFILT_BACKEND", "rust"))

_first = _current
"""The choice that holds where no other one does."""

_choices: list["use_backend"] = []
"""Choices in force, in the order in which they were made; the last one counts."""

_lock = threading.Lock()


def _choose() -> None:
    """Set the backend in use to that of the last choice in force."""
    global _current  # noqa: PLW0603 - the choice is the process's
    _current = _choices[-1].chosen if _choices else _first


def ops() -> ModuleType:
    """Return the functions of the backend in use."""
    return _current


def files() -> ModuleType:
    """Return the functions that read and write files: the core's with every backend, for text is no arithmetic."""
    return _core


def streams() -> ModuleType:
    """Return the functions that make streams: the core's with every backend, for the filter of the whole clip defines them."""
    return _core


class use_backend:  # noqa: N801 - used as a function, and as a context manager
    """Choose who computes, for the whole process.

    Parameters
    ----------
    name : {"rust", "numpy"}
        ``"rust"``, the default, is the compiled core. ``"numpy"`` is the reference implementation: slow, written to
        be read, and the definition of every result. The environment variable ``QUATFILT_BACKEND`` sets the first
        choice.

    Raises
    ------
    ValueError
        If there is no backend of that name.

    Examples
    --------
    >>> import quatfilt as qf
    >>> with qf.use_backend("numpy"):
    ...     qf.log([1.0, 0.0, 0.0, 0.0])
    array([0., 0., 0.])
    """

    def __init__(self, name: Backend) -> None:
        self.chosen = _checked(name)
        self.entered = False
        with _lock:
            # Of two choices in a row that are no contexts, the first one will never be in force again.
            if len(_choices) > 1 and not (_choices[-1].entered or _choices[-2].entered):
                del _choices[-2]
            _choices.append(self)
            _choose()

    def __enter__(self) -> Self:
        with _lock:
            self.entered = True
            if self not in _choices:
                _choices.append(self)
            _choose()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        value: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        with _lock:
            # Other contexts, of other threads, stay in force; what was chosen without one within this context does not.
            place = _choices.index(self)
            _choices[place:] = [choice for choice in _choices[place + 1 :] if choice.entered]
            _choose()


def get_backend() -> Backend:
    """Return the name of the backend in use.

    Returns
    -------
    {"rust", "numpy"}
        What `use_backend` or ``QUATFILT_BACKEND`` chose.

    Examples
    --------
    >>> import quatfilt as qf
    >>> with qf.use_backend("numpy"):
    ...     qf.get_backend()
    'numpy'
    """
    return "rust" if _current is _core else "numpy"


def set_num_threads(n: int | None) -> None:
    """Set how many threads the Rust core uses.

    Parameters
    ----------
    n : int or None
        At least 1; None returns to the default: ``QUATFILT_NUM_THREADS``, else ``RAYON_NUM_THREADS``, else the
        processors that this process may run on. Tools that limit the threads of BLAS libraries do not see this pool.

    Raises
    ------
    ValueError
        If `n` is below 1.
    TypeError
        If `n` is neither an integer nor None.

    Examples
    --------
    >>> import quatfilt as qf
    >>> qf.set_num_threads(2)
    >>> qf.get_num_threads()
    2
    >>> qf.set_num_threads(None)
    """
    if n is not None and (isinstance(n, bool) or not isinstance(n, int)):
        raise TypeError(f"n: expected an integer or None, got {type(n).__name__}")
    if n is not None and n < 1:
        raise ValueError(f"n: expected at least 1, got {n}")
    _core.set_num_threads(n or 0)


def get_num_threads() -> int:
    """Return how many threads the Rust core uses.

    Returns
    -------
    int
        At least 1; `set_num_threads` says where the number comes from.

    Examples
    --------
    >>> import quatfilt as qf
    >>> qf.get_num_threads() >= 1
    True
    """
    return _core.get_num_threads()


def simd_level() -> str:
    """Return the vector instructions that the Rust core uses: ``"baseline"``, ``"avx2"`` or ``"avx512"``.

    The processor is asked once per process. The environment variable ``QUATFILT_SIMD`` may lower the level; the
    results have the same bits at every level.

    Returns
    -------
    {"baseline", "avx2", "avx512"}
        The baseline is SSE2 on x86-64 and NEON on 64-bit ARM.

    Examples
    --------
    >>> import quatfilt as qf
    >>> qf.simd_level() in ("baseline", "avx2", "avx512")
    True
    """
    return _core.simd_level()


__all__ = [
    "Backend",
    "files",
    "get_backend",
    "get_num_threads",
    "ops",
    "set_num_threads",
    "simd_level",
    "streams",
    "use_backend",
]
