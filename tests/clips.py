"""Synthetic clips, seeded, and ways to look at rotations, on SciPy alone.

Clips are unit quaternions ``(frames, joints, 4)``, scalar first, float64.
"""

import numpy as np
from scipy.spatial.transform import Rotation

FPS = 120.0


def rotation(q):
    """SciPy's rotations, of shape ``(samples,)``."""
    return Rotation.from_quat(np.reshape(q, (-1, 4)), scalar_first=True)


def quaternions(rotations, shape):
    """Quaternions of SciPy's rotations in the given shape, ``w ≥ 0``."""
    return rotations.as_quat(canonical=True, scalar_first=True).reshape(*shape, 4)


def from_vectors(vectors):
    """Unit quaternions of rotation vectors ``(..., 3)``."""
    return quaternions(Rotation.from_rotvec(np.reshape(vectors, (-1, 3))), np.shape(vectors)[:-1])


def angles(a, b):
    """Rotation angles between two arrays of quaternions, ``(...)``."""
    return (rotation(a).inv() * rotation(b)).magnitude().reshape(np.shape(a)[:-1])


def product(a, b):
    """Rotation `b` followed by `a`, broadcast."""
    shape = np.broadcast_shapes(np.shape(a), np.shape(b))
    return quaternions(rotation(np.broadcast_to(a, shape)) * rotation(np.broadcast_to(b, shape)), shape[:-1])


def random_rotations(rng, *shape):
    """Rotations spread evenly."""
    return quaternions(Rotation.random(int(np.prod(shape)), rng=rng), shape)


def smooth(rng, frames, joints, *, swing=0.6):
    """Joints that swing about random poses, in random sums of slow waves; `swing` in radians."""
    seconds = np.arange(frames)[:, None, None, None] / FPS
    frequency = rng.uniform(0.2, 3, (joints, 3, 4))
    phase = rng.uniform(0, 2 * np.pi, frequency.shape)
    amplitude = swing * rng.uniform(-1, 1, frequency.shape) / (1 + frequency)
    vectors = np.sum(amplitude * np.sin(2 * np.pi * frequency * seconds + phase), axis=-1)
    return product(random_rotations(rng, joints), from_vectors(vectors))


def walk(rng, frames, joints):
    """A gait of one cycle per second: each joint swings about its axis with three harmonics."""
    cycle = 2 * np.pi * np.arange(frames)[:, None, None] / FPS * np.arange(1, 4)
    amplitude = rng.uniform(0.1, 0.7, (joints, 3)) / np.arange(1, 4) ** 2
    angle = np.sum(amplitude * np.sin(cycle + rng.uniform(0, 2 * np.pi, (joints, 3))), axis=-1)
    axis = rng.standard_normal((joints, 3))
    axis /= np.linalg.norm(axis, axis=-1, keepdims=True)
    return product(random_rotations(rng, joints), from_vectors(angle[..., None] * axis))


def turning(rng, frames, joints, *, turns):
    """A walk whose root turns about the vertical, so often from the first frame to the last.

    It turns slowly at first: the mean lies near the start, and the end is seen far from it.
    """
    q = walk(rng, frames, joints)
    angle = 2 * np.pi * turns * np.linspace(0, 1, frames) ** 3
    q[:, 0] = product(from_vectors(angle[:, None] * np.array([0.0, 1.0, 0.0])), q[:, 0])
    return q


def noisy(rng, q, sigma):
    """White noise on the rotation vectors, `sigma` in radians per component: ``q · exp(n/2)``."""
    return product(q, from_vectors(sigma * rng.standard_normal((*q.shape[:-1], 3))))


def flipped(rng, q):
    """The same rotations with random signs."""
    return q * rng.choice([-1.0, 1.0], (*q.shape[:-1], 1))


def path(rng, frames):
    """Positions of a root that wanders, ``(frames, 3)``."""
    return np.cumsum(rng.standard_normal((frames, 3)), axis=0) / 10


def confidences(rng, frames, joints):
    """Values from 0 to 1, a quarter of them 0."""
    return np.where(rng.random((frames, joints)) < 0.25, 0.0, rng.random((frames, joints)))
