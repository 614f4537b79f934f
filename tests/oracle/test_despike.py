"""The search for spikes beside a direct one: all runs of all lengths, with SciPy's rotations and NumPy's polynomials."""

import functools
import itertools
import statistics

import clips
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

FRAMES = 24


def between(a, b):
    return (a.inv() * b).as_rotvec()


def distance(a, b):
    return (a.inv() * b).magnitude()


def neighbours(trusted, first, last, radius):
    """Return the nearest trusted frames before and after a run."""
    before = [f for f in range(first - 1, first - 1 - 3 * radius, -1) if f >= 0 and trusted[f]]
    after = [f for f in range(last + 1, last + 1 + 3 * radius) if f < len(trusted) and trusted[f]]
    return before[:radius], after[:radius]


def on_line(path, frames, frame):
    """Return where a polynomial of degree 1 in the vectors from the nearest frame is, or the nearest itself."""
    nearest = path[frames[0]]
    if len(frames) == 1:
        return nearest
    vectors = np.array([between(nearest, path[f]) for f in frames])
    expected = [np.polyval(np.polyfit(frames, column, 1), frame) for column in vectors.T]
    return nearest * Rotation.from_rotvec(expected)


def deviation(path, trusted, first, last, radius):
    before, after = neighbours(trusted, first, last, radius)
    if not before or not after:
        return None
    a, b = before[0], after[0]
    distances = []
    for frame in range(first, last + 1):
        part = (frame - a) / (b - a)
        through = path[a] * Rotation.from_rotvec(part * between(path[a], path[b]))
        guesses = [path[a], path[b], through, on_line(path, before, frame), on_line(path, after, frame)]
        distances += [distance(guess, path[frame]) for guess in guesses]
    return min(distances)


def spikes_of(path, trusted, noise, smallest, radius, threshold):
    found = set()
    for length in range(1, radius):
        for first in range(len(path) - length + 1):
            last = first + length - 1
            away = deviation(path, trusted, first, last, radius)
            if away is None:
                continue
            others = [
                deviation(path, trusted, other, other + length - 1, radius)
                for other in range(max(first - 3 * radius, 0), first + 3 * radius + 1)
                if abs(other - first) >= length
                and other + length <= len(path)
                and trusted[other : other + length].all()
            ]
            usual = max(1.5 * noise, statistics.median([x for x in others if x is not None] or [0.0]))
            moves = [
                distance(path[m], path[n]) / abs(m - n)
                for side in neighbours(trusted, first, last, radius)
                for m, n in itertools.pairwise(side)
            ]
            if away > max(threshold * usual, smallest, 2 * statistics.median(moves or [0.0])):
                found.update(range(first, last + 1))
    return found


@functools.cache
def example(seed, radius, threshold):
    """Return a clip and its spikes."""
    rng = np.random.default_rng(seed)
    q = clips.noisy(rng, clips.smooth(rng, FRAMES, 1), 0.004)
    hit = rng.random((FRAMES, 1)) < 0.15
    q[hit] = clips.product(q[hit], clips.from_vectors(0.6 * rng.standard_normal((hit.sum(), 3))))
    path = Rotation.from_quat(q[:, 0], scalar_first=True)
    found = set()
    for _ in range(3):
        trusted = np.array([frame not in found for frame in range(FRAMES)])
        found = spikes_of(path, trusted, 0.004, 0.05, radius, threshold)
    return q, found


@pytest.mark.parametrize(
    ("seed", "radius", "threshold"), [(0, 2, 4.0), (1, 3, 4.0), (2, 3, 4.0), (3, 4, 1.5)]
)
def test_direct_search(backend, seed, radius, threshold):
    q, found = example(seed, radius, threshold)
    assert found
    result = backend.find_spikes(q, None, np.array([0.004]), np.array([0.05]), radius, threshold, 0)
    assert set(np.flatnonzero(result[:, 0]).tolist()) == found
