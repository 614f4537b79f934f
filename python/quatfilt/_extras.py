"""The door to packages that are optional extras."""

import importlib
from types import ModuleType


def extra(module: str, package: str, name: str, purpose: str) -> ModuleType:
    """Import a module of an optional package.

    Parameters
    ----------
    module : str
        What is imported.
    package : str
        What its package is called.
    name : str
        The extra of quatfilt that brings it.
    purpose : str
        Who needs it, in the plural.

    Raises
    ------
    ImportError
        If it is not there; the message says what to install.
    """
    try:
        return importlib.import_module(module)
    except ImportError:
        raise ImportError(f"{purpose} need {package}: pip install 'quatfilt[{name}]'") from None


def pywavelets() -> ModuleType:
    """Import PyWavelets."""
    return extra("pywt", "PyWavelets", "wavelet", "wavelets")


__all__ = ["extra", "pywavelets"]
