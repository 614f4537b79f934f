"""Motions become a database, in memory or in a file."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from quatfilt.motion.motion import Motion
from quatfilt.reconstruction.database import file
from quatfilt.reconstruction.database.body import Body
from quatfilt.reconstruction.database.contents import Clips, Contents, Gathering, measured
from quatfilt.reconstruction.database.mirror import Mirror, mirror_of
from quatfilt.reconstruction.database.takes import How, takes

Progress = Callable[[int, int], None]
"""Told how many files are done, of how many."""


class Source(Protocol):
    """Motions that come one after the other."""

    def __len__(self) -> int: ...

    def motions(self) -> Iterator[tuple[str, Motion | str]]:
        """Give names and motions; instead of a motion, why there is none."""


@dataclass
class Builder:
    """Takes motions one after the other.

    Parameters
    ----------
    how : How
        How they become takes.
    mirror : bool
        Whether mirror images are added.
    weights : ndarray of float64, shape (joints,), or None
        Weights of the joints; None for the default.
    store : callable or None
        What becomes of the rotations of each take; None keeps them in memory.
    """

    how: How
    mirror: bool
    weights: NDArray[np.float64] | None = None
    store: Callable[[NDArray[np.float32]], None] | None = None
    _gathering: Gathering | None = None
    _mirror: Mirror | None = None
    _rotations: list[NDArray[np.float32]] = field(default_factory=list)
    _notes: dict[str, list[str]] = field(default_factory=dict)

    def add(self, motion: Motion, name: str) -> None:
        """Add a motion.

        Raises
        ------
        ValueError
            If its joints are others, or have no mirror image.
        """
        gathering = self._gathering
        if gathering is None:
            body = Body.of(motion.skeleton, name)
            gathering = self._gathering = Gathering(body, self.how)
            if self.mirror:
                self._mirror = mirror_of(body, motion.skeleton, self.how.up)
        for text in motion.notes:
            self.note(text, name)
        notes: list[str] = []
        for take in takes(motion, name, gathering.body, self.how, notes):
            for one in (take,) if self._mirror is None else (take, self._mirror.take(take)):
                gathering.add(one)
                (self._rotations.append if self.store is None else self.store)(one.rotations)
        for text in notes:
            self.note(text)

    def note(self, text: str, name: str = "") -> None:
        """Add a note; one that many clips have is told once."""
        self._notes.setdefault(text, []).append(name)

    def notes(self) -> list[str]:
        """Return what there is to tell."""
        return [
            text if not names[0] else f"{names[0] if len(names) == 1 else f'{len(names)} clips'}: {text}"
            for text, names in self._notes.items()
        ]

    def clips(self) -> Clips:
        """Return what came in.

        Raises
        ------
        ValueError
            If nothing did.
        """
        if self._gathering is None or not len(self._gathering):
            notes = self.notes()
            reason = f": {notes[-1]}" if notes else ""
            raise ValueError(f"motions: expected clips that can be used, got none{reason}")
        return self._gathering.clips(self.notes())

    def in_memory(self) -> Contents:
        """Return the database."""
        clips = self.clips()
        rotations = np.concatenate(self._rotations)
        self._rotations.clear()
        features: list[NDArray[np.float32]] = []
        means, weights = measured(clips, rotations, self.weights, features.append)
        return Contents(clips, rotations, means, weights, np.concatenate(features))


def in_memory(source: Source, how: How, *, mirror: bool) -> Contents:
    """Read folders into memory."""
    builder = Builder(how, mirror=mirror)
    _read(source, builder, None)
    return builder.in_memory()


def to_file(source: Source, how: How, path: str, *, mirror: bool, progress: Progress | None = None) -> None:
    """Read folders into the file of a database, in memory of a few clips.

    Raises
    ------
    ValueError
        If there is nothing to read, or if joints differ.
    FileAccessError
        If a folder does not exist, or the file cannot be written.
    """
    with file.Writer(path) as writer:
        builder = Builder(how, mirror=mirror, store=lambda rotations: writer.append("rotations", rotations))
        _read(source, builder, progress)
        clips = builder.clips()
        means, weights = measured(
            clips,
            writer.mapped("rotations"),
            builder.weights,
            lambda features: writer.append("features", features),
        )
        file.finish(writer, clips, means, weights, None)


def _read(source: Source, builder: Builder, progress: Progress | None) -> None:
    total = len(source)
    for number, (name, motion) in enumerate(source.motions()):
        if isinstance(motion, str):
            builder.note(motion)
        else:
            builder.add(motion, name)
        if progress is not None:
            progress(number + 1, total)
