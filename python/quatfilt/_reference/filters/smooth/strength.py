"""How much to smooth: read off the spectra of blocks of the clip, by Stein's unbiased risk estimate."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from quatfilt._reference._arrays import Reals

BLOCK = 512
"""Frames of a block, at most: long enough for the slowest cut-off, short enough for what a body does to change."""

ORDERS = (1, 2, 3)
"""Orders of the differences that may be penalised."""

CUTOFFS = 18
"""How many cut-offs are tried for each order."""

SOFTEST = 64.0
"""The largest cut-off, as a square of frequency: with it hardly anything is smoothed."""

STIFFEST = 1e-10
"""The least softness: below it the equations of the smoother lose their digits."""

FINE_BINS = 8
"""Frequencies that have a bin of their own; after them each bin is wider than the one before by `BIN_GROWTH`."""

BIN_GROWTH = 1.125

TEMPERATURE = 8.0
"""What differences of the risk are divided by. Of two estimates whose risks differ by less than some noise variances, the data
cannot say which is better; averaged with the weights `exp(−risk / 4)` or flatter ones, their mean is nearly as good as the
best (Leung and Barron 2006)."""

LIKELIHOOD = 0.4
"""Share of the logarithm of the marginal likelihood beside the risk. Where few frequencies stand out of the noise, the risk
alone varies too much from clip to clip."""

SHARED = 0.5
"""By how much all blocks together have a say in each of them."""


@dataclass(frozen=True)
class Strength:
    """What is penalised, and how strongly, for one column."""

    order: int
    cutoff: Reals
    """`f`, a square of frequency in (radians per frame)², `(frames,)`; the softness is `fᵒ`."""


@dataclass(frozen=True)
class Candidates:
    """All combinations of an order and a cut-off, for one length of a block.

    A sine of the frequency `ω` has `h = 1 / (1 + (μ/f)ᵒ)` of its amplitude left, `μ = 2 − 2 cos ω`.
    """

    cutoffs: Reals
    """`(orders, CUTOFFS)`."""
    edges: NDArray[np.intp]
    """First frequency of each bin, and the number of all."""
    removed: Reals
    """Mean of `1 − h` over each bin, `(orders, CUTOFFS, bins)`."""
    removed_squared: Reals
    """Mean of `(1 − h)²`."""
    freedom: Reals
    """`Σ h` over all frequencies, `(orders, CUTOFFS)`."""
    log_removed: Reals
    """`Σ log(1 − h)`."""


def candidates(block: int) -> Candidates:
    """Return all combinations for blocks of so many frames."""
    mu = 2 - 2 * np.cos(np.pi * np.arange(block) / block)
    # The mean of a block moves too: it counts as a quarter of the lowest frequency.
    mu[0] = mu[1] / 4
    cutoffs = np.stack(
        [np.geomspace(max(mu[0], STIFFEST ** (1 / order)), SOFTEST, CUTOFFS) for order in ORDERS]
    )
    ratio = mu / cutoffs[..., None]
    removed = np.stack([one**order / (1 + one**order) for one, order in zip(ratio, ORDERS, strict=True)])
    edges = list(range(min(FINE_BINS, block) + 1))
    while edges[-1] < block:
        edges.append(min(block, max(edges[-1] + 1, int(edges[-1] * BIN_GROWTH))))
    bins = np.array(edges)
    width = np.diff(bins)
    return Candidates(
        cutoffs,
        bins,
        np.add.reduceat(removed, bins[:-1], axis=-1) / width,
        np.add.reduceat(removed**2, bins[:-1], axis=-1) / width,
        np.sum(1 - removed, axis=-1),
        np.sum(np.log(removed), axis=-1),
    )


def strength(z: Reals) -> Strength:
    """Choose order and cut-offs for a column of unit noise, `(frames,)`, at least two.

    In each block the cosine transform `c` of the column says how large the risk of each candidate is, and how likely the column
    if its differences were white noise:

        `risk = Σ_k (1 − h_k)² c_k² + 2 Σ_k h_k`,      `−2 log likelihood = Σ_k (1 − h_k) c_k² − Σ_k log(1 − h_k)`.

    Candidates are weighed by `exp(−risk / TEMPERATURE + LIKELIHOOD · log likelihood)`. The order is that with the most weight over
    the whole column; with it, each block takes the weighted mean of the logarithms of the cut-offs, and between the centres of
    blocks they are interpolated.
    """
    frames = len(z)
    block = min(BLOCK, 2 ** int(np.log2(frames)))
    found = candidates(block)
    starts = block_starts(frames, block)
    scores = np.stack([block_scores(z[start : start + block], found) for start in starts])
    mean = scores.mean(axis=0)
    whole = mean * (frames / block)
    order = int(np.argmax(np.sum(np.exp(whole.min() - whole), axis=-1)))
    logs = np.log(found.cutoffs[order])
    settled = [weighted(logs, own) for own in scores[:, order] + SHARED * mean[order]]
    if len(starts) == 1:
        settled = [weighted(logs, whole[order])]
    centres = np.array(starts) + (block - 1) / 2
    cutoff = np.exp(np.interp(np.arange(frames), centres, settled))
    return Strength(ORDERS[order], cutoff)


def block_starts(frames: int, block: int) -> list[int]:
    """First frames of blocks that overlap by half; the last one ends with the clip."""
    starts = list(range(0, frames - block + 1, max(block // 2, 1)))
    if starts[-1] != frames - block:
        starts.append(frames - block)
    return starts


def block_scores(z: Reals, found: Candidates) -> Reals:
    """Return what speaks against each candidate in one block, `(orders, CUTOFFS)`."""
    power = cosine_transform(z - z.mean()) ** 2
    bins = np.add.reduceat(power, found.edges[:-1])
    risk = found.removed_squared @ bins + 2 * found.freedom
    minus_log_likelihood = (found.removed @ bins - found.log_removed) / 2
    return np.asarray(risk / TEMPERATURE + LIKELIHOOD * minus_log_likelihood)


def cosine_transform(x: Reals) -> Reals:
    """Orthonormal discrete cosine transform (type II)."""
    n = len(x)
    angles = np.pi * np.outer(np.arange(n), 2 * np.arange(n) + 1) / (2 * n)
    scale = np.where(np.arange(n) == 0, np.sqrt(1 / n), np.sqrt(2 / n))
    return np.asarray(scale * (np.cos(angles) @ x))


def weighted(values: Reals, scores: Reals) -> float:
    """Mean of values weighted by `exp(−score)`."""
    weights = np.exp(scores.min() - scores)
    return float(weights @ values / weights.sum())
