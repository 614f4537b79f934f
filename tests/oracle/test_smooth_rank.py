"""Low rank in bands of frequencies against the papers' formula, written with SciPy's transforms and singular values."""

import clips
import numpy as np
import pytest
import tolerances
from scipy.fft import dct, idct
from scipy.spatial.transform import Rotation


def shrunk(y, variance):
    """Optimal shrinkage of Gavish and Donoho for the Frobenius norm, noise of a known variance."""
    u, singular, v = np.linalg.svd(y, full_matrices=False)
    long, short = max(y.shape), min(y.shape)
    scaled, beta = singular / np.sqrt(long * variance), short / long
    inside = np.maximum((scaled**2 - beta - 1) ** 2 - 4 * beta, 0)
    shrunk = np.where(scaled > 1 + np.sqrt(beta), np.sqrt(inside) / scaled, 0)
    return (u * (shrunk * np.sqrt(long * variance))) @ v


def directly(q, pilot, sigma):
    """Estimate of one window; the constants are those of the definition."""
    frames, joints = q.shape[:2]
    clean, rest = np.zeros((2, frames, joints, 3))
    for j in range(joints):
        r, noisy = clips.rotation(pilot[:, j]), clips.rotation(q[:, j])
        clean[1:, j] = np.cumsum((r[:-1].inv() * r[1:]).as_rotvec(), axis=0) / sigma
        rest[:, j] = (r.inv() * noisy).as_rotvec() / sigma
    before, after = (dct(x.reshape(frames, -1), axis=0, norm="ortho") for x in (clean, clean + rest))
    period = 2 * frames / np.maximum(np.arange(frames), 1e-9)
    move = np.zeros_like(before)
    for longest in (np.inf, 60, 30, 15, 7.5, 3.75):
        shortest = {np.inf: 60}.get(longest, longest / 2)
        band = (period <= longest) & (period > shortest) & (np.arange(frames) > 0)
        move[band] = shrunk((before[band] + after[band]) / 2, 0.3) - before[band]
    moved = 0.35 * sigma * idct(move, axis=0, norm="ortho").reshape(clean.shape)
    result = [
        (clips.rotation(pilot[:, j]) * Rotation.from_rotvec(moved[:, j])).as_quat(scalar_first=True)
        for j in range(joints)
    ]
    return np.stack(result, axis=1)


@pytest.mark.parametrize(("frames", "sigma"), [(128, 0.05), (420, 0.01), (512, 0.2)])
def test_textbook(backend, frames, sigma):
    rng = np.random.default_rng(frames)
    clean = clips.smooth(rng, frames, 12)
    q, pilot = clips.noisy(rng, clean, sigma), clips.noisy(rng, clean, sigma / 5)
    result = backend.smooth_rank(q, pilot, None, np.full(12, sigma))
    assert clips.angles(result, directly(q, pilot, sigma)).max() < tolerances.FLOAT64
