"""Noise as filters use it: measured on a checked clip."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from quatfilt._backend import ops
from quatfilt._typing import Array, Mask

_BLOCKS, _BLOCK_FRAMES = 16, 512
"""Colour, axes and evidence of longer clips are measured on so many blocks of so many frames."""

_HELD = 0.9
"""Share of the moving joints that repeat where a whole frame does."""

_QUIET = 0.25
"""Quantile over time of the variance that stands for the quiet part."""

_LOUD = 0.9
"""Quantile over time of the variance that stands for the noisiest part."""

_STILL_QUIET = 2.0
"""Frames with up to this many times the variance of the quiet part belong to it, and with down to one over it of the noisiest."""

_DOUBTFUL, _CERTAIN = 0.33, 0.5
"""Level over speed, see ``noise_over_motion``: below the first it may be motion, from the second on it is noise."""

_SLOW_RATE, _SHORTER_FRAMES = 60.0, 0.75
"""Hertz, exponent: up to this frame rate clean motion leaves as much as that, beyond it a power of the frame's length: 0.2 at 120 hertz."""

_LEAST_COLOUR = 0.2
"""Smaller coefficients are no colour: beside weak noise motion reads as up to 0.17, and whitening less gains nothing."""

_ROUND = 2.0
"""Largest ratio of the deviations along two axes of noise that counts as alike in all directions."""

_UNROUND_SHARE = 0.3
"""Share of the joints that have to be unlike in their directions."""

_WRAPPING = 0.5
"""Radians: joints with a higher level are left out of colour and axes, which show how increments wrap rather than the noise."""

_ORDERS = (4, 6, 8)
"""Orders of the differences that levels are read off."""


@dataclass(frozen=True)
class Measured:
    """What is known of the noise of a clip."""

    repeated: Mask
    """``(frames, joints)``: samples that equal the one before, of joints that move at all."""
    white: NDArray[np.float64]
    """``(joints,)``, radians: level of the differences, as if the noise were white and steady."""
    quiet: NDArray[np.float64]
    """``(joints,)``, radians: level of the differences where the variance is 1."""
    loud: NDArray[np.float64]
    """``(joints,)``, radians: the same, from the frames with the most noise."""
    variance: NDArray[np.float64]
    """``(frames,)``: variance along time; 1 in the quiet part."""
    evidence: float
    """From 0, the noise may be motion, to 1."""
    colour: float
    """``ρ``; 0 for white noise."""
    spread: NDArray[np.float64]
    """``(joints, 3)``: deviations along the axes, with the mean square 1."""
    axes: NDArray[np.float64]
    """``(joints, 3, 3)``: the axes as columns."""

    @property
    def level(self) -> NDArray[np.float64]:
        """Deviation per component over the whole clip, ``(joints,)``, radians."""
        return np.asarray(_over_time(self.loud, self.variance) / math.sqrt(share_of_differences(self.colour)))

    @property
    def steady(self) -> bool:
        """Whether the variance is the same at all frames."""
        return bool((self.variance == 1).all())

    @property
    def round(self) -> bool:
        """Whether a filter may take the noise for alike in all directions."""
        noisy = self.white > 0
        ratio = self.spread[noisy, 2] / self.spread[noisy, 0]
        return self.evidence <= 0.5 or not noisy.any() or float((ratio > _ROUND).mean()) <= _UNROUND_SHARE


def measure(q: Array, *, fps: float = 1.0) -> Measured:
    """Measure the noise of rotations ``(frames, joints, 4)``, with NaN or zeros where samples are missing; 1 is an unknown frame rate."""
    repeated = ops().find_repeats(q)
    known = np.isfinite(q).all(axis=-1) & (q != 0).any(axis=-1)
    moving = (known & ~repeated).sum(axis=0) > 1
    repeated &= moving
    there = (known & moving).sum(axis=1)
    fresh = repeated.sum(axis=1) < np.maximum(_HELD * there, 1)
    new = q
    if repeated.any():
        new = q.copy()
        new[repeated] = np.nan
        new = np.ascontiguousarray(new[fresh])
    white = ops().noise_level(_compacted(new, repeated[fresh]))
    variance = ops().noise_along_time(new, white)
    quiet = loud = white.astype(np.float64)
    part = sample = _sample(new)
    ratio = 0.0
    if (variance != 1).any():
        quiet = _level_where(new, variance <= _STILL_QUIET * np.quantile(variance, _QUIET), variance, quiet)
        noisy = variance >= np.quantile(variance, _LOUD) / _STILL_QUIET
        loud = _level_where(new, noisy, variance, quiet)
        variance, loud = _stretched(variance, quiet, loud, noisy)
        part = _only(new, noisy)
        ratio = ops().noise_over_motion(_sample(part), ops().noise_level(part))
    over_time = _over_time(loud, variance).astype(q.dtype)
    evidence = _evidence(ops().noise_over_motion(sample, over_time), fps)
    if _evidence(ratio, fps) > evidence:
        # Where noise is larger than motion for a while, it is noise, whatever the rest of the clip is.
        evidence = _evidence(ratio, fps)
        sample = _sample(part)
    if evidence == 0:
        # Impacts and spins come and go too.
        variance = np.ones(len(new))
        quiet = loud = white.astype(np.float64)
    wraps = white > _WRAPPING
    colour = evidence * ops().noise_colour(np.ascontiguousarray(sample[:, ~wraps])) if evidence > 0 else 0.0
    spread, axes = ops().noise_axes(sample)
    spread[wraps], axes[wraps] = 1.0, np.eye(3)
    return Measured(
        repeated,
        white.astype(np.float64),
        quiet,
        loud,
        variance[np.maximum(np.cumsum(fresh) - 1, 0)] if len(new) != len(q) else variance,
        evidence,
        colour if colour >= _LEAST_COLOUR else 0.0,
        spread,
        axes,
    )


def share_of_differences(colour: float) -> float:
    """Return the part of the variance of coloured noise that its differences show, 1 for white noise.

    Of noise with the autocorrelation ``ρ^|k|`` differences of order n have the variance ``Σ_k (−1)^k C(2n, n+k) ρ^|k|``, over
    ``C(2n, n)`` of white noise; the least of the orders counts, as in the level.
    """
    shares = [
        sum((-1.0) ** k * math.comb(2 * n, n + k) * colour ** abs(k) for k in range(-n, n + 1))
        / math.comb(2 * n, n)
        for n in _ORDERS
    ]
    return float(min(shares))


def _level_where(
    q: Array, here: Mask, variance: NDArray[np.float64], otherwise: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return the level where the variance is 1, measured on some of the frames."""
    found = ops().noise_level(_only(q, here)).astype(np.float64) / math.sqrt(variance[here].mean())
    return np.where(found > 0, found, otherwise)


def _stretched(
    variance: NDArray[np.float64], quiet: NDArray[np.float64], loud: NDArray[np.float64], noisy: Mask
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Stretch the logarithm of the variance such that noisy frames have the level that was measured in them, and quiet ones theirs.

    Beside fast motion `noise_along_time` does not tell how quiet the quiet part is, and levels differ where the variance is 1.
    """
    both = (quiet > 0) & (loud > 0)
    if not both.any():
        return variance, loud
    more = 2 * max(float(np.median(np.log(loud[both] / quiet[both]))), 0.0)
    most = float(np.log(variance[noisy]).mean())
    if most <= 0:
        return variance, loud
    return np.asarray(variance ** (1 + more / most)), loud * math.exp(-more / 2)


def _only(q: Array, here: Mask) -> Array:
    """Return rotations that are missing at all other frames."""
    part = q.copy()
    part[~here] = np.nan
    return part


def _over_time(level: NDArray[np.float64], variance: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the root mean square over time of what has a level where the variance is 1."""
    return level * math.sqrt(variance.mean()) if len(variance) else level


def _evidence(ratio: float, fps: float) -> float:
    doubtful = _DOUBTFUL * min(_SLOW_RATE / fps, 1.0) ** _SHORTER_FRAMES
    if ratio <= doubtful:
        return 0.0
    return min(math.log(ratio / doubtful) / math.log(_CERTAIN / _DOUBTFUL), 1.0)


def _compacted(new: Array, repeated: Mask) -> Array:
    """Move the samples of joints that repeat some together: what is left of a held joint has no two frames in a row."""
    if not repeated.any():
        return new
    result = new.copy()
    for joint in np.flatnonzero(repeated.any(axis=0)):
        kept = new[~repeated[:, joint], joint]
        result[:, joint] = np.nan
        result[: len(kept), joint] = kept
    return result


def _sample(new: Array) -> Array:
    """Return all frames of a short clip, or evenly spaced blocks of a long one with a missing frame between them."""
    if len(new) <= _BLOCKS * _BLOCK_FRAMES:
        return new
    starts = np.linspace(0, len(new) - _BLOCK_FRAMES, _BLOCKS).astype(np.intp)
    result = np.full((_BLOCKS, _BLOCK_FRAMES + 1, *new.shape[1:]), np.nan, new.dtype)
    result[:, :-1] = new[starts[:, None] + np.arange(_BLOCK_FRAMES)]
    return result.reshape(-1, *new.shape[1:])


__all__ = ["Measured", "measure", "share_of_differences"]
