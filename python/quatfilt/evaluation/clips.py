"""The recordings that the tables are measured on, and which of their joints count."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from quatfilt._typing import Array, Mask
from quatfilt.errors import FileAccessError
from quatfilt.evaluation.synthetic import walk
from quatfilt.formats.files import read_motion
from quatfilt.motion.defects import find_defects
from quatfilt.motion.motion import Motion

CLIPS = {
    "07_01": "walk",
    "09_01": "run",
    "16_01": "jump",
    "14_02": "boxing",
    "86_01": "jumps, kicks and punches (long, mixed)",
}
"""Recordings of the CMU Graphics Lab Motion Capture Database, and what happens in them."""

MORE = {"02_03": "run", "02_05": "punch", "05_02": "dance, spins"}
"""More of them, beside the table."""

SYNTHETIC = "synthetic"
"""Name of the built-in walk, for those who have no data."""


@dataclass(frozen=True)
class Clip:
    """A clip and which of its joints count."""

    name: str
    what: str
    motion: Motion
    steady: Mask

    @property
    def steady_rotations(self) -> Array:
        """Rotations of the joints that count, ``(frames, joints, 4)``."""
        return np.ascontiguousarray(self.motion.rotations[:, self.steady])

    @property
    def others(self) -> list[str]:
        """Names of the joints that do not count."""
        names = self.motion.skeleton.names
        return [name for name, steady in zip(names, self.steady, strict=True) if not steady]


def load(data: Path | None, names: Mapping[str, str] = CLIPS, *, longest: int | None = None) -> list[Clip]:
    """Read clips from a folder, or make the walk.

    Parameters
    ----------
    data : Path or None
        Folder that holds ``07_01.amc`` and the others, at any depth; None for the built-in walk.
    names : mapping
        The clips, and what happens in them.
    longest : int or None, frames, default None
        How much of each clip is taken; None for all.

    Returns
    -------
    list of Clip
        In the order of the names.

    Raises
    ------
    QuatfiltError
        If a clip is not there or does not open.
    """
    if data is None:
        return [_clip(SYNTHETIC, "walk", walk(seconds=8), longest)]
    paths = {name: find(data, name) for name in names}
    return [_clip(name, names[name], read_motion(path), longest) for name, path in paths.items()]


def find(data: Path, name: str) -> Path:
    """Find the recording of a name in a folder or below it."""
    if not data.is_dir():
        raise FileAccessError(data, "expected a folder of motion capture")
    found = sorted(data.rglob(f"{name}.amc"))
    if not found:
        raise FileAccessError(data, f"expected {name}.amc in this folder or below it")
    return found[0]


def _clip(name: str, what: str, whole: Motion, longest: int | None) -> Clip:
    motion = whole.replace(rotations=whole.rotations[:longest], translation=whole.translation[:longest])
    return Clip(name, what, motion, find_defects(motion.rotations, fps=motion.fps).steady)


def thinned(clip: Clip, every: int) -> Clip:
    """Return a clip with one frame of `every`; the same joints count."""
    motion = clip.motion
    fewer = motion.replace(
        rotations=motion.rotations[::every],
        translation=motion.translation[::every],
        fps=motion.fps / every,
    )
    return replace(clip, motion=fewer)


__all__ = ["CLIPS", "MORE", "SYNTHETIC", "Clip", "find", "load", "thinned"]
