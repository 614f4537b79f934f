"""Coloured noise: how strongly the noise of one frame depends on that of the frame before."""

import math

import numpy as np

from quatfilt._reference._arrays import Reals
from quatfilt._reference.noise.noise import increments

WINDOW = 128
"""Increments under a Hann window, at most; the next window begins half of it later."""

SHORTEST = 64
"""Frames: shorter clips show too few frequencies."""

BAND = 0.06, 0.98
"""Least and largest frequency that is looked at, as a share of half the frame rate."""

CANDIDATES = 20
"""Values of `ρ`: 0, 0.05 … 0.95."""

CANDIDATE_STEP = 0.05

MOTIONS = 0.0, *np.geomspace(1e-3, 1e2, 16)
"""Shares of motion that are tried for each column."""

LEAST_POWER = 1e-10
"""Radians²: columns with a spectrum below it hold rounding, not noise."""

LEAST_COLOUR = 0.12
"""`ρ` below it is chance: white noise."""


def noise_colour(q: Reals) -> float:
    """Estimate `ρ` of noise that follows `n_{t+1} = ρ n_t + e_t`, the same for all joints: 0 for white noise.

    Each coordinate of each joint has the periodogram of its increments, the median over Hann windows, over `2 − 2 cos ω`: the
    spectrum `S(ω)` of noise and motion. Noise and motion that is accelerated at random have

        `l (g(ω) + a (2 − 2 cos ω)⁻²)`,    `g(ω) = 1 / (1 + ρ² − 2ρ cos ω)`,

    and Whittle's likelihood of it is `−Σ_ω ln(l f) + S / (l f)`, with the best `l`, the mean of `S / f`, and the best `a` of 17 for
    each column. The sum over all columns decides on `ρ`; the vertex of a parabola through three candidates refines it.

    Windows that touch a missing sample are left out.

    Parameters
    ----------
    q : array (frames, joints, 4)
    """
    if len(q) < SHORTEST:
        return 0.0
    steps = increments(q).reshape(len(q) - 1, -1)
    length = min(WINDOW, len(steps))
    mask = np.sin(np.pi * np.arange(1, length + 1) / (length + 1)) ** 2
    starts = range(0, len(steps) - length + 1, length // 2)
    frequencies = 2 * np.pi * np.arange(length // 2 + 1) / length
    seen = np.flatnonzero((frequencies >= BAND[0] * np.pi) & (frequencies <= BAND[1] * np.pi))
    omega = frequencies[seen]
    roughness = 2 - 2 * np.cos(omega)
    models = [1 / (1 + rho**2 - 2 * rho * np.cos(omega)) for rho in CANDIDATE_STEP * np.arange(CANDIDATES)]
    total = np.zeros(CANDIDATES)
    for column in steps.T:
        windows = [column[start : start + length] for start in starts]
        powers = [
            np.abs(np.fft.rfft(mask * window)[seen]) ** 2 for window in windows if np.isfinite(window).all()
        ]
        if not powers:
            continue
        spectrum = np.median(powers, axis=0) / roughness / np.sum(mask**2)
        if spectrum.min() < LEAST_POWER:
            continue
        total += [misfit(spectrum, model, roughness**-2.0) for model in models]
    best = int(np.argmin(total))
    colour = CANDIDATE_STEP * (best + vertex(total, best))
    return colour if colour >= LEAST_COLOUR else 0.0


def misfit(spectrum: Reals, noise: Reals, motion: Reals) -> float:
    """Return the least of Whittle's negative log likelihood of a spectrum over the shares of motion, but for a constant."""
    return min(
        float(np.sum(np.log(noise + share * motion)))
        + len(spectrum) * math.log(np.mean(spectrum / (noise + share * motion)))
        for share in MOTIONS
    )


def vertex(values: Reals, best: int) -> float:
    """Where the parabola through a minimum and its neighbours has its vertex, in steps from it; 0 at an end."""
    if not 0 < best < len(values) - 1:
        return 0.0
    before, here, after = values[best - 1 : best + 2]
    bend = before - 2 * here + after
    return float((before - after) / (2 * bend)) if bend > 0 else 0.0
