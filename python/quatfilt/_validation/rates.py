"""Frame rates that data are brought to."""

_MOST = 100.0
"""How many frames may come of one, or one of how many: what is seen so seldom says nothing of the time between, and nothing that moves
is seen so often. It is a slip of units, seconds for hertz, and would fill the memory."""


def resampling(fps: float, name: str, other: float, whose: str, *, faster: bool = False) -> float:
    """Return a frame rate that is not too far from another, to or from which data are resampled.

    Parameters
    ----------
    fps : float, hertz
        What was asked for, a number above 0.
    name : str
        Its name.
    other : float, hertz
        The other one.
    whose : str
        Whose that is.
    faster : bool, default False
        Whether `fps` may be as much lower than the other as it likes.

    Raises
    ------
    ValueError
        If it is too far away.
    """
    low, high = 0.0 if faster else other / _MOST, other * _MOST
    if low <= fps <= high:
        return fps
    expected = f"at most {high:g} hertz" if faster else f"from {low:g} to {high:g} hertz"
    raise ValueError(f"{name}: expected {expected}, for {whose} has {other:g}, got {fps:g}")
