"""Pose search: the nearest segments of poses beside FAISS, flat and as a graph, and beside reading the memory once."""

import itertools
import os
import tempfile
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import agreement
import faiss
import numpy as np
import quatfilt as qf
from clips import Array, rotation_vectors
from numpy.typing import NDArray
from quatfilt.evaluation.many_poses import many_poses
from report import Figures, Results, number
from timing import Contender, all_threads, ours, race

POSES = 100_000
SMALL = 10_000
COUNT = 64
LENGTHS = (1, 3)
BATCH = 64
FRAMES = 300
"""Frames of the motions that are followed."""

HELD_OUT = ("09/", "13/")
"""People that are not in the database: their motions are the queries."""

SPEEDS = 6
"""At how many speeds clips are played for a million poses."""

OPENINGS = 20

Numbers = NDArray[np.int64]


@dataclass(frozen=True)
class Poses:
    """A matrix of poses, and motions that are not in it."""

    what: str
    features: Array
    starts: Numbers
    motions: list[Array]

    def first(self, poses: int) -> "Poses":
        """Return so many of the poses, and the same motions."""
        borders = np.append(self.starts[self.starts < poses], min(poses, len(self.features)))
        return Poses(self.what, self.features[:poses], borders, self.motions)

    def queries(self, length: int) -> Iterator[tuple[bool, Array]]:
        """Yield the segments of the motions in sequence, and whether another motion begins."""
        share = FRAMES // len(self.motions)
        for motion in self.motions:
            for end in range(length, min(len(motion), share + length)):
                yield end == length, motion[end - length : end]


def measure(results: Results, repetitions: int) -> None:
    """Measure on recordings where there are some, else on waves."""
    folder = Path(os.environ.get("QUATFILT_DATA", "../shared/data")) / "cmu"
    if not folder.exists():
        waves = rotation_vectors(POSES + 1_000).reshape(POSES + 1_000, -1)
        poses = Poses("waves", waves[:POSES], np.array([0, POSES]), [waves[POSES:]])
        _measure(results, poses, repetitions)
        return
    with tempfile.TemporaryDirectory() as scratch:
        path = Path(scratch) / "poses"
        poses = _recorded(many_poses([folder], path, times=SPEEDS))
        _opening(results, path, len(poses.features))
        _measure(results, poses.first(POSES), repetitions)
        _along(results, poses, beside_faiss=False)


def _recorded(db: qf.MotionDatabase) -> Poses:
    """Separate the people that are searched for from the others."""
    spans = list(zip(db.clip_names, db.starts[:-1], db.starts[1:], strict=True))
    motions = [
        db.features[a:b].copy() for name, a, b in spans if name.startswith(HELD_OUT) and name.endswith("at 1")
    ]
    kept = [db.features[a:b] for name, a, b in spans if not name.startswith(HELD_OUT)]
    starts = np.cumsum([0, *map(len, kept)])
    return Poses("recordings", np.concatenate(kept), starts, motions)


def _measure(results: Results, poses: Poses, repetitions: int) -> None:
    for length in LENGTHS:
        for queries in (1, BATCH):
            _beside_flat(results, poses, length, queries, repetitions)
    _along(results, poses.first(SMALL), beside_faiss=True)
    _along(results, poses, beside_faiss=True)


def _stacked(poses: Poses, length: int) -> Array:
    """Return all segments as vectors; those across a border of clips too, for FAISS has no clips."""
    features = poses.features
    rows = len(features) - length + 1
    return np.concatenate([features[i : i + rows] for i in range(length)], axis=1)


def _with_threads(name: str, call: Callable[[], object]) -> list[Contender]:
    """Return a call of FAISS with one thread and, where there are more, with all."""
    contenders = []
    for threads in sorted({1, all_threads()}):
        unit = "thread" if threads == 1 else "threads"

        def before(threads: int = threads) -> None:
            faiss.omp_set_num_threads(threads)

        contenders.append(Contender(f"{name}, {threads} {unit}", call, before))
    return contenders


def _beside_flat(results: Results, poses: Poses, length: int, queries: int, repetitions: int) -> None:
    one_clip = np.array([0, len(poses.features)])
    every = [query for _, query in poses.queries(length)]
    sought = np.stack([every[i] for i in np.linspace(0, len(every) - 1, queries).astype(int)])
    stacked = _stacked(poses, length)
    flat = faiss.IndexFlatL2(stacked.shape[1])
    flat.add(stacked)
    vectors = sought.reshape(queries, -1)
    _, distances = qf.nearest_segments(poses.features, one_clip, sought, k=COUNT, successors=0)
    agreement.numbers("nearest_segments: FAISS", distances, np.sqrt(flat.search(vectors, COUNT)[0].clip(0)))
    own = ours(lambda: qf.nearest_segments(poses.features, one_clip, sought, k=COUNT, successors=0))
    peers = _with_threads("FAISS IndexFlatL2, stacked poses", lambda: flat.search(vectors, COUNT))
    reading = Contender("NumPy reads the poses once", lambda: poses.features.view(np.int32).max())
    times = race([*own, *peers, *([reading] if queries == 1 else [])], repetitions)
    title = f"nearest_segments, {poses.what}, {len(poses.features):,} poses of {poses.features.shape[1]}, m = {length}, "
    table = results.table(
        f"{title}k = {COUNT}, {queries} {'query' if queries == 1 else 'queries'}",
        times,
        rotations=0,
        beside=[contender.name for contender in own],
    )
    for mine, theirs in zip(own, peers, strict=True):
        gain = table.median(theirs.name) / table.median(mine.name)
        what = f"nearest_segments, m = {length}, {queries} at once: {theirs.name} ÷ {mine.name}"
        results.aim(what, gain, at_least=1)
    if queries == 1:
        results.aim(
            f"nearest_segments, m = {length}: queries in a second, 1 thread",
            1 / table.median(own[0].name),
            at_least=60,
        )


def _along(results: Results, poses: Poses, *, beside_faiss: bool) -> None:
    """Follow motions frame by frame, one thread."""
    length = max(LENGTHS)
    qf.set_num_threads(1)
    features, starts = poses.features, poses.starts
    truth: list[NDArray[np.int64]] = []
    rows = []

    def follow(
        name: str, find: Callable[[Array], Numbers], reset: Callable[[], None] = lambda: None
    ) -> float:
        seconds, shares = [], []
        for i, (begins, query) in enumerate(poses.queries(length)):
            if begins:
                reset()
            start = time.perf_counter()
            found = find(query)
            seconds.append(time.perf_counter() - start)
            if i == len(truth):
                truth.append(found)
            shares.append(len(np.intersect1d(truth[i], found)) / COUNT)
        mean, late = float(np.mean(seconds)), float(np.quantile(seconds, 0.99))
        usual = float(np.median(seconds))
        rows.append(
            [
                name,
                number(usual * 1e3),
                number(mean * 1e3),
                number(late * 1e3),
                number(1 / usual),
                f"{np.mean(shares):.3f}",
            ]
        )
        return usual

    exact = qf.PoseSearch(features, starts, k=COUNT, length=length)
    usual = follow("PoseSearch, exact", lambda query: exact(query)[0], exact.reset)
    if beside_faiss:
        qf.set_num_threads(None)
        graph, _ = qf.neighbor_graph(features, starts)
        qf.set_num_threads(1)
        walk = qf.PoseSearch(features, starts, graph, k=COUNT, length=length)
        follow("PoseSearch, along the graph", lambda query: walk(query)[0], walk.reset)
        alone = qf.PoseSearch(features, starts, graph, k=COUNT, length=length, refresh=0)
        follow("PoseSearch, each frame by itself", lambda query: alone(query)[0])
        faiss.omp_set_num_threads(all_threads())
        inside = np.concatenate([np.arange(a, b - length) for a, b in itertools.pairwise(starts)])
        hnsw = faiss.IndexHNSWFlat(length * features.shape[1], 16)
        hnsw.add(_stacked(poses, length)[inside])
        faiss.omp_set_num_threads(1)
        for effort in (64, 256):
            hnsw.hnsw.efSearch = effort
            follow(
                f"FAISS HNSW, 16 links, efSearch = {effort}",
                lambda query: inside[hnsw.search(query.reshape(1, -1), COUNT)[1][0]] + length - 1,
            )
    qf.set_num_threads(None)
    title = f"From frame to frame, {poses.what}, {len(features):,} poses, m = {length}, k = {COUNT}, 1 thread"
    columns = ["", "median, ms", "mean, ms", "99 of 100 within, ms", "frames in a second", "recall"]
    note = "The motions are of people who are not in the database." if poses.what == "recordings" else ""
    results.add(Figures(title, columns, rows, [note] if note else []))
    if len(features) > POSES:
        results.aim(
            f"exact search from frame to frame, {len(features):,} poses: frames in a second",
            1 / usual,
            at_least=1000,
        )


def _opening(results: Results, path: Path, searched: int) -> None:
    """Open the database again and again."""
    seconds = []
    for _ in range(OPENINGS):
        start = time.perf_counter()
        db = qf.MotionDatabase.open(path)
        seconds.append(time.perf_counter() - start)
    worst = float(np.median(seconds))
    size = path.stat().st_size
    rows = [
        ["poses in the file", f"{len(db):,}"],
        ["of these searched", f"{searched:,}"],
        ["file, MB", number(size / 1e6)],
        ["bytes per pose", number(size / len(db))],
        ["opening, median of 20, ms", number(worst * 1e3)],
    ]
    results.add(Figures("A database of many poses", ["", ""], rows))
    results.aim(f"opening a database of {len(db):,} poses, ms", worst * 1e3, at_most=50)
