"""Lee and Shin's filters and the bilateral one against the papers' loops, on SciPy's rotations."""

import itertools

import clips
import numpy as np
import pytest
import tolerances

RADIUS = 3


def index(i, frames, boundary):
    """Which frame stands at `i`."""
    if boundary == "nearest":
        return min(max(i, 0), frames - 1)
    period = 2 * (frames - 1)
    return min(i % period, period - i % period)


def one_pass(q, weight, boundary):
    """Displacements from each frame to every other, the sum of the turns on the way; `q`: SciPy's, one per frame."""
    frames = len(q)
    at = [q[index(i, frames, boundary)] for i in range(-RADIUS, frames + RADIUS)]
    turns = [(before.inv() * after).as_rotvec() for before, after in itertools.pairwise(at)]
    result = []
    for i in range(RADIUS, RADIUS + frames):
        total, moved = 0.0, np.zeros(3)
        for r in range(-RADIUS, RADIUS + 1):
            w = weight(r, (at[i].inv() * at[i + r]).magnitude())
            way = sum(turns[i : i + r], np.zeros(3)) - sum(turns[i + r : i], np.zeros(3))
            total, moved = total + w, moved + w * way
        result.append((at[i] * type(at[i]).from_rotvec(moved / total)).as_quat())
    return type(q).from_quat(np.array(result))


def expected(q, weight, iterations, boundary):
    path = clips.rotation(q)
    for _ in range(iterations):
        path = one_pass(path, weight, boundary)
    return clips.quaternions(path, q.shape[:-1])


def sample(frames):
    rng = np.random.default_rng(frames)
    return clips.flipped(rng, clips.noisy(rng, clips.smooth(rng, frames, 1, swing=2), 0.1))


@pytest.mark.parametrize("boundary", ["mirror", "nearest"])
@pytest.mark.parametrize("frames", [2, 3, 20])
def test_orientation_filter(backend, frames, boundary):
    q, mask = sample(frames), np.array([1.0, -0.5, 2, 3, 1, 0, 0.3])
    result, _ = backend.orientation_filter(q, None, mask, 2, boundary)
    loops = expected(q, lambda r, _angle: mask[r + RADIUS], 2, boundary)
    assert clips.angles(result, loops).max() < tolerances.FLOAT64


KERNELS = {
    "gaussian": lambda r, d: np.exp(-abs(r) / (2 * 1.3**2)) * np.exp(-(d**2) / (2 * 0.15**2)),
    "printed": lambda r, d: np.exp(-abs(r) / (2 * 1.3**2)) * np.exp(-d / (2 * 0.15**2)),
    "classic": lambda r, d: np.exp(-(r**2) / (2 * 1.3**2)) * np.exp(-(d**2) / (2 * 0.15**2)),
}
"""The paper's, with its distance on S³ and σ_g = 0.15."""


@pytest.mark.parametrize("boundary", ["mirror", "nearest"])
@pytest.mark.parametrize("frames", [2, 3, 20])
@pytest.mark.parametrize("lookahead", [-1, 0, 2])
@pytest.mark.parametrize("kernel", KERNELS)
def test_bilateral(backend, kernel, lookahead, frames, boundary):
    q = sample(frames)
    result, _ = backend.bilateral(q, None, RADIUS, 1.3, np.array([0.3]), kernel, 2, boundary, lookahead)
    last = RADIUS if lookahead < 0 else lookahead
    loops = expected(q, lambda r, angle: KERNELS[kernel](r, angle / 2) * (r <= last), 2, boundary)
    assert clips.angles(result, loops).max() < tolerances.FLOAT64
