"""The recordings that the tables are measured on, and which of their joints count."""

from dataclasses import dataclass
from pathlib import Path

from quatfilt._typing import Mask
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
    def others(self) -> list[str]:
        """Names of the joints that do not count."""
        names = self.motion.skeleton.names
        return [name for name, steady in zip(names, self.steady, strict=True) if not steady]


def load(data: Path | None) -> list[Clip]:
    """Read the clips of the table from a folder, or make the walk.

    Parameters
    ----------
    data : Path or None
        Folder that holds ``07_01.amc`` and the others, at any depth; None for the built-in walk.

    Returns
    -------
    list of Clip
        In the order of the table.

    Raises
    ------
    QuatfiltError
        If a clip is not there or does not open.
    """
    if data is None:
        return [_clip(SYNTHETIC, "walk", walk(seconds=8))]
    if not data.is_dir():
        raise FileAccessError(data, "expected a folder of motion capture")
    return [_clip(name, what, read_motion(_find(data, name))) for name, what in CLIPS.items()]


def _find(data: Path, name: str) -> Path:
    found = sorted(data.rglob(f"{name}.amc"))
    if not found:
        raise FileAccessError(data, f"expected {name}.amc in this folder or below it")
    return found[0]


def _clip(name: str, what: str, motion: Motion) -> Clip:
    return Clip(name, what, motion, find_defects(motion.rotations, fps=motion.fps).steady)


__all__ = ["CLIPS", "SYNTHETIC", "Clip", "load"]
