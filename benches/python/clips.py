"""Synthetic clips, seeded."""

import numpy as np
import quatfilt as qf
from numpy.typing import DTypeLike, NDArray

JOINTS = 31
"""Those of the CMU skeleton."""

NOISE = 0.016
"""Deviation of the noise per component of the rotation vector, in radians: the paper's σ = .008 of a logarithm."""

FPS = 120.0

Array = NDArray[np.floating]


def rotation_vectors(frames: int, joints: int = JOINTS, *, seed: int = 0) -> Array:
    """Return three waves per joint and coordinate, and white noise: float32 `(frames, joints, 3)`."""
    rng = np.random.default_rng(seed)
    seconds = np.arange(frames)[:, None, None] / FPS
    vectors = NOISE * rng.standard_normal((frames, joints, 3), np.float32)
    for _ in range(3):
        amplitude = rng.uniform(0.05, 0.3, (joints, 3))
        frequency = rng.uniform(0.2, 3, (joints, 3))
        phase = rng.uniform(0, 2 * np.pi, (joints, 3))
        vectors += (amplitude * np.sin(2 * np.pi * frequency * seconds + phase)).astype(np.float32)
    return vectors


def rotations(frames: int, joints: int = JOINTS, *, dtype: DTypeLike = np.float32, seed: int = 0) -> Array:
    """Return unit quaternions `(frames, joints, 4)`."""
    return qf.exp(0.5 * rotation_vectors(frames, joints, seed=seed).astype(dtype))
