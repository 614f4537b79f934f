"""The parts of the bilateral filter's figures, each computed from one clip."""

import math
import statistics
import time

import numpy as np

from quatfilt._backend import get_num_threads, set_num_threads, use_backend
from quatfilt._typing import Array
from quatfilt.evaluation.bilateral_figs_conditions import (
    DRAWN,
    FILTERS,
    FIVE,
    MASK,
    PAPERS_JOINTS,
    PASSES,
    RADIUS,
    SIGMA_TIME,
    SIGMAS,
    TURNS,
    WIDER,
    with_noise,
)
from quatfilt.evaluation.bilateral_figs_results import Comparison, Curves, Drawn, Sparse, Timing
from quatfilt.evaluation.channels import Values
from quatfilt.evaluation.comparisons import renormalised_average
from quatfilt.filters.bilateral import bilateral
from quatfilt.filters.orientation_filter import orientation_filter
from quatfilt.motion.metrics import mse
from quatfilt.motion.motion import Motion
from quatfilt.rotations.quaternion import exp, geodesic_distance, multiply


def curves(motion: Motion, joint: str, seeds: int) -> Curves:
    """Follow the error through the passes, for each σ_g."""
    truth = motion.rotations
    place = motion.skeleton.index(joint)
    before = np.zeros(2)
    errors = {sigma: np.zeros((PASSES, 2)) for sigma in SIGMAS}
    for seed in range(seeds):
        noisy = with_noise(truth, seed)
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


def comparisons(motion: Motion, seeds: int) -> tuple[Comparison, ...]:
    """Run each of `FILTERS` once and five times, and over the turns of the whole clip."""
    truth = motion.rotations
    tenth = len(truth) // 10
    results = []
    for name, run_filter in FILTERS.items():
        found = np.zeros(4)
        for seed in range(seeds):
            noisy = with_noise(truth, seed)
            five = np.asarray(mse(truth, run_filter(noisy, FIVE), per="sample")).mean(axis=1)
            found += [
                mse(truth, run_filter(noisy, 1)),
                five.mean(),
                five[:tenth].mean(),
                five[-tenth:].mean(),
            ]
        noisy = with_noise(truth, 0)
        turned = []
        for degrees in TURNS:
            turn = exp(np.array([[[0.0, math.radians(degrees) / 2, 0.0]]]))
            turned.append(float(mse(multiply(turn, truth), run_filter(multiply(turn, noisy), 1))))
        once, all_frames, first, last = (float(value) for value in found / seeds)
        results.append(Comparison(name, once, all_frames, first, last, (min(turned), max(turned))))
    return tuple(results)


def sparse(step: float) -> Sparse:
    """Turn about one axis at a constant rate, and look forward alone: the mean is not the middle."""
    frames = np.arange(-RADIUS, RADIUS + 1)
    angles = math.radians(step) * frames
    mask = np.where(frames >= 0, MASK, 0.0)
    exact = float(np.sum(mask * angles) / np.sum(mask))
    q = exp(np.stack([angles / 2, 0 * angles, 0 * angles], axis=-1))[:, None]
    wanted = exp(np.array([[exact / 2, 0.0, 0.0]]))
    found = [
        renormalised_average(q, mask)[RADIUS],
        orientation_filter(q, mask)[RADIUS],
    ]
    away = [float(np.degrees(geodesic_distance(wanted, each)[0])) for each in found]
    return Sparse(step, *away)


def timings(motion: Motion) -> tuple[Timing, ...]:
    """Time the paper's workload: joints are repeated up to 75."""
    count = motion.rotations.shape[1]
    body = motion.rotations[:, np.arange(PAPERS_JOINTS) % count]
    clip = with_noise(np.ascontiguousarray(body), 0)
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


def drawn(motion: Motion, joint: str, hand: str) -> Drawn:
    """Filter one noise, for the pictures."""
    truth = motion.rotations
    noisy = with_noise(truth, 0)
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


__all__ = ["comparisons", "curves", "drawn", "sparse", "timings"]
