"""Recognition of the source's clock: held, repeated, frozen and interpolated frames."""

import numpy as np

from quatfilt._reference._arrays import Mask, Reals
from quatfilt._reference.noise.repeats import find_repeats
from quatfilt._reference.rotations.quaternion import is_missing
from quatfilt._reference.sampling.interpolation import knot_times

REGULAR, HELD, REPEATED, INTERPOLATED = range(4)
"""Kinds of sources: every frame is new; at most every second frame is new; single frames repeat the one before; frames lie on geodesics
between the measured ones."""

REPEATS = 0.9
"""Share of the moving joints that must equal the frame before, bit for bit, for the frame to be a repeat."""

FREEZE_GAPS = 3
"""Median distances between new frames from which a longer one is a freeze."""

FREEZE_SECONDS = 0.05
"""Seconds that a freeze lasts at least."""


def sampling(q: Reals, fps: float) -> tuple[int, Reals, Mask]:
    """Find the frames that the source measured.

    Parameters
    ----------
    q : array (frames, joints, 4)
        Rotations; NaN or zero are missing samples.
    fps : float, hertz
        Frame rate.

    Returns
    -------
    kind : int
        `REGULAR`, `HELD`, `REPEATED` or `INTERPOLATED`.
    times : array (n,), float64, frames
        Increasing times of the measurements, those of frozen stretches left out. All frames that are not frozen for `REGULAR`.
    frozen : array (frames,) of bool
        Stretches without any new frame, from the last new one before them.
    """
    frames = len(q)
    everything = np.arange(frames, dtype=np.float64)
    repeats = repeated_frames(q)
    frozen = np.zeros(frames, bool)
    new = np.flatnonzero(~repeats)
    if len(new) < 2:
        return REGULAR, everything, frozen
    gaps = np.diff(np.append(new, frames))
    usual = int(np.sort(gaps[:-1])[(len(gaps) - 1) // 2])
    for start, gap in zip(new, gaps, strict=True):
        if gap > max(FREEZE_GAPS * usual, FREEZE_SECONDS * fps):
            frozen[start : start + gap] = True
    measured = np.flatnonzero(~repeats & ~frozen).astype(np.float64)
    if usual > 1:
        return HELD, measured, frozen
    knots = knot_times(q)
    if knots is not None:
        return INTERPOLATED, knots[~frozen[np.floor(knots).astype(np.intp)]], frozen
    kind = REPEATED if (repeats & ~frozen).any() else REGULAR
    return kind, measured if kind == REPEATED else everything[~frozen], frozen


def repeated_frames(q: Reals) -> Mask:
    """Return the frames that repeat the one before in `REPEATS` of the joints that move at all; `(frames,)`."""
    there, repeats = ~is_missing(q), find_repeats(q)
    # The first sample of a joint is no repeat; who moves has another new one.
    moving = np.sum(there & ~repeats, axis=0) > 1
    count = np.sum(there & moving, axis=1)
    return np.asarray((count > 0) & (np.sum(repeats & moving, axis=1) >= REPEATS * count))
