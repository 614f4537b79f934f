"""Automatic smoothing, without a parameter, beside a Gaussian filter whose strength is chosen with the truth at hand."""

import clips
import numpy as np
import pytest
import quatfilt as qf
from quatfilt.evaluation.synthetic import walk
from scipy.ndimage import gaussian_filter1d

SIGMA = 0.016
"""The least noise per component of the rotation vector, in radians; the others are multiples of it."""

MULTIPLES = [1, 5, 15, 30]

MASKS = np.geomspace(0.7, 24, 12)
"""Frames: deviations of Gaussian masks."""

FASTEST = np.radians(15)
"""Joints that ever turn farther from frame to frame have defects of their own."""


def psnr(error):
    """Peak signal-to-noise ratio in decibels, of half rotation angles."""
    return -20 * np.log10(np.sqrt(np.mean((error / 2) ** 2)))


def best_gaussian(clean, noisy, joints):
    """The best of all masks, on rotation vectors and on components of quaternions."""
    q = qf.continuous(noisy)
    results = []
    for sigma in MASKS:
        components = gaussian_filter1d(q, sigma, axis=0, mode="nearest")
        vectors = gaussian_filter1d(qf.log(q), sigma, axis=0, mode="nearest")
        results += [components / np.linalg.norm(components, axis=-1, keepdims=True), qf.exp(vectors)]
    return max(psnr(clips.angles(x, clean)[:, joints]) for x in results)


def gains(clean, joints, seed):
    """By how many decibels the smoother is better, for each noise."""
    rng = np.random.default_rng(seed)
    found = []
    for multiple in MULTIPLES:
        noisy = clips.noisy(rng, clean, multiple * SIGMA)
        ours = psnr(clips.angles(qf.smooth(noisy), clean)[:, joints])
        found.append(ours - best_gaussian(clean, noisy, joints))
    return np.array(found)


@pytest.mark.parametrize(("seconds", "gain"), [(1, 1.0), (3, 1.8), (8, 2.0)])
def test_a_synthetic_walk(seconds, gain):
    clean = walk(seconds=seconds).rotations
    found = gains(clean, slice(None), seconds)
    assert (found > gain).all()


@pytest.mark.parametrize("clip", ["02/02_01", "13/13_29"])
def test_recordings(data_dir, clip):
    clean = qf.read_motion(data_dir / "cmu" / f"{clip}.amc").rotations[:1500]
    steps = clips.angles(clean[1:], clean[:-1]).max(axis=0)
    found = gains(clean, (steps > 0) & (steps < FASTEST), 0)
    assert (found > 1.5).all()


@pytest.mark.parametrize(("multiple", "gain"), [(50, 16), (75, 14)])
def test_noise_that_wraps(multiple, gain):
    clean = walk(seconds=8).rotations
    noisy = clips.noisy(np.random.default_rng(1), clean, multiple * SIGMA)
    assert psnr(clips.angles(qf.denoise(noisy), clean)) > psnr(clips.angles(noisy, clean)) + gain
