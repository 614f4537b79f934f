"""Penalised least squares: numbers that are near the data, and whose differences of some order are small.

C. H. Reinsch, *Smoothing by Spline Functions*, 1967; E. T. Whittaker, *On a New Method of Graduation*, 1923.
"""

import math

import numpy as np

from quatfilt._reference._arrays import Reals
from quatfilt._reference.filters.smooth.strength import strength


def penalised_column(z: Reals, weights: Reals) -> Reals:
    """Smooth a column of unit noise `(frames,)`, at least two, as strongly as :func:`.strength.strength` asks for."""
    found = strength(z)
    rows = len(z) - found.order
    if rows < 1:
        return z
    # A difference of order o spans o + 1 frames; the cut-off is that of the middle one.
    middle = found.order // 2
    softness = found.cutoff[middle : middle + rows] ** found.order
    return penalised(z, weights, softness, found.order)


def penalised(z: Reals, weights: Reals, softness: Reals, order: int) -> Reals:
    """Minimise `Σ_t w_t (x_t − z_t)² + Σ_t (Δᵒx)_t² / s_t` over `x`.

    With `D` for the differences of order `o`, the minimum is

        `x = z − W⁻¹ Dᵀ u`,    `(S + D W⁻¹ Dᵀ) u = D z`:

    Reinsch's form. It takes away from the data what is too rough, and so returns polynomials of a degree below `o` as they
    are, however small the softness. The matrix has `o` bands to either side of its diagonal.

    Parameters
    ----------
    z : array (frames,)
        Data.
    weights : array (frames,)
        `w`, above 0.
    softness : array (frames − order,)
        `s`, above 0: the larger, the less is smoothed.
    order : int, at least 1
        `o`.

    Returns
    -------
    array (frames,)
    """
    bands = normal_bands(1 / weights, order)
    bands[0] += softness
    steps = np.array([(-1.0) ** (order - i) * math.comb(order, i) for i in range(order + 1)])
    u = solve(bands, np.diff(z, n=order))
    roughness = np.zeros_like(z)
    for i, step in enumerate(steps):
        roughness[i : i + len(u)] += step * u
    return np.asarray(z - roughness / weights)


def normal_bands(variances: Reals, order: int) -> Reals:
    """Diagonal and bands below it of `D V Dᵀ` for the diagonal `V`: row `k` holds the entries `(t + k, t)`."""
    rows = len(variances) - order
    steps = np.array([(-1.0) ** (order - i) * math.comb(order, i) for i in range(order + 1)])
    bands = np.zeros((order + 1, rows))
    for k in range(order + 1):
        for i in range(order + 1 - k):
            bands[k, : max(rows - k, 0)] += steps[i + k] * steps[i] * variances[i + k : i + rows]
    return bands


def solve(bands: Reals, right: Reals) -> Reals:
    """Solve `M u = b` for a symmetric positive matrix of a few bands: `M = L D Lᵀ`, then forth and back.

    Parameters
    ----------
    bands : array (order + 1, n)
        Row `k` holds the entries `(t + k, t)` of `M`.
    right : array (n,)
        `b`.
    """
    order, n = len(bands) - 1, len(right)
    pivots = np.zeros(n)
    lower = np.zeros((order + 1, n))
    u = right.astype(np.float64)
    for t in range(n):
        reach = min(order, t)
        pivots[t] = bands[0, t] - sum(lower[k, t - k] ** 2 * pivots[t - k] for k in range(1, reach + 1))
        for k in range(1, min(order, n - 1 - t) + 1):
            # What rows t and t + k have in common before column t.
            shared = sum(
                lower[j, t - j] * lower[j + k, t - j] * pivots[t - j] for j in range(1, min(order - k, t) + 1)
            )
            lower[k, t] = (bands[k, t] - shared) / pivots[t]
        u[t] -= sum(lower[k, t - k] * u[t - k] for k in range(1, reach + 1))
    u /= pivots
    for t in range(n - 2, -1, -1):
        u[t] -= sum(lower[k, t] * u[t + k] for k in range(1, min(order, n - 1 - t) + 1))
    return u
