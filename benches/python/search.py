"""Search: patches of a clip beside a matrix product and beside FAISS; poses of a database."""

import os
from collections.abc import Callable
from pathlib import Path

import agreement
import numpy as np
import pose_search
import quatfilt as qf
from clips import JOINTS, Array, rotations
from numpy.typing import NDArray
from report import Results
from timing import Contender, all_threads, ours, race

FRAMES = 20_000
RADIUS, COUNT = 5, 16
AGREEMENT_FRAMES, AGREEMENT_SCALE = 2_000, 300
WALK_STEP = 0.1
"""Deviation of a random walk's step per coordinate, in radians."""
BLOCK = 512
"""Frames whose distances to all others are held at once."""


def by_matrix_product(x: Array) -> tuple[NDArray[np.int64], Array]:
    """Neighbours by Euclidean distance of rotation vectors `(frames, 3·joints)`: a product, sums along diagonals, partition."""
    frames = len(x)
    padded = np.pad(x, ((RADIUS, RADIUS), (0, 0)), mode="edge")
    squares = np.sum(padded * padded, axis=1)
    indices = np.empty((frames, COUNT), np.int64)
    distances = np.empty((frames, COUNT), x.dtype)
    for first in range(0, frames, BLOCK):
        block = padded[first : first + BLOCK + 2 * RADIUS]
        single = squares[first : first + len(block), None] + squares[None] - 2 * (block @ padded.T)
        count = len(block) - 2 * RADIUS
        sums = single[:count, :frames].copy()
        for offset in range(1, 2 * RADIUS + 1):
            sums += single[offset : offset + count, offset : offset + frames]
        for t in range(count):
            sums[t, max(0, first + t - RADIUS) : first + t + RADIUS + 1] = np.inf
        nearest = np.argpartition(sums, COUNT, axis=1)[:, :COUNT]
        found = np.take_along_axis(sums, nearest, axis=1)
        order = np.argsort(found, axis=1)
        indices[first : first + count] = np.take_along_axis(nearest, order, axis=1)
        distances[first : first + count] = np.take_along_axis(found, order, axis=1)
    return indices, distances


def by_faiss(x: Array) -> tuple[NDArray[np.int64], Array]:
    """Neighbours by Euclidean distance of stacked patches, exhaustively; it knows no exclusion and is asked for more."""
    import faiss

    faiss.omp_set_num_threads(all_threads())
    padded = np.pad(x, ((RADIUS, RADIUS), (0, 0)), mode="edge")
    stacked = np.concatenate([padded[o : o + len(x)] for o in range(2 * RADIUS + 1)], axis=1)
    index = faiss.IndexFlatL2(stacked.shape[1])
    index.add(stacked)
    distances, indices = index.search(stacked, COUNT + 2 * RADIUS + 1)
    near = np.abs(indices - np.arange(len(x))[:, None]) <= RADIUS
    order = np.argsort(near, axis=1, kind="stable")[:, :COUNT]
    return np.take_along_axis(indices, order, axis=1), np.take_along_axis(distances, order, axis=1)


def _agree(name: str, peer: Callable[[Array], tuple[NDArray[np.int64], Array]], x: Array) -> None:
    """Stop unless a peer finds the same distances where rotations are so small that their vectors are as far apart as they."""
    _, distances = qf.patch_neighbors(qf.exp(x.reshape(len(x), -1, 3) / 2), patch_radius=RADIUS, k=COUNT)
    means = np.sqrt(peer(x)[1].clip(0) / (JOINTS * (2 * RADIUS + 1)))
    agreement.numbers(f"patch_neighbors: {name}", AGREEMENT_SCALE * distances, AGREEMENT_SCALE * means)


def _recorded() -> Array | None:
    """Return recordings of the CMU database one after the other, as many frames as there are to be; None without data."""
    folder = Path(os.environ.get("QUATFILT_DATA", "../shared/data"))
    clips: list[Array] = []
    for path in sorted((folder / "cmu").glob("*/*.amc"), key=lambda path: path.stem, reverse=True):
        q = qf.read_motion(path).rotations
        if q.shape[1] == JOINTS:
            clips.append(q.astype(np.float32))
        if sum(map(len, clips)) >= FRAMES:
            return np.concatenate(clips)[:FRAMES]
    return None


def _walks() -> Array:
    """Return random walks on SO(3), one per joint, that go round all rotations and never come back to a pose."""
    steps = qf.exp(0.5 * WALK_STEP * np.random.default_rng(0).standard_normal((FRAMES, JOINTS, 3)))
    walks = np.empty((FRAMES, JOINTS, 4))
    walks[0] = [1, 0, 0, 0]
    for t in range(1, FRAMES):
        walks[t] = qf.multiply(walks[t - 1], steps[t])
    return (walks / np.linalg.norm(walks, axis=-1, keepdims=True)).astype(np.float32)


def run(repetitions: int) -> Results:
    """Measure."""
    results = Results()
    waves, recorded = rotations(FRAMES), _recorded()
    small = qf.log(waves[:AGREEMENT_FRAMES]).reshape(AGREEMENT_FRAMES, -1) / AGREEMENT_SCALE
    for name, peer in (("product", by_matrix_product), ("FAISS", by_faiss)):
        _agree(name, peer, small)
    if recorded is not None:
        _beside_peers(results, "recordings", recorded, repetitions, aims=(4, 10))
    _beside_peers(results, "waves that never repeat", waves, repetitions)
    _beside_peers(results, "random walks", _walks(), repetitions)
    pose_search.measure(results, repetitions)
    return results


def _beside_peers(
    results: Results, what: str, q: Array, repetitions: int, *, aims: tuple[float, ...] = ()
) -> None:
    x = np.ascontiguousarray(2 * qf.log(qf.continuous(q))).reshape(FRAMES, -1)
    own = ours(lambda: qf.patch_neighbors(q, patch_radius=RADIUS, k=COUNT))
    names = [contender.name for contender in own]
    times = race(
        [
            *own,
            Contender("NumPy, product and sums along diagonals", lambda: by_matrix_product(x)),
            Contender("FAISS IndexFlatL2, stacked patches", lambda: by_faiss(x)),
        ],
        repetitions,
    )
    results.table(
        f"patch_neighbors, {what}, {JOINTS} joints × {FRAMES:,} frames, patches of {2 * RADIUS + 1}, k = {COUNT}, "
        f"{q.dtype}",
        times,
        rotations=FRAMES * JOINTS,
        beside=names,
        notes=[
            "The peers compare rotation vectors in one chart by Euclidean distance, not rotations by angle.",
        ],
    )
    for peer, aim in zip(times[len(own) :], aims, strict=False):
        gain = results.tables[-1].median(peer.name) / results.tables[-1].median(names[-1])
        results.aim(f"patch_neighbors, {what}: {peer.name} ÷ {names[-1]}", gain, at_least=aim)
