"""Databases of as many poses as are asked for: real clips, played faster and slower, and their mirror images."""

from collections.abc import Iterator, Sequence
from pathlib import Path

from quatfilt.motion.motion import Motion
from quatfilt.reconstruction.database import MotionDatabase, building
from quatfilt.reconstruction.database.folders import Folders
from quatfilt.reconstruction.database.takes import How

_SPEEDS = (1.0, 0.9, 1.1, 0.8, 1.2, 0.95, 1.05, 0.85, 1.15, 0.75, 1.25)
"""How fast clips are played, in the order in which they are added: people move so much faster and slower."""


class Speeds:
    """The clips of some folders, at several speeds.

    Parameters
    ----------
    folders : sequence of path
        Folders of motion files.
    times : int
        How many speeds.
    """

    def __init__(self, folders: Sequence[Path], times: int) -> None:
        self._source = Folders(folders, source_fps=None, skip_others=True, workers=None)
        self._speeds = _SPEEDS[:times]

    def __len__(self) -> int:
        return len(self._source) * len(self._speeds)

    def motions(self) -> Iterator[tuple[str, Motion | str]]:
        """Read the files once for each speed."""
        for speed in self._speeds:
            for name, motion in self._source.motions():
                if isinstance(motion, str):
                    yield name, motion
                else:
                    yield f"{name} at {speed:g}", motion.replace(fps=motion.fps * speed)


def many_poses(
    folders: Sequence[Path],
    path: Path,
    *,
    times: int = 6,
    fps: float = 60.0,
    progress: building.Progress | None = None,
) -> MotionDatabase:
    """Write a database of mirrored clips at several speeds, and open it.

    Parameters
    ----------
    folders : sequence of path
        Folders of motion files.
    path : path
        Where it is written.
    times : int, default 6
        How many speeds, at most 11: six make 1.1 million poses at 60 fps of 185,000 frames at 120 fps.
    fps : float, hertz, default 60
        Frame rate of the database.
    progress : callable or None
        Told how many clips are done.

    Returns
    -------
    MotionDatabase
        Mapped from the file.
    """
    how = How.checked(fps=fps, up="y", max_gap=0.1, min_length=0.5)
    building.to_file(Speeds(folders, times), how, str(path), mirror=True, progress=progress)
    return MotionDatabase.open(path)


__all__ = ["Speeds", "many_poses"]
