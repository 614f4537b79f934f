"""Segmentation of motion into behaviours."""

from dataclasses import dataclass
from itertools import pairwise
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from quatfilt import _validation
from quatfilt._backend import ops
from quatfilt._typing import Array

DEVIATIONS = 3.0
"""Standard deviations above the mean, as in the paper."""

MOST_COMPONENTS = 2
"""Geodesics of a joint: three describe every rotation, and leave no error to grow."""

_SECONDS = 2.0
"""Of `window`: a step or two, so that a cycle of a walk is known before a cut is looked for."""

_FRAMES = 240
"""The same at the frame rate of recordings with markers, for those who name none."""

_SHORTEST = 0.5
"""Part of `window` that the shortest segment has where nothing is said."""

_LAG = 0.25
"""Part of `window` over which the growth of the error is taken, as in the paper: 60 frames of 240."""


def segment(
    q: ArrayLike,
    *,
    n_components: int = 1,
    window: float | None = None,
    min_length: float | None = None,
    threshold: float | Literal["auto"] = "auto",
    fps: float = 1.0,
    scalar_first: bool = True,
) -> NDArray[np.intp]:
    """Cut a motion where one behaviour ends and another begins.

    The frames of a segment are described by a few principal geodesics of each joint, fitted to all of them so far. While a
    behaviour goes on, the error of that description grows at a steady rate; a new one makes it grow faster. A cut is made
    where the growth over a quarter of `window` exceeds its mean in this segment by more than `threshold` standard deviations, and
    the search begins anew there.

    Parameters
    ----------
    q : array_like, shape (frames, joints, 4) or (frames, 4)
        Unit quaternions along time. Missing samples (NaN or four zeros) are left out.
    n_components : {1, 2}, default 1
        Geodesics of each joint.
    window : float or None, seconds, default None
        Time at the beginning of each segment in which the behaviour is learnt, and no cut is made; at least 2 frames. None: 2 s, or
        240 frames where `fps` is 1.
    min_length : float or None, seconds, default None
        The shortest segment, at least 1 frame. None for half of `window`. A segment is as long as `window` in any case, but for the last.
    threshold : float or "auto", standard deviations, default "auto"
        Smaller cuts more often. ``"auto"`` is 3, as in the paper.
    fps : float, hertz, default 1.0
        Frame rate; without it times are frames.
    scalar_first : bool, default True
        Whether quaternions are ``(w, x, y, z)``; False for SciPy's ``(x, y, z, w)``.

    Returns
    -------
    ndarray of int, shape (n,)
        The first frames of new behaviours, rising; the first frame of the clip is not among them.

    Raises
    ------
    ValueError, TypeError
        If an argument has another shape, type or range than stated; the message names it.

    See Also
    --------
    quatfilt.geodesics.segment.segments : The cuts with the growth of the error and its limit.

    Notes
    -----
    Cost: ``frames · joints`` eigenvalues of 4 × 4 matrices, some 500 ns each. Signs of quaternions and a constant rotation of a
    joint's frame, on either side, change nothing. A cut comes late by what it takes to notice: a fraction of a second.

    References
    ----------
    .. [1] J. Barbič, A. Safonova, J.-Y. Pan, C. Faloutsos, J. K. Hodgins and N. S. Pollard, "Segmenting motion capture data into
       distinct behaviors", Graphics Interface 2004.
    .. [2] S. Said, N. Courty, N. Le Bihan and S. J. Sangwine, "Exact principal geodesic analysis for data on SO(3)",
       EUSIPCO 2007.

    Examples
    --------
    >>> import numpy as np, quatfilt as qf
    >>> s = np.sin(2 * np.pi * np.arange(1200) / 120)[:, None]
    >>> nod, shake = qf.exp(s * [0.4, 0.0, 0.0]), qf.exp(s * [0.0, 0.3, 0.05])
    >>> cuts = qf.segment(np.concatenate([nod, shake]), fps=120)
    >>> (cuts / 120).round(2).tolist()
    [10.01]
    """
    return segments(
        q,
        n_components=n_components,
        window=window,
        min_length=min_length,
        threshold=threshold,
        fps=fps,
        scalar_first=scalar_first,
    ).cuts


@dataclass(frozen=True, eq=False)
class Segments:
    """Cuts, and what they follow from."""

    cuts: NDArray[np.intp]
    """First frames of new behaviours, ``(n,)``."""

    growth: Array
    """Growth of the error over a quarter of the window, ``(frames,)``; NaN where a segment is too young."""

    limit: Array
    """What it was compared with, ``(frames,)``; NaN where it was not."""

    window: int
    """Frames in which a behaviour is learnt."""

    def spans(self, frames: int) -> list[tuple[int, int]]:
        """Return the first frame of each segment and the one after its last."""
        edges = [0, *self.cuts.tolist(), frames]
        return [(start, end) for start, end in pairwise(edges) if end > start]


def segments(
    q: ArrayLike,
    *,
    n_components: int = 1,
    window: float | None = None,
    min_length: float | None = None,
    threshold: float | Literal["auto"] = "auto",
    fps: float = 1.0,
    scalar_first: bool = True,
) -> Segments:
    """Cut a motion as `segment` does, and return what the cuts follow from too."""
    clip, _ = _validation.clip(q, "q", scalar_first=scalar_first)
    components = _validation.integer(n_components, "n_components", at_least=1, at_most=MOST_COMPONENTS)
    rate = _validation.number(fps, "fps", above=0)
    if window is None:
        learnt = _FRAMES if rate == 1 else max(round(_SECONDS * rate), 2)
    else:
        learnt = _frames(window, "window", rate, at_least=2)
    shortest = (
        max(round(_SHORTEST * learnt), 1)
        if min_length is None
        else _frames(min_length, "min_length", rate, at_least=1)
    )
    if isinstance(threshold, str):
        _validation.choice(threshold, "threshold", ("auto",))
        deviations = DEVIATIONS
    else:
        deviations = _validation.number(threshold, "threshold", at_least=0)
    lag = max(round(_LAG * learnt), 1)
    cuts, growth, limit = ops().segment(clip, components, learnt, shortest, lag, deviations)
    return Segments(cuts, growth, limit, learnt)


def _frames(seconds: float, name: str, fps: float, *, at_least: int) -> int:
    frames = round(_validation.number(seconds, name, above=0) * fps)
    if frames < at_least:
        raise ValueError(
            f"{name}: expected at least {at_least / fps:g} seconds, "
            f"{at_least} frame{'' if at_least == 1 else 's'} at fps = {fps:g}, got {seconds}"
        )
    return min(frames, _MOST_FRAMES)


_MOST_FRAMES = 1 << 40
"""Longer windows than any clip are all the same."""

__all__ = ["DEVIATIONS", "MOST_COMPONENTS", "Segments", "segment", "segments"]
