"""The conditions of the bilateral filter's figures: clip, noise, filters and their settings.

All were fixed before the first figure was drawn, and are the paper's where it states them.
"""

import math
from collections.abc import Callable

import numpy as np

from quatfilt._typing import Array
from quatfilt.evaluation import comparisons
from quatfilt.evaluation.clips import SYNTHETIC
from quatfilt.filters.bilateral import bilateral
from quatfilt.filters.orientation_filter import orientation_filter
from quatfilt.motion.motion import Motion
from quatfilt.noise.noise import add_gaussian_noise

CLIP = {"14_25": "directs traffic, waves, points"}
"""The recording nearest to the paper's sign language."""

FRAMES = 150
START = {"14_25": 5.0, SYNTHETIC: 2.0}
"""Seconds into the clip."""

THINNING = (4, 2, 1)
"""One frame of so many of 120 per second: the paper does not say its rate. The first is drawn."""

JOINTS = {"14_25": ("rhumerus", "rhand"), SYNTHETIC: ("RightShoulder", "RightWrist")}
"""The joint whose rotation is drawn, and the hand whose path is."""

NOISE = 0.18
"""Radians per component of the rotation vector. The paper's "0.18 radians" as an angle of rotation."""

SIGMAS = (0.05, 0.1, 0.2, 0.4, math.inf)
"""The paper's σ_g, on S³: half of `sigma_angle`. Infinite: the Gaussian filter."""

DRAWN, WIDER = 0.1, 0.2
"""The σ_g whose results are drawn: the paper's, and twice it."""

PASSES = 10
FIVE = 5
RADIUS = 4
SIGMA_TIME = 1.0

MASK = np.exp(-np.abs(np.arange(-RADIUS, RADIUS + 1)) / (2 * SIGMA_TIME**2))
"""Of the Gaussian filter: the weights in time as the paper prints them."""

PAPERS_MILLISECONDS = 300
PAPERS_JOINTS = 75

TURNS = tuple(range(0, 360, 30))
"""Degrees about the y axis by which the whole clip is turned: a filter should not care."""

FILTERS: dict[str, Callable[[Array, int], Array]] = {
    "R⁴, renormalised": lambda q, n: comparisons.renormalised_average(q, MASK, iterations=n),
    "one global chart": lambda q, n: comparisons.global_chart(q, MASK, iterations=n),
    "displacements integrated": lambda q, n: comparisons.integrated_displacements(q, MASK, iterations=n),
    "Gaussian (Lee and Shin)": lambda q, n: orientation_filter(q, MASK, iterations=n),
    f"bilateral, σ_g = {DRAWN}": lambda q, n: bilateral(q, sigma_angle=2 * DRAWN, iterations=n),
    f"bilateral, σ_g = {WIDER}": lambda q, n: bilateral(q, sigma_angle=2 * WIDER, iterations=n),
    f"bilateral, σ_g = {DRAWN}, kernel as printed": lambda q, n: bilateral(
        q, sigma_angle=2 * DRAWN, iterations=n, kernel="printed"
    ),
}
"""Beside each other in a table; all have the same weights in time."""


def cut(motion: Motion, start: float) -> Motion:
    """Return the frames that are shown."""
    first = round(start * motion.fps)
    frames = slice(first, first + FRAMES)
    return motion.replace(rotations=motion.rotations[frames], translation=motion.translation[frames])


def with_noise(q: Array, seed: int) -> Array:
    """Return a clip with one of the noises."""
    return add_gaussian_noise(q, sigma=NOISE, rng=np.random.default_rng([seed, FRAMES]))


__all__ = [
    "CLIP",
    "DRAWN",
    "FILTERS",
    "FIVE",
    "FRAMES",
    "JOINTS",
    "MASK",
    "NOISE",
    "PAPERS_JOINTS",
    "PAPERS_MILLISECONDS",
    "PASSES",
    "RADIUS",
    "SIGMAS",
    "SIGMA_TIME",
    "START",
    "THINNING",
    "TURNS",
    "WIDER",
    "cut",
    "with_noise",
]
