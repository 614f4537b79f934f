"""Figures 2 to 4 of Courty's bilateral filter, the filters its section 3.2 sets aside, and its time.

The clip, the frames, the joint and the settings were fixed before the first figure was drawn, and are the paper's where it
states them.
"""

import math
import statistics
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from quatfilt._backend import get_num_threads, set_num_threads, use_backend
from quatfilt._typing import Array
from quatfilt.evaluation import comparisons
from quatfilt.evaluation.channels import Values
from quatfilt.evaluation.clips import SYNTHETIC, load, thinned
from quatfilt.filters.bilateral import bilateral
from quatfilt.filters.orientation_filter import orientation_filter
from quatfilt.motion.metrics import mse
from quatfilt.motion.motion import Motion
from quatfilt.noise.noise import add_gaussian_noise
from quatfilt.rotations.quaternion import exp, geodesic_distance, multiply

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


def run(data: Path | None, *, seeds: int, progress: Callable[[int, int], None] | None = None) -> Figures:
    """Compute everything that the figures show.

    Parameters
    ----------
    data : Path or None
        Folder of CMU's recordings; None for the built-in walk.
    seeds : int
        How many noises.
    progress : callable or None, default None
        Is told how many of how many parts are done.

    Returns
    -------
    Figures
        The numbers behind the figures.
    """
    clip = load(data, CLIP)[0]
    motions = [_cut(thinned(clip, every).motion, START[clip.name]) for every in THINNING]
    joint, hand = JOINTS[clip.name]
    parts = len(motions) + 3
    tell = progress or (lambda _done, _total: None)
    curves = []
    for motion in motions:
        curves.append(_curves(motion, joint, seeds))
        tell(len(curves), parts)
    compared = _comparisons(motions[0], seeds)
    tell(len(motions) + 1, parts)
    timings = _timings(motions[0])
    tell(len(motions) + 2, parts)
    drawn = _drawn(motions[0], joint, hand)
    tell(parts, parts)
    return Figures(
        clip=clip.name,
        what=clip.what,
        start=START[clip.name],
        curves=tuple(curves),
        comparisons=compared,
        sparse=tuple(_sparse(step) for step in (2.0, 15.0, 60.0, 120.0)),
        timings=timings,
        drawn=drawn,
    )


def _cut(motion: Motion, start: float) -> Motion:
    first = round(start * motion.fps)
    frames = slice(first, first + FRAMES)
    return motion.replace(rotations=motion.rotations[frames], translation=motion.translation[frames])


def _noisy(q: Array, seed: int) -> Array:
    return add_gaussian_noise(q, sigma=NOISE, rng=np.random.default_rng([seed, FRAMES]))


def _curves(motion: Motion, joint: str, seeds: int) -> Curves:
    truth = motion.rotations
    place = motion.skeleton.index(joint)
    before = np.zeros(2)
    errors = {sigma: np.zeros((PASSES, 2)) for sigma in SIGMAS}
    for seed in range(seeds):
        noisy = _noisy(truth, seed)
        before += _both(truth, noisy, place) / seeds
        for sigma in SIGMAS:
            q = noisy
            for number in range(PASSES):
                q = bilateral(q, sigma_angle=2 * sigma, radius=RADIUS, sigma_time=SIGMA_TIME)
                errors[sigma][number] += _both(truth, q, place) / seeds
    return Curves(
        fps=motion.fps,
        noisy=float(before[0]),
        noisy_all=float(before[1]),
        joint={sigma: tuple(map(float, each[:, 0])) for sigma, each in errors.items()},
        every={sigma: tuple(map(float, each[:, 1])) for sigma, each in errors.items()},
    )


def _both(truth: Array, q: Array, place: int) -> Values:
    """MSE of one joint, and of all."""
    joints = np.asarray(mse(truth, q, per="joint"))
    return np.array([joints[place], joints.mean()])


def _comparisons(motion: Motion, seeds: int) -> tuple[Comparison, ...]:
    truth = motion.rotations
    tenth = len(truth) // 10
    results = []
    for name, run_filter in FILTERS.items():
        found = np.zeros(4)
        for seed in range(seeds):
            noisy = _noisy(truth, seed)
            five = np.asarray(mse(truth, run_filter(noisy, FIVE), per="sample")).mean(axis=1)
            found += [
                mse(truth, run_filter(noisy, 1)),
                five.mean(),
                five[:tenth].mean(),
                five[-tenth:].mean(),
            ]
        noisy = _noisy(truth, 0)
        turned = []
        for degrees in TURNS:
            turn = exp(np.array([[[0.0, math.radians(degrees) / 2, 0.0]]]))
            turned.append(float(mse(multiply(turn, truth), run_filter(multiply(turn, noisy), 1))))
        once, all_frames, first, last = (float(value) for value in found / seeds)
        results.append(Comparison(name, once, all_frames, first, last, (min(turned), max(turned))))
    return tuple(results)


def _sparse(step: float) -> Sparse:
    """Turn about one axis at a constant rate, and look forward alone: the mean is not the middle."""
    frames = np.arange(-RADIUS, RADIUS + 1)
    angles = math.radians(step) * frames
    mask = np.where(frames >= 0, MASK, 0.0)
    exact = float(np.sum(mask * angles) / np.sum(mask))
    q = exp(np.stack([angles / 2, 0 * angles, 0 * angles], axis=-1))[:, None]
    wanted = exp(np.array([[exact / 2, 0.0, 0.0]]))
    found = [
        comparisons.renormalised_average(q, mask)[RADIUS],
        orientation_filter(q, mask)[RADIUS],
    ]
    away = [float(np.degrees(geodesic_distance(wanted, each)[0])) for each in found]
    return Sparse(step, *away)


def _timings(motion: Motion) -> tuple[Timing, ...]:
    """Time the paper's workload: joints are repeated up to 75."""
    count = motion.rotations.shape[1]
    body = motion.rotations[:, np.arange(PAPERS_JOINTS) % count]
    clip = _noisy(np.ascontiguousarray(body), 0)
    threads = get_num_threads()
    cases: list[tuple[str, Array, int]] = [
        ("float64, 1 thread", clip, 1),
        ("float32, 1 thread", clip.astype(np.float32), 1),
    ]
    if threads > 1:
        cases.append((f"float32, {threads} threads", clip.astype(np.float32), threads))
    results = []
    try:
        for what, q, used in cases:
            set_num_threads(used)
            results.append(_timed(what, q, 51))
    finally:
        set_num_threads(threads)
    with use_backend("numpy"):
        results.append(_timed("NumPy reference, float64", clip, 5))
    return tuple(results)


def _timed(what: str, q: Array, repetitions: int) -> Timing:
    taken = []
    for _ in range(repetitions + 1):
        start = time.perf_counter()
        bilateral(q, sigma_angle=2 * DRAWN, iterations=FIVE)
        taken.append(1e3 * (time.perf_counter() - start))
    return Timing(what, statistics.median(taken[1:]), min(taken[1:]))


def _drawn(motion: Motion, joint: str, hand: str) -> Drawn:
    truth = motion.rotations
    noisy = _noisy(truth, 0)
    shown = {
        "noisy": noisy,
        "Gaussian": orientation_filter(noisy, MASK, iterations=FIVE),
        f"bilateral, σ_g = {DRAWN}": bilateral(noisy, sigma_angle=2 * DRAWN, iterations=FIVE),
        f"bilateral, σ_g = {WIDER}": bilateral(noisy, sigma_angle=2 * WIDER, iterations=FIVE),
    }
    errors = {
        name: np.degrees(geodesic_distance(truth, run_filter(noisy, 1))).mean(axis=1)
        for name, run_filter in FILTERS.items()
    }
    return Drawn(
        truth=motion,
        motions={name: motion.replace(rotations=q) for name, q in shown.items()},
        errors={name: np.asarray(each, np.float64) for name, each in errors.items()},
        joint=joint,
        hand=hand,
    )


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


__all__ = [
    "DRAWN",
    "FIVE",
    "FRAMES",
    "MASK",
    "NOISE",
    "PAPERS_JOINTS",
    "PAPERS_MILLISECONDS",
    "PASSES",
    "SIGMAS",
    "Comparison",
    "Curves",
    "Figures",
    "Sparse",
    "Timing",
    "best_pass",
    "path",
    "run",
    "speed",
]
