"""Noise that comes and goes: its variance along time."""

import math

import numpy as np

from quatfilt._reference._arrays import Reals
from quatfilt._reference.noise.motion import LEAST_LEVEL, mean_of_known, square_speeds, windowed_mean
from quatfilt._reference.noise.noise import increments

ORDER = 6
"""Order of the differences whose squares are local variances."""

REACH = 10
"""Frames on either side over which squares are averaged."""

SHORTEST = 84
"""Frames: four windows. Shorter clips have no quiet part to compare with."""

QUIET = 0.25
"""Quantile over time of a joint's local variance that stands for its quiet part."""

OF_MOTION = 0.5
"""Share of the local speed, in frames, that motion may leave in the differences: so much is no noise."""

LEAST_QUIET = 0.3
"""Share of the mean speed below which a quiet part is not told apart from a quieter one."""

PRIOR, PER_JOINT = 10.0, 42.0
"""Weights of a steady level and of what one joint shows in a window, in squares of differences."""

VARY, VARY_OF_ONE, VARY_RANGE = 0.2, 0.36, 0.2
"""Deviation of the logarithm of the variance below which noise is steady: 0.2, and `0.36/√joints` by chance; 0.2 above that it
counts in full."""


def noise_along_time(q: Reals, level: Reals) -> Reals:
    """Return the variance of the noise of all joints at each frame, in units of its quiet part; `(frames,)`, float64.

    For each joint `m_t` is the mean over 21 frames of `|Δ⁶|² / (3 C(12, 6))`, a local variance, and `s_t` that of the squared
    local speed. With `b` for the larger of the 25 % quantile of `m_t` and `(0.3)² mean s_t`,

        `e_t = max(m_t − (0.5)² s_t, 0) / b`,    `v_t = max(median over the joints of e_t, 1)`.

    Fast motion raises `m` and `s` together and is taken out; noise that a tracker adds to all joints is not. For few joints `v` is
    drawn towards 1: `v ← (42 J v + 10) / (42 J + 10)`. Where the deviation `d` of `ln v` over the clip is small, noise is steady: `v`
    is raised to the power of `(d − 0.2 − 0.36/√J) / 0.2`, from 0 to 1.

    Parameters
    ----------
    q : array (frames, joints, 4)
        Rotations; missing samples are left out.
    level : array (joints,), radians
        Noise level of each joint.
    """
    frames = len(q)
    noisy = np.flatnonzero(level >= LEAST_LEVEL)
    steady = np.ones(frames)
    if frames < SHORTEST or len(noisy) == 0:
        return steady
    steps = increments(q)[:, noisy]
    squares = np.full((frames, len(noisy)), np.nan)
    differences = np.diff(steps, n=ORDER - 1, axis=0)
    # The difference of order 6 that begins at frame t is centred at t + 3.
    squares[ORDER // 2 : frames - ORDER // 2] = np.mean(differences**2, axis=-1) / math.comb(2 * ORDER, ORDER)
    local = windowed_mean(squares, REACH)
    speed = np.full((frames, len(noisy)), np.nan)
    speed[1:] = square_speeds(steps)
    quiet = np.maximum(
        np.array([quantile(column[np.isfinite(column)], QUIET) for column in local.T]),
        LEAST_QUIET**2 * mean_of_known(speed),
    )
    excess = np.maximum(local - OF_MOTION**2 * windowed_mean(speed, REACH), 0) / quiet
    variance = np.ones(frames)
    for t in range(frames):
        known = excess[t, np.isfinite(excess[t])]
        if len(known):
            variance[t] = max(float(np.median(known)), 1.0)
    weight = PER_JOINT * len(noisy)
    logs = np.log((weight * variance + PRIOR) / (weight + PRIOR))
    surplus = float(np.std(logs)) - VARY - VARY_OF_ONE / math.sqrt(len(noisy))
    return np.asarray(np.exp(logs * min(max(surplus / VARY_RANGE, 0.0), 1.0)))


def quantile(values: Reals, share: float) -> float:
    """Quantile of values by linear interpolation between ranks; NaN of none."""
    return float(np.quantile(values, share)) if len(values) else math.nan
