"""The learned last step of automatic smoothing: gains of scales, from a small network that reads local powers.

The pilot still holds noise, and has lost motion. In which scale, and how much, depends on powers that can be measured: those of the
residual, of the pilot's motion, and of the differences between the estimates before it. A network trained on other people's recordings
maps them to a gain for each scale.
"""

import itertools

import numpy as np

from quatfilt._reference._arrays import Reals
from quatfilt._reference.filters.development import developed_about, undevelop
from quatfilt._reference.rotations.quaternion import between, log_short, normalize

CELL = 4
"""Frames that share a gain; between the centres of cells gains are interpolated."""

SCALES = 6
"""Number of differences of scales of the residual and of the pilot. The widest mask has a deviation of 37 frames."""

FINE, COARSE = 2, 4
"""Scales between which differences of estimates are divided: deviations of 2.2 and 9.2 frames."""

ESTIMATES = 2
"""Displacements to estimates: the result of patches, and the samples along the strongest axes of the body."""

BASES_OF_REST = SCALES + 1
"""Basis vectors of the residual; those of the pilot follow, and then those of the estimates."""

BASES = 2 * SCALES + 1 + 3 * ESTIMATES
"""Vectors that gains are given to, 19."""

GATES = 5 * BASES + SCALES
"""Powers that the network reads, 101."""

SHORT = (1, 1, 1, 2, 3, 4, 4, *(1, 1, 1, 2, 3, 4), *(1, 2, 3) * ESTIMATES)
"""Scale over cells of the mean power of each basis vector."""

WIDE = (2, 2, 3, 4, 5, 5, 5, *(2, 2, 3, 4, 5, 5), *(3, 4, 5) * ESTIMATES)
"""Scale over cells of the wide mean power."""

AXES = 12
"""Strongest axes of the body on which the displacement to the samples is projected; at most one for each joint."""

WIDEST = 512
"""Columns of all joints, at most, whose axes are looked for; with more the projection is 0."""

FEWEST = 128
"""Frames of a clip, at least. In shorter ones the pilot stays."""

LEAST_NOISE = 1e-6
"""Radians per component below which a joint has no noise: little more than roundings in float32."""

LEAST_POWER = 1e-4
"""Added to powers before their logarithm, in units of the noise's variance: an amplitude of a hundredth of the noise."""

LOGARITHM = 0.4
"""Factor of the logarithms: brings gates to about unit variance."""

LARGEST = 80.0
"""Arguments of the exponential are cut off here: float32 holds no larger results."""

LEAST_NORM = 1e-6
"""Added to the power of the pilot where the residual is divided by its norm."""


def smooth_gains(
    q: Reals,
    patches: Reals,
    pilot: Reals,
    confidence: Reals | None,
    noise: Reals,
    share: float,
    first: Reals,
    second: Reals,
    last: Reals,
) -> Reals:
    """Correct the pilot by vectors of several scales, with gains from a network.

    Parameters
    ----------
    q : array (frames, joints, 4)
        Noisy rotations without missing samples.
    patches : array (frames, joints, 4)
        The result of `smooth_patches`.
    pilot : array (frames, joints, 4)
        The result of `smooth_rank`.
    confidence : array (frames, joints) or None
        Factors of the displacements from the pilot to the samples, from 0 to 1.
    noise : array (joints,), float64, radians
        Deviation of the noise per component of the rotation vector. Joints with less than `LEAST_NOISE` stay as the pilot has
        them, and are not seen by the others.
    share : float
        Factor of the correction, from 0 to 1.
    first : array (GATES + 1, units)
        Weights of the first layer; the last row is the bias, here and below.
    second : array (units + 1, units)
    last : array (units + 1, BASES)

    Returns
    -------
    array (frames, joints, 4)
        Unit quaternions, continuous in sign from the hemisphere of the first frame of `q`.
    """
    noisy = np.flatnonzero(noise >= LEAST_NOISE)
    path, about = (normalize(x.astype(np.float64)) for x in (q, pilot))
    moved = np.zeros((*q.shape[:2], 3))
    if len(q) < FEWEST or len(noisy) == 0:
        return undevelop(q, about, moved, moved)
    scale = noise[noisy, None]
    clean = developed_about(about[:, noisy], about[:, noisy])[1] / scale

    def beside(estimate: Reals) -> Reals:
        estimate = normalize(estimate.astype(np.float64))
        return 2 * log_short(between(about[:, noisy], estimate[:, noisy])) / scale

    rest = beside(path)
    if confidence is not None:
        rest = confidence[:, noisy, None] * rest
    estimates = [beside(patches), along_body(clean, rest)]
    axes = joint_axes(clean)
    found = basis(turned(clean, axes), turned(rest, axes), [turned(estimate, axes) for estimate in estimates])
    gains = interpolated(network(gates(found), first, second, last), len(q))
    correction = turned(np.sum(gains * found, axis=-1), axes.swapaxes(1, 2))
    moved[:, noisy] = share * correction * scale
    return undevelop(q, about, np.zeros_like(moved), moved)


def along_body(clean: Reals, rest: Reals) -> Reals:
    """Project the residual, `(frames, joints, 3)`, on the strongest principal axes of the steps of all joints.

    The axes are the eigenvectors of `Σ ΔP ΔPᵀ` with the largest eigenvalues.
    """
    frames, joints = clean.shape[:2]
    if 3 * joints > WIDEST:
        return np.zeros_like(rest)
    steps = np.diff(clean.reshape(frames, -1), axis=0)
    axes = np.linalg.eigh(steps.T @ steps)[1][:, -min(AXES, joints) :]
    return np.asarray((rest.reshape(frames, -1) @ axes @ axes.T).reshape(rest.shape))


def joint_axes(clean: Reals) -> Reals:
    """Principal axes of the steps of each joint, as columns; `(joints, 3, 3)`."""
    steps = np.diff(clean, axis=0)
    return np.asarray(np.linalg.eigh(np.einsum("tja,tjb->jab", steps, steps))[1])


def turned(vectors: Reals, axes: Reals) -> Reals:
    """Components of vectors `(frames, joints, 3)` along the axes of their joint."""
    return np.asarray(np.einsum("tja,jab->tjb", vectors, axes))


def basis(clean: Reals, rest: Reals, estimates: list[Reals]) -> Reals:
    """Return the vectors that gains are given to, `(frames, joints, 3, BASES)`.

    Parameters
    ----------
    clean : array (frames, joints, 3)
        `P`, the development of the pilot in units of the noise.
    rest : array (frames, joints, 3)
        `X`, from the pilot to the samples. White noise has variance 1 in each of its scales.
    estimates : list of arrays (frames, joints, 3)
        `E`, from the pilot to other estimates.
    """
    beyond = 2 ** (SCALES + 1)
    around = np.pad(rest, [(beyond, beyond), (0, 0), (0, 0)])
    of_rest = [scale[beyond:-beyond] for scale in scales(around, SCALES)]
    bands = [a - b for a, b in itertools.pairwise(of_rest)]
    result = [band / norm for band, norm in zip([*bands, of_rest[-1]], rest_norms(), strict=True)]
    result += [a - b for a, b in itertools.pairwise(scales(clean, SCALES))]
    for estimate in estimates:
        found = scales(estimate, COARSE)
        result += [estimate - found[FINE], found[FINE] - found[COARSE], found[COARSE]]
    return np.stack(result, axis=-1)


def scales(values: Reals, count: int) -> list[Reals]:
    """Return values along time, and `count` versions of them, each smoother than the one before.

    The mask of the scale `k` is (1, 4, 6, 4, 1) / 16 with steps of `2ᵏ⁻¹` samples: a cubic spline, close to a Gaussian of deviation
    `√((4ᵏ − 1) / 3)` of the values. Beyond both ends they are mirrored.
    """
    result = [values]
    size = len(values)
    for k in range(count):
        step = 2**k
        beyond = [(2 * step, 2 * step)] + [(0, 0)] * (values.ndim - 1)
        around = np.pad(result[-1], beyond, mode="symmetric")
        taps = [around[i * step : i * step + size] for i in range(5)]
        result.append((taps[0] + taps[4] + 4 * (taps[1] + taps[3]) + 6 * taps[2]) / 16)
    return result


def rest_norms() -> list[float]:
    """Norms of the impulse responses of the residual's scales."""
    impulse = np.zeros(2 ** (SCALES + 2))
    impulse[len(impulse) // 2] = 1
    found = scales(impulse, SCALES)
    return [float(np.linalg.norm(a - b)) for a, b in itertools.pairwise([*found, np.zeros_like(impulse)])]


def gates(found: Reals) -> Reals:
    """Return what the network reads, `(cells, joints, 3, GATES)`.

    With `S` for the mean power of a basis vector over cells and scales of them, and `l(v)` for `LOGARITHM · ln(v + LEAST_POWER)`, these are for
    each basis vector: half of `l` of the cell's power, `l(S)`, `l` of the wide mean; then the residual along the pilot, for each of their
    differences of scales; then for each basis vector `l` of the sum of `S` over the axes of the joint, and of the mean of `S` over all columns.
    """
    powers = [scales(cell_means(found[..., k] ** 2), WIDE[k]) for k in range(BASES)]
    short = [power[SHORT[k]] for k, power in enumerate(powers)]
    result: list[Reals] = [logarithm(power[0]) / 2 for power in powers]
    result += [logarithm(mean) for mean in short]
    result += [logarithm(power[-1]) for power in powers]
    for k in range(SCALES):
        of_pilot = BASES_OF_REST + k
        product = cell_means(found[..., k] * found[..., of_pilot])
        along = scales(product, SHORT[k])[-1]
        result.append(along / np.sqrt(short[of_pilot] + LEAST_NORM))
    result += [logarithm(np.broadcast_to(mean.sum(axis=2, keepdims=True), mean.shape)) for mean in short]
    result += [
        logarithm(np.broadcast_to(mean.mean(axis=(1, 2), keepdims=True), mean.shape)) for mean in short
    ]
    return np.stack(result, axis=-1)


def cell_means(values: Reals) -> Reals:
    """Means over cells of `CELL` frames; the last cell may have fewer."""
    starts = np.arange(0, len(values), CELL)
    counts = np.diff([*starts, len(values)])
    sums = np.add.reduceat(values, starts, axis=0)
    return np.asarray(sums / counts.reshape(-1, *[1] * (values.ndim - 1)))


def logarithm(power: Reals) -> Reals:
    """Return `LOGARITHM · ln(v + LEAST_POWER)`."""
    return np.asarray(LOGARITHM * np.log(power + LEAST_POWER))


def network(inputs: Reals, first: Reals, second: Reals, last: Reals) -> Reals:
    """Return the gains: `h₁ = silu(g A + a)`, `h₂ = h₁ + silu(h₁ B + b)`, `h₂ C + c`, along the last axis."""
    hidden = silu(affine(inputs, first))
    hidden = hidden + silu(affine(hidden, second))
    return affine(hidden, last)


def affine(x: Reals, weights: Reals) -> Reals:
    """Product with all rows of the weights but the last, which is added."""
    return np.asarray(x @ weights[:-1].astype(np.float64) + weights[-1])


def silu(x: Reals) -> Reals:
    """Return `x / (1 + exp(−x))`."""
    return np.asarray(x / (1 + np.exp(-np.maximum(x, -LARGEST))))


def interpolated(gains: Reals, frames: int) -> Reals:
    """Gains of frames, linear between the centres of cells and constant beyond the first and the last."""
    position = np.clip((np.arange(frames) + 0.5) / CELL - 0.5, 0, len(gains) - 1)
    before = np.minimum(position.astype(np.intp), max(len(gains) - 2, 0))
    part = (position - before).reshape(-1, *[1] * (gains.ndim - 1))
    return np.asarray((1 - part) * gains[before] + part * gains[np.minimum(before + 1, len(gains) - 1)])
