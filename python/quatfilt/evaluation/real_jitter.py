"""Defects that recordings really have: what each method makes of glitches and of frozen frames.

There is no truth. What stands for it is the recording with its bad frames bridged, from the last good one to the next.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from quatfilt._typing import Array
from quatfilt.evaluation.clips import find
from quatfilt.evaluation.methods import ROWS, Clips
from quatfilt.formats.files import read_motion
from quatfilt.rotations.quaternion import geodesic_distance
from quatfilt.rotations.resample import slerp


@dataclass(frozen=True)
class Defect:
    """Bad frames of a recording."""

    clip: str
    joint: str | None
    """The joint that glitches; None where all joints stand still."""
    first: int
    last: int
    """Frames, from 0, both bad."""
    what: str


DEFECTS = (
    Defect("05_05", "ltoes", 549, 550, "two frames"),
    Defect("05_06", "ltoes", 267, 269, "three frames"),
    Defect("05_18", "ltoes", 78, 78, "one frame"),
    Defect("09_10", "lradius", 0, 3, "the first four frames stand still and elsewhere"),
    Defect("03_02", None, 11, 23, "thirteen frames repeat the one before"),
)
"""Of the CMU recordings. 08_07 begins frozen too; it is kept for the automatic method's goal."""

BRIDGE = "bridge"
"""Name of what a perfect repair would show."""

AROUND = 10
"""Frames before and after the bad ones that a method should leave alone."""


@dataclass(frozen=True)
class Jitter:
    """What a row leaves of a defect; angles in degrees."""

    clip: str
    joint: str | None
    row: str
    off: float
    """Farthest from the bridge in the bad frames; where all joints stand still, the mean over the joints of that."""
    step: float
    """Largest turn from one frame to the next, from the last good frame to the next; mean over the joints likewise."""
    around: float
    """Mean turn away from the recording in the frames around."""


def run(data: Path, *, rows: Sequence[str] | None = None) -> list[Jitter]:
    """Filter the recordings that have defects with every row that needs no truth.

    Parameters
    ----------
    data : Path
        Folder of CMU's recordings.
    rows : sequence of str or None, default None
        Which of `methods.ROWS`; None for all that are no oracles. Of two views of rotations the vectors count.

    Returns
    -------
    list of Jitter
        By defect and row; before the rows, the bridge itself.
    """
    names = [name for name, row in ROWS.items() if not row.oracle] if rows is None else rows
    results = []
    for defect in DEFECTS:
        motion = read_motion(find(data, defect.clip))
        clips = Clips.of([motion.rotations], motion.fps)
        chosen = slice(None) if defect.joint is None else [motion.skeleton.index(defect.joint)]
        recorded = motion.rotations[:, chosen]
        bridge = bridged(recorded, defect)
        results.append(_measured(defect, BRIDGE, recorded, bridge, bridge))
        for name in names:
            _, filtered = next(ROWS[name].candidates(clips))
            results.append(_measured(defect, name, recorded, bridge, filtered[:, chosen]))
    return results


def bridged(q: Array, defect: Defect) -> Array:
    """Return a recording ``(frames, joints, 4)`` with the bad frames on the way between the good ones beside them.

    Where the clip begins or ends with bad frames, the one good frame is held.
    """
    good = [frame for frame in (defect.first - 1, defect.last + 1) if 0 <= frame < len(q)]
    bad = np.arange(defect.first, defect.last + 1)
    result = q.copy()
    result[bad] = q[good[0]] if len(good) == 1 else slerp(q[good], good, bad)
    return result


def _measured(defect: Defect, row: str, recorded: Array, bridge: Array, filtered: Array) -> Jitter:
    frames = len(recorded)
    bad = slice(defect.first, defect.last + 1)
    off = np.degrees(geodesic_distance(bridge[bad], filtered[bad])).max(axis=0)
    wide = filtered[max(defect.first - 1, 0) : defect.last + 2]
    steps = np.degrees(geodesic_distance(wide[:-1], wide[1:])).max(axis=0)
    beside = [
        frame
        for frame in range(defect.first - AROUND, defect.last + AROUND + 1)
        if 0 <= frame < frames and not defect.first <= frame <= defect.last
    ]
    moved = np.degrees(geodesic_distance(recorded[beside], filtered[beside]))
    return Jitter(
        clip=defect.clip,
        joint=defect.joint,
        row=row,
        off=float(np.mean(off)),
        step=float(np.mean(steps)),
        around=float(np.mean(moved)),
    )


__all__ = ["AROUND", "BRIDGE", "DEFECTS", "Defect", "Jitter", "bridged", "run"]
