"""The recordings that are reconstructed, and the databases that they are reconstructed from."""

import csv
from collections.abc import Mapping
from pathlib import Path

from quatfilt.errors import FileAccessError
from quatfilt.evaluation.reconstruction_tables_conditions import ABSENT, FPS, SHARES, TWICE, HeldOut
from quatfilt.formats.files import read_motion
from quatfilt.motion.motion import Motion
from quatfilt.reconstruction.database import MotionDatabase


class Recordings:
    """The clips of a folder by name, read once, at the rate of the databases or faster."""

    def __init__(self, data: Path) -> None:
        self.paths = {path.stem: path for path in sorted(data.rglob("*.amc")) if path.stem not in TWICE}
        self.descriptions = _descriptions(data)
        self._motions: dict[str, Motion] = {}

    def __getitem__(self, name: str) -> Motion:
        if name not in self._motions:
            motion = read_motion(self.paths[name])
            every = max(round(motion.fps / FPS), 1)
            self._motions[name] = motion.replace(
                rotations=motion.rotations[::every],
                translation=motion.translation[::every],
                fps=motion.fps / every,
            )
        return self._motions[name]

    def between(self, name: str) -> Motion:
        """Return the frames of a clip that `[name]` leaves out."""
        motion = read_motion(self.paths[name])
        every = max(round(motion.fps / FPS), 1)
        return motion.replace(
            rotations=motion.rotations[1::every],
            translation=motion.translation[1::every],
            fps=motion.fps / every,
        )

    def person(self, name: str) -> str:
        """Return the folder of a clip, which is its performer's."""
        return self.paths[name].parent.name

    @property
    def people(self) -> set[str]:
        """Folders with clips."""
        return {self.person(name) for name in self.paths}


class Databases:
    """Databases without the person of a test, or without its clip alone; the last ones are kept."""

    def __init__(self, recordings: Recordings) -> None:
        self._recordings = recordings
        self._kept: dict[tuple[str, int, bool], MotionDatabase] = {}

    def without(
        self, test: HeldOut, share: int = 1, *, absent: bool = False, known: bool = False
    ) -> MotionDatabase:
        """Return a database of one clip in `share`; without an action if `absent`; with the same person if `known`."""
        recordings = self._recordings
        person = recordings.person(test.name)
        key = (test.name if known else person, share, absent)
        if key not in self._kept:
            if len(self._kept) > len(SHARES):
                self._kept.clear()
            names = [
                name
                for name in recordings.paths
                if (name != test.name if known else recordings.person(name) != person)
            ]
            if absent:
                names = [
                    name
                    for name in names
                    if not any(word in recordings.descriptions.get(name, "") for word in ABSENT)
                ]
            names = names[::share]
            motions = [recordings[name] for name in names]
            if test.inside:
                motions.append(recordings.between(test.name))
                names.append(test.name)
            self._kept[key] = MotionDatabase.from_motions(motions, fps=FPS, clip_names=names)
        return self._kept[key]


def _descriptions(data: Path) -> Mapping[str, str]:
    """Return what an index of recordings says of them, in lower case; nothing without one."""
    for folder in (data, data.parent):
        file = folder / "index.csv"
        if file.is_file():
            try:
                with file.open(encoding="utf-8", newline="") as lines:
                    rows = list(csv.DictReader(lines))
            except OSError as error:
                raise FileAccessError(file, str(error.strerror)) from None
            return {
                Path(row["path"]).stem: f"{row.get('action', '')}; {row.get('description', '')}".lower()
                for row in rows
                if row.get("path", "").endswith(".amc")
            }
    return {}


__all__ = ["Databases", "Recordings"]
