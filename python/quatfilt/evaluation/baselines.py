"""Smoothing as it is done today: SciPy, PyWavelets and Blender on channels of numbers.

Each filter takes numbers ``(frames, channels)``, any number of settings, and the frame rate, and yields the filtered
numbers for one setting after the other; what settings share is computed once. All grids have the same number of
settings.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from typing import TypeAlias

import numpy as np
from scipy import ndimage, signal

from quatfilt._extras import pywavelets
from quatfilt.evaluation.channels import Values

Sweep: TypeAlias = Callable[[Values, Sequence[float], float], Iterator[Values]]

SETTINGS = 17
"""How many settings every oracle chooses from."""


def cutoffs(fps: float) -> list[float]:
    """Hertz from half a cycle per second to just below the highest frequency there is, in equal ratios."""
    return [float(value) for value in np.geomspace(0.5, 0.45 * fps, SETTINGS)]


def gaussian(x: Values, sigmas: Sequence[float], _fps: float = 1.0) -> Iterator[Values]:
    """Gaussian, σ in frames, with SciPy's defaults."""
    for sigma in sigmas:
        yield ndimage.gaussian_filter1d(x, sigma, axis=0)


def _gaussian_grid(fps: float) -> list[float]:
    # The σ whose gain at the cut-off is 1/√2.
    return [math.sqrt(math.log(2)) * fps / (2 * math.pi * cutoff) for cutoff in cutoffs(fps)]


def butterworth(x: Values, hertz: Sequence[float], fps: float) -> Iterator[Values]:
    """Butterworth low pass of order 4, forward and backward, cut-off in hertz."""
    for cutoff in hertz:
        sections = signal.butter(4, cutoff, fs=fps, output="sos")
        padding = min(3 * (2 * len(sections) + 1), len(x) - 1)
        yield np.asarray(signal.sosfiltfilt(sections, x, axis=0, padlen=padding))


def savgol(x: Values, windows: Sequence[float], _fps: float = 1.0) -> Iterator[Values]:
    """Savitzky-Golay of degree 3, window in frames; windows that a clip cannot hold are cut to what it holds.

    Equal to ``scipy.signal.savgol_filter``, whose coefficients are symmetric but for rounding: made so, they are summed
    twenty times as fast.
    """
    longest = len(x) - 1 + len(x) % 2
    for window in windows:
        frames = min(int(window), longest)
        half = frames // 2
        powers = np.linspace(-1, 1, frames)[:, None] ** np.arange(min(4, frames)) if half else np.ones((1, 1))
        fit = powers @ np.linalg.pinv(powers)
        result = ndimage.correlate1d(x, (fit[half] + fit[half, ::-1]) / 2, axis=0)
        # Near the ends, the polynomials through the first and the last window.
        result[:half] = fit[:half] @ x[:frames]
        result[len(x) - half :] = fit[frames - half :] @ x[-frames:]
        yield result


_WINDOWS = (5, 7, 9, 11, 13, 15, 19, 23, 27, 33, 39, 47, 57, 69, 83, 101, 121)


def blender(x: Values, counts: Sequence[float], _fps: float = 1.0) -> Iterator[Values]:
    """Blender's "Smooth Keys" on each channel, so many times; counts ascend.

    ``(2, 3, 2, 3, 2) / 12``. The two end keys are not touched; where the second key before or after is missing, the
    first one counts in its place, and it is missing for the third key too.
    """
    done = 0
    for count in counts:
        while done < count:
            x = _smooth_keys(x)
            done += 1
        yield x


def _smooth_keys(x: Values) -> Values:
    if len(x) < 3:
        return x
    result = ndimage.correlate1d(x, _KEYS, axis=0)
    for key in {1, 2, len(x) - 2}:
        second = key - 2 if key > 2 else key - 1
        fourth = key + 2 if key + 2 < len(x) else key + 1
        if key < len(x) - 1:
            result[key] = _KEYS @ x[[second, key - 1, key, key + 1, fourth]]
    result[[0, -1]] = x[[0, -1]]
    return result


_KEYS = np.array([2, 3, 2, 3, 2]) / 12

_COUNTS = (1, 2, 3, 4, 6, 8, 11, 16, 23, 32, 45, 64, 91, 128, 181, 256, 362)


def wavelet(x: Values, factors: Sequence[float], _fps: float = 1.0) -> Iterator[Values]:
    """Donoho's shrinkage with PyWavelets: all details of the Symlet of 8, soft, per channel.

    The threshold is so many times the universal one, ``σ·√(2 ln frames)``, with σ from the median of the finest details.
    """
    pywt = pywavelets()
    if pywt.dwt_max_level(len(x), "sym8") == 0:
        for _ in factors:
            yield x
        return
    coarse, *details = pywt.wavedec(x, "sym8", axis=0)
    sigma = np.median(np.abs(details[-1]), axis=0) / 0.6745
    universal = sigma * math.sqrt(2 * math.log(len(x)))
    for factor in factors:
        shrunk = [np.sign(d) * np.maximum(np.abs(d) - factor * universal, 0) for d in details]
        yield np.asarray(pywt.waverec([coarse, *shrunk], "sym8", axis=0))[: len(x)]


def kalman_forward(x: Values, ratios: Sequence[float], fps: float) -> Iterator[Values]:
    """Kalman filter of constant velocity, per channel: the past alone.

    The setting is the deviation of the acceleration over that of the measurement, per second squared.
    """
    for ratio in ratios:
        yield _forward(x, _gains(ratio / fps**2, len(x)))[0]


def kalman_smoother(x: Values, ratios: Sequence[float], fps: float) -> Iterator[Values]:
    """Kalman smoother of Rauch, Tung and Striebel: `kalman_forward`, and then backward from the end."""
    for ratio in ratios:
        gains = _gains(ratio / fps**2, len(x))
        place, speed = _forward(x, gains)
        result = np.empty_like(x)
        later, faster = place[-1], speed[-1]
        result[-1] = later
        for t, ((a, b), (c, d)) in reversed(list(enumerate(gains.back.tolist()))):
            # What the future says beyond the prediction.
            ahead, quicker = later - (place[t] + speed[t]), faster - speed[t]
            later = place[t] + a * ahead + b * quicker
            faster = speed[t] + c * ahead + d * quicker
            result[t] = later
        yield result


@dataclass(frozen=True)
class _Gains:
    """What a Kalman filter makes of a surprise, frame by frame; no channel has a say in it."""

    place: Values
    speed: Values
    back: Values
    """Of the smoother: from the surprise in the next frame's state to this frame's, ``(frames − 1, 2, 2)``."""


_UNKNOWN = 1e4
"""Variance of the first velocity, in variances of a measurement per frame: nothing is known."""


@cache
def _gains(acceleration: float, frames: int) -> _Gains:
    """Solve the Riccati equation; `acceleration` is its deviation per frame squared, over a measurement's."""
    step = np.array([[1.0, 1.0], [0.0, 1.0]])
    noise = acceleration**2 * np.array([[0.25, 0.5], [0.5, 1.0]])
    known = np.array([[1.0, 0.0], [0.0, _UNKNOWN]])
    result = _Gains(np.ones(frames), np.zeros(frames), np.zeros((max(frames - 1, 0), 2, 2)))
    for t in range(1, frames):
        ahead = step @ known @ step.T + noise
        result.back[t - 1] = known @ step.T @ np.linalg.inv(ahead)
        gain = ahead[:, 0] / (ahead[0, 0] + 1)
        known = ahead - np.outer(gain, ahead[0])
        result.place[t], result.speed[t] = gain
    return result


def _forward(x: Values, gains: _Gains) -> tuple[Values, Values]:
    """Return filtered values and their velocities per frame."""
    place, speed = x.copy(), np.zeros_like(x)
    here, rate = x[0], np.zeros(x.shape[1])
    for t, (trust, push) in enumerate(
        zip(gains.place[1:].tolist(), gains.speed[1:].tolist(), strict=True), 1
    ):
        here = here + rate
        surprise = x[t] - here
        here = here + trust * surprise
        rate = rate + push * surprise
        place[t], speed[t] = here, rate
    return place, speed


def _kalman_grid(fps: float) -> list[float]:
    # The smoother's gain at the cut-off is 1/2: 1/(1 + 16 sin⁴(π·cutoff/fps)/(acceleration per frame²)²).
    return [(2 * math.sin(math.pi * cutoff / fps) * fps) ** 2 for cutoff in cutoffs(fps)]


@dataclass(frozen=True)
class Baseline:
    """A filter for numbers, as it is used and as it might be."""

    name: str
    sweep: Sweep
    default: float
    source: str
    """Where the default comes from."""
    grid: Callable[[float], Sequence[float]]
    """Settings of the oracle, at a frame rate."""
    unit: str


BASELINES = (
    Baseline("Gaussian", gaussian, 1, "σ = 1 frame, Courty's and Pose2Sim's", _gaussian_grid, "frames"),
    Baseline(
        "Kalman (forward)",
        kalman_forward,
        500,
        "constant velocity, Pose2Sim's ratio of noises of 500 per s²",
        _kalman_grid,
        "per s²",
    ),
    Baseline(
        "Kalman (smoother)",
        kalman_smoother,
        500,
        "the same, and backward",
        _kalman_grid,
        "per s²",
    ),
    Baseline("Blender", blender, 1, "Smooth Keys once", lambda _: _COUNTS, "times"),
    Baseline(
        "wavelet",
        wavelet,
        1,
        "Symlet of 8, soft, Donoho's universal threshold",
        # Steps of a fourth of an octave from an eighth of the universal threshold to twice.
        lambda _: [2.0 ** (step / 4) for step in range(-12, 5)],
        "of the universal threshold",
    ),
    Baseline(
        "Butterworth", butterworth, 6, "order 4, 6 Hz, forward and backward: biomechanics", cutoffs, "Hz"
    ),
    Baseline("Savitzky-Golay", savgol, 11, "window 11, degree 3", lambda _: _WINDOWS, "frames"),
)
"""The classical filters of the tables."""

__all__ = [
    "BASELINES",
    "SETTINGS",
    "Baseline",
    "Values",
    "blender",
    "butterworth",
    "cutoffs",
    "gaussian",
    "kalman_forward",
    "kalman_smoother",
    "savgol",
    "wavelet",
]
