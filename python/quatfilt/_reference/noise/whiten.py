"""Whitening: vectors whose noise is alike in time and direction, and back."""

import numpy as np

from quatfilt._reference._arrays import Reals
from quatfilt._reference.rotations.quaternion import between, exp, log_short, multiply, normalize


def whiten(
    reference: Reals, development: Reals, vectors: Reals, colour: float, spread: Reals, axes: Reals
) -> tuple[Reals, Reals, Reals]:
    """Turn developed rotations with coloured noise, or noise that differs between axes, into ones with white noise.

    With `W = V diag(1/s) Vᵀ` vectors become `u_t = W (y_t − ρ y_{t−1})` and `u_0 = (1 − ρ) W y_0`; the development becomes `U_t` in the same
    way, and the reference path `p_0 = r_0`, `p_{t+1} = p_t exp((U_{t+1} − U_t) / 2)`. A filter for white noise sees the rotations
    `p_t exp((u_t − U_t) / 2)`. Noise `n_{t+1} = ρ n_t + e_t` is `W e_t` there, and the best gain of a filter at each frequency is the same as
    that for the noise and motion before.

    Parameters
    ----------
    reference : array (frames, joints, 4)
        `r`, from :func:`.development.develop`.
    development, vectors : array (frames, joints, 3)
        `R` and `y`, in radians.
    colour : float
        `ρ`, at least 0 and below 1.
    spread : array (joints, 3)
        `s`, above 0.
    axes : array (joints, 3, 3)
        `V`, with the axes as columns.

    Returns
    -------
    reference : array (frames, joints, 4)
        `p`.
    development, vectors : array (frames, joints, 3)
        `U` and `u`.
    """
    weights = np.einsum("jik,jk,jlk->jil", axes, 1 / spread, axes)
    flat, white = (innovations(x, colour, weights) for x in (development, vectors))
    path = reference.copy()
    for t in range(1, len(path)):
        path[t] = normalize(multiply(path[t - 1], exp((flat[t] - flat[t - 1]) / 2)))
    return path, flat, white


def innovations(vectors: Reals, colour: float, weights: Reals) -> Reals:
    """`W (y_t − ρ y_{t−1})`, and `(1 − ρ) W y_0`."""
    before = np.concatenate([vectors[:1], vectors[:-1]])
    return np.asarray(np.einsum("jik,tjk->tji", weights, vectors - colour * before))


def unwhiten(
    q: Reals, reference: Reals, development: Reals, colour: float, spread: Reals, axes: Reals
) -> Reals:
    """Return the vectors `y` about the first reference path of filtered white ones: the inverse of `whiten`.

    Parameters
    ----------
    q : array (frames, joints, 4)
        Filtered rotations about `p`.
    reference : array (frames, joints, 4)
        `p`, from `whiten`.
    development : array (frames, joints, 3)
        `U`, from `whiten`.
    colour, spread, axes
        As for `whiten`.

    Returns
    -------
    array (frames, joints, 3), float64, radians
        `y_0 = W⁻¹ u_0 / (1 − ρ)`, `y_t = ρ y_{t−1} + W⁻¹ u_t`.
    """
    weights = np.einsum("jik,jk,jlk->jil", axes, spread, axes)
    white = development + 2 * log_short(between(reference, normalize(q.astype(np.float64))))
    result = np.asarray(np.einsum("jik,tjk->tji", weights, white))
    result[:1] /= 1 - colour
    for t in range(1, len(result)):
        result[t] += colour * result[t - 1]
    return result
