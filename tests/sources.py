"""Clips as trackers write them, made of clean ones."""

import clips
import numpy as np


def held(_rng, q, every=4):
    """Every so many frames a new one."""
    return q[np.arange(len(q)) // every * every]


def interpolated(rng, q):
    """Geodesics between measurements 10/3 or 20/3 frames apart, and both ends; knots are no frames."""
    return interpolated_at(rng, q)[0]


def interpolated_at(rng, q):
    """The same, and the times of the measurements."""
    last = len(q) - 1
    ticks = np.arange(rng.uniform(0.2, 3), last, 10 / 3)
    dropped = np.flatnonzero(rng.random(len(ticks)) < 0.1)
    dropped = dropped[np.diff(dropped, prepend=-2) > 1]
    times = np.unique(np.concatenate([[0.0], np.delete(ticks, dropped), [float(last)]]))
    return between(between(q, np.arange(last + 1.0), times), times, np.arange(last + 1.0)), times


def between(q, times, new_times):
    """Rotations on the geodesics between samples."""
    left = np.clip(np.searchsorted(times, new_times, side="right") - 1, 0, len(times) - 2)
    part = (new_times - times[left]) / (times[left + 1] - times[left])
    shape = (len(new_times), q.shape[1])
    a, b = clips.rotation(q[left]), clips.rotation(q[left + 1])
    way = (a.inv() * b).as_rotvec() * np.repeat(part, q.shape[1])[:, None]
    return clips.product(q[left], clips.from_vectors(way.reshape(*shape, 3)))


def video(rng, q, level=0.12, rho=0.5):
    """Noise that is correlated from frame to frame, with accelerations far above those of limbs."""
    noise = rng.normal(size=(*q.shape[:2], 3))
    noise[1:] *= np.sqrt(1 - rho**2)
    for t in range(1, len(noise)):
        noise[t] += rho * noise[t - 1]
    return clips.product(q, clips.from_vectors(level * noise))
