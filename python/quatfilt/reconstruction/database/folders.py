"""Folders of motion files, read several at once."""

import os
from collections import deque
from collections.abc import Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path

from quatfilt.errors import FileAccessError, QuatfiltError
from quatfilt.formats._table import READABLE, listed
from quatfilt.formats.files import read_motion
from quatfilt.motion.motion import Motion
from quatfilt.motion.skeleton import Skeleton
from quatfilt.reconstruction.database.body import Body

_WAITING = 2
"""Motions per reader that are read ahead: readers need not wait, and memory stays bounded."""


class Folders:
    """The motion files of some folders, in the order of their names.

    Parameters
    ----------
    places : sequence of path
        Folders, and files.
    source_fps : float or None, hertz
        Frame rate instead of that of the files.
    skip_others : bool
        Whether files of other joints than most are left out.
    workers : int or None
        How many files are read at once; None for one per processor.

    Raises
    ------
    ValueError
        If there is no motion file.
    FileAccessError
        If there is no such place.
    """

    def __init__(
        self,
        places: Sequence[str | os.PathLike[str]],
        *,
        source_fps: float | None,
        skip_others: bool,
        workers: int | None,
    ) -> None:
        found: dict[Path, str] = {}
        for place in places:
            for path, name in _below(Path(place)):
                found.setdefault(path, name)
        if not found:
            names = ", ".join(map(str, places)) or "folders"
            raise ValueError(f"{names}: no motion files ({listed(READABLE)}) found")
        self._found = list(found.items())
        self._fps = source_fps
        self._skip_others = skip_others
        self._workers = min(workers or os.cpu_count() or 1, len(found))

    def __len__(self) -> int:
        return len(self._found)

    def motions(self) -> Iterator[tuple[str, Motion | str]]:
        """Read the files, in their order.

        Yields
        ------
        tuple of str and Motion or str
            A name, and the motion or why there is none.
        """
        usual = self._usual() if self._skip_others else None
        for name, motion in self._read():
            if usual is None or isinstance(motion, str):
                yield name, motion
                continue
            difference = usual.difference(motion.skeleton)
            yield name, f"{name}: left out: other joints: {difference}" if difference else motion

    def _read(self) -> Iterator[tuple[str, Motion | str]]:
        waiting: deque[tuple[str, Future[Motion | str]]] = deque()
        pool = ThreadPoolExecutor(self._workers)
        try:
            for path, name in self._found:
                waiting.append((name, pool.submit(self._read_one, path)))
                if len(waiting) > _WAITING * self._workers:
                    first, future = waiting.popleft()
                    yield first, future.result()
            for first, future in waiting:
                yield first, future.result()
        finally:
            pool.shutdown(cancel_futures=True)

    def _read_one(self, path: Path) -> Motion | str:
        try:
            return read_motion(path, fps=self._fps)
        except QuatfiltError as error:
            return f"left out: {error}"

    def _usual(self) -> Body | None:
        """Return the joints that most of the files have; of two as many, those that come first."""
        seen: dict[frozenset[tuple[str, str]], tuple[int, Body]] = {}
        for name, motion in self._read():
            if isinstance(motion, str):
                continue
            try:
                body = Body.of(motion.skeleton, name)
            except ValueError:
                continue
            key = _tree(motion.skeleton)
            seen[key] = (seen[key][0] + 1 if key in seen else 1, seen.get(key, (0, body))[1])
        return max(seen.values(), key=lambda value: value[0])[1] if seen else None


def _tree(skeleton: Skeleton) -> frozenset[tuple[str, str]]:
    above = ["" if parent < 0 else skeleton.names[parent] for parent in skeleton.parents]
    return frozenset(zip(skeleton.names, above, strict=True))


def _below(place: Path) -> Iterator[tuple[Path, str]]:
    """Find the motion files of a place, and their names in it."""
    if not place.exists():
        raise FileAccessError(str(place), "No such file or directory")
    if not place.is_dir():
        if place.suffix.lower() not in READABLE:
            raise ValueError(
                f"{place}: expected {listed(READABLE)}, or a folder, got {place.suffix or 'no extension'}"
            )
        yield place, place.stem
        return
    files = (path for path in place.rglob("*") if path.suffix.lower() in READABLE and path.is_file())
    for path in sorted(files, key=lambda path: path.relative_to(place).as_posix()):
        yield path, path.relative_to(place).with_suffix("").as_posix()


__all__ = ["Folders"]
