"""Groups of similar patches against the textbook's formula, written with SciPy and eigenvectors, for one joint."""

import clips
import numpy as np
import pytest
import tolerances
from scipy.fft import dct, idct
from scipy.spatial.transform import Rotation


def directly(q, pilot, sigma):
    """Estimate with one joint ``(frames, 4)``; the constants are those of the definition."""
    r, noisy = clips.rotation(pilot), clips.rotation(q)
    turns = (r[:-1].inv() * r[1:]).as_rotvec()
    clean = np.vstack([np.zeros(3), np.cumsum(turns, axis=0)]) / sigma
    rest = (r.inv() * noisy).as_rotvec() / sigma
    count = len(q) - 23
    spectrum = [dct(clean[s : s + 24], axis=0, norm="ortho")[:8].ravel() for s in range(count)]
    sums, held = np.zeros_like(clean), np.zeros(len(q))
    for s in sorted({*range(0, count - 1, 24), count - 1}):
        window = [c for c in range(count) if abs(c - s) <= 256]
        window.sort(key=lambda c: (np.linalg.norm(spectrum[c] - spectrum[s]), abs(c - s), c))
        group = np.array([spectrum[c] for c in window[:80]])
        mean = group.mean(axis=0)
        values, vectors = np.linalg.eigh(0.75 * np.cov(group.T, bias=True))
        values = np.maximum(values, 0)
        gains = values / (values + 1 + 1e-13 * values.sum())
        for near in (c for c in window[:80] if abs(c - s) <= 21 and (c - s) % 3 == 0):
            noisy_patch = spectrum[near] + dct(rest[near : near + 24], axis=0, norm="ortho")[:8].ravel()
            estimate = mean + vectors @ (gains * (vectors.T @ (noisy_patch - mean)))
            move = np.zeros((24, 3))
            move[:8] = (estimate - spectrum[near]).reshape(8, 3)
            sums[near : near + 24] += idct(move, axis=0, norm="ortho")
            held[near : near + 24] += 1
    return (r * Rotation.from_rotvec(sigma * sums / held[:, None])).as_quat(scalar_first=True)


@pytest.mark.parametrize(("frames", "sigma"), [(103, 0.05), (420, 0.01), (700, 0.2)])
def test_textbook(backend, frames, sigma):
    rng = np.random.default_rng(frames)
    clean = clips.smooth(rng, frames, 1)
    q, pilot = clips.noisy(rng, clean, sigma), clips.noisy(rng, clean, sigma / 5)
    result = backend.smooth_patches(q, pilot, None, np.array([sigma]), 1)
    assert clips.angles(result[:, 0], directly(q[:, 0], pilot[:, 0], sigma)).max() < tolerances.FLOAT64
