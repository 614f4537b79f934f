"""Noise that looks like motion: estimates from video jump about as fast as limbs move."""

import numpy as np

from quatfilt._reference._arrays import Reals
from quatfilt._reference.noise.noise import increments

RATE = 30.0
"""Hertz: of clips with more frames per second so many are looked at."""

SECONDS = 2.1
"""Length of a window."""

FASTEST = 0.5
"""Radians per second, root mean square: a joint that is slower in a window says nothing about its spectrum."""

LOW, MIDDLE, HIGH, TOP = (0.4, 3.0), (3.0, 5.0), (7.0, 9.0), (11.0, 15.0)
"""Bands of the angular velocity, hertz."""

RESTLESS = 0.2
"""Radians per second, root mean square: slower joints have no acceleration that counts."""

ACCELERATION_QUANTILE = 0.95

ACCELERATIONS = (220.0, 320.0)
"""Radians per second squared: recordings of people stay below the first, and above the second it is certainly noise."""

EXCESSES = (0.10, 0.14)
"""Power at 7 to 9 Hz over that at 0.4 to 3 Hz: clean motion has about 0.1."""

SHAPES = (0.15, 0.25)
"""Power at 7 to 9 Hz over that at 3 to 5 Hz: what swings quickly and regularly is below."""

WHITE = 1.4
"""Power at 11 to 15 Hz over that at 7 to 9 Hz, from which noise is white: left to the method for white noise."""

CUTOFFS = (6.5, 7.5)
"""Hertz: lowest and highest cut-off. Lower ones flatten peaks, and estimate withheld measurements worse than a straight line does."""


def tracker_noise(q: Reals, fps: float) -> Reals:
    """Measure whether a clip jitters as estimates from video do, and where a filter should cut it off.

    Spectra of the angular velocity in Hann windows of `SECONDS` that overlap by half give, as medians over joints and windows, the excess
    `E`, the shape, and the whiteness; and the acceleration is the median over the joints of a quantile. With the ramp `R(x; a, b)` from 0 at
    `a` to 1 at `b`,

        `u = R(acceleration; 220, 320) · R(E; .10, .14) · R(shape; .15, .25)`,    0 where the noise is white.

    Clean motion falls as `f^−1.45`, white excess grows as `f²`; they cross at `(123 / (E − .096))^(1/3.45)` Hz. A doubtful `u` moves
    the cut-off up: `f_c = clip(…, 6.5, 7.5) · u^−.29`.

    Parameters
    ----------
    q : array (frames, joints, 4)
    fps : float, hertz

    Returns
    -------
    array (6,)
        `u`, the cut-off in hertz, acceleration, excess, shape and whiteness; zeros for clips that are too short or too slow to tell.
    """
    every = max(int(fps / RATE + 0.5), 1)
    rate = fps / every
    velocity = increments(q[::every]) * rate
    length = int(SECONDS * rate + 0.5)
    bands = [bins(band, length, rate) for band in (LOW, MIDDLE, HIGH, TOP)]
    if len(velocity) < length or min(map(len, bands)) == 0:
        return np.zeros(6)
    ratios = [
        window_ratios(velocity[start : start + length], bands)
        for start in range(0, len(velocity) - length + 1, max(length // 2, 1))
    ]
    found = np.concatenate(ratios)
    strength = acceleration(velocity, rate)
    if len(found) == 0 or strength == 0:
        return np.zeros(6)
    excess, shape, white = (middle(column) for column in found.T)
    u = ramp(strength, *ACCELERATIONS) * ramp(excess, *EXCESSES) * ramp(shape, *SHAPES)
    if white > WHITE:
        u = 0.0
    cutoff = np.clip((123 / max(excess - 0.096, 1e-9)) ** (1 / 3.45), *CUTOFFS)
    if u > 0:
        cutoff *= u**-0.29
    return np.array([u, cutoff, strength, excess, shape, white])


def bins(band: tuple[float, float], length: int, rate: float) -> Reals:
    """Return the frequencies of a window's transform in a band, in cycles per frame."""
    frequencies = np.arange(length // 2 + 1) / length
    return np.asarray(frequencies[(frequencies * rate >= band[0]) & (frequencies * rate <= band[1])])


def window_ratios(velocity: Reals, bands: list[Reals]) -> Reals:
    """Return excess, shape and whiteness of the joints that are there and move in a window `(length, joints, 3)`; `(n, 3)`."""
    length = len(velocity)
    speed = np.sqrt(np.mean(np.sum(velocity**2, axis=-1), axis=0))
    chosen = np.isfinite(speed) & (speed > FASTEST)
    values = velocity[:, chosen]
    hann = np.sin(np.pi * (np.arange(length) + 0.5) / length) ** 2
    values = (values - values.mean(axis=0)) * hann[:, None, None]
    low, medium, high, top = (power(values, band) for band in bands)
    return np.stack([high / low, high / medium, top / high], axis=1)


def power(values: Reals, frequencies: Reals) -> Reals:
    """Mean power of windowed vectors `(length, joints, 3)` at frequencies in cycles per frame; `(joints,)`."""
    angles = 2 * np.pi * np.outer(frequencies, np.arange(len(values)))
    parts = [np.tensordot(wave, values, axes=1) for wave in (np.cos(angles), np.sin(angles))]
    return np.asarray(np.mean(np.sum(parts[0] ** 2 + parts[1] ** 2, axis=-1), axis=0))


def acceleration(velocity: Reals, rate: float) -> float:
    """Lower median over the moving joints of a quantile of the angular acceleration, radians per second squared."""
    found = []
    for joint in range(velocity.shape[1]):
        own = velocity[:, joint]
        there = own[np.isfinite(own[:, 0])]
        steps = np.linalg.norm(np.diff(own, axis=0), axis=-1) * rate
        steps = np.sort(steps[np.isfinite(steps)])
        if len(steps) and np.sqrt(np.mean(np.sum(there**2, axis=-1))) > RESTLESS:
            found.append(steps[int(ACCELERATION_QUANTILE * (len(steps) - 1))])
    return middle(np.array(found)) if found else 0.0


def middle(values: Reals) -> float:
    """Lower median."""
    return float(np.sort(values)[(len(values) - 1) // 2])


def ramp(x: float, low: float, high: float) -> float:
    """Return 0 below `low`, 1 above `high`, and a straight line between."""
    return float(np.clip((x - low) / (high - low), 0, 1))
