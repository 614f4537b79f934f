"""Frame rates for resampling."""

_MOST = 100.0
"""Largest ratio of two frame rates. A larger one is a mistake of units, seconds for hertz, and would fill the memory."""


def resampling(fps: float, name: str, other: float, whose: str, *, faster: bool = False) -> float:
    """Return a frame rate whose ratio to another one, to or from which data are resampled, is not too large.

    Parameters
    ----------
    fps : float, hertz
        The requested rate, a number above 0.
    name : str
        Name of the argument.
    other : float, hertz
        The other rate.
    whose : str
        Name of the data that have the other rate.
    faster : bool, default False
        Whether `fps` may be lower than the other without a limit.

    Raises
    ------
    ValueError
        If the ratio is too large.
    """
    low, high = 0.0 if faster else other / _MOST, other * _MOST
    if low <= fps <= high:
        return fps
    expected = f"at most {high:g} hertz" if faster else f"{low:g} to {high:g} hertz"
    raise ValueError(f"{name}: expected {expected}, because {whose} has {other:g}, got {fps:g}")
