"""The numbers behind the bilateral filter's figures, and what is read off them."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from quatfilt.evaluation.channels import Values
from quatfilt.motion.motion import Motion
from quatfilt.rotations.quaternion import geodesic_distance


@dataclass(frozen=True)
class Curves:
    """MSE at one frame rate: means over the seeds, on S³, radians squared."""

    fps: float
    noisy: float
    """Of the drawn joint."""
    noisy_all: float
    joint: dict[float, tuple[float, ...]]
    """By σ_g: after 1, 2, … passes, of the drawn joint."""
    every: dict[float, tuple[float, ...]]
    """The same over all joints."""


@dataclass(frozen=True)
class Comparison:
    """A filter of section 3.2 beside the others: MSE over all joints, means over the seeds."""

    name: str
    once: float
    five: float
    first_tenth: float
    """Of the frames, after five passes."""
    last_tenth: float
    turned: tuple[float, float]
    """After one pass of one noise: least and greatest over the turns of the whole clip."""


@dataclass(frozen=True)
class Sparse:
    """What the average in R⁴ does where samples lie sparsely, about one fixed axis."""

    step: float
    """Degrees from a frame to the next."""
    renormalised: float
    """Degrees between the result and the mask's mean of the angles."""
    lee_shin: float


@dataclass(frozen=True)
class Timing:
    """Milliseconds for 75 joints, 150 frames and five passes."""

    what: str
    median: float
    least: float


@dataclass(frozen=True)
class Drawn:
    """One noise, for the pictures: what became of it, by name."""

    truth: Motion
    motions: dict[str, Motion]
    """Noisy, Gaussian and bilateral after five passes."""
    errors: dict[str, Values]
    """Degrees between the truth and each of `FILTERS` after one pass: mean over the joints, by frame."""
    joint: str
    hand: str


@dataclass(frozen=True)
class Figures:
    """All that is shown."""

    clip: str
    what: str
    start: float
    curves: tuple[Curves, ...]
    comparisons: tuple[Comparison, ...]
    sparse: tuple[Sparse, ...]
    timings: tuple[Timing, ...]
    drawn: Drawn


def speed(motion: Motion, joint: str) -> Values:
    """Angular speed of a joint from frame to frame, degrees per second, ``(frames − 1,)``."""
    q = motion.rotations[:, motion.skeleton.index(joint)]
    return np.asarray(np.degrees(geodesic_distance(q[:-1], q[1:])) * motion.fps, np.float64)


def path(motion: Motion, joint: str) -> Values:
    """Path of a joint in centimetres, ``(frames, 3)``, seen from the root."""
    positions = np.asarray(motion.positions(), np.float64)
    place = positions[:, motion.skeleton.index(joint)] - positions[:, 0]
    return np.asarray(place * motion.skeleton.centimetres_per_unit)


def best_pass(values: Sequence[float]) -> int:
    """Return how many passes give the least error."""
    return 1 + int(np.argmin(values))


__all__ = ["Comparison", "Curves", "Drawn", "Figures", "Sparse", "Timing", "best_pass", "path", "speed"]
