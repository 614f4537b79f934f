"""The direction of the nearest geodesic among those in a plane, exactly.

In a plane of directions, with `α` the angle of a sample's vector part `u` and `r = |u|`, the distance to the geodesic with
the direction `θ` is `arcsin(r |sin(θ − α)|)`: concave but for its kink at `α`. So is the mean over the samples, which
therefore has its minimum at the angle of a sample.

Branch and bound finds it. Between the angles `a` and `b` the samples that have no kink there make a concave sum, which
is nowhere less than the lesser of its values at `a` and `b`; the others add at least 0.
"""

import heapq

import numpy as np

from quatfilt._reference._arrays import Reals
from quatfilt._reference.geodesics.pga.objective import distances

PARTS = 16
"""Parts of the circle, with equally many kinks, that the search begins with."""


def nearest_in_plane(x: Reals, plane: Reals) -> tuple[Reals, list[float]]:
    """Direction in the plane of two unit vectors `(2, 3)` with the lowest mean distance, and the best values in their order.

    The samples' vector parts lie in the plane, and not all of them are 0.
    """
    a, b = plane @ x[:, 1:].T
    lines = np.flatnonzero((a != 0) | (b != 0))
    angles = np.arctan2(b[lines], a[lines]) % np.pi
    order = lines[np.argsort(angles, kind="stable")]
    n = len(order)
    directions = np.stack([a[order], b[order]], axis=-1)
    directions = (directions / np.hypot(a[order], b[order])[:, None]) @ plane
    values: list[float] = []
    best = 0

    def at(kink: int) -> float:
        nonlocal best
        value = float(np.mean(distances(x, directions[kink])))
        if not values or value < values[-1]:
            values.append(value)
            best = kink
        return value

    def bound(start: int, end: int, ends: tuple[float, float]) -> float:
        inside = x[order[start + 1 : end]]
        parts = [float(np.sum(distances(inside, directions[k % n]))) / len(x) for k in (start, end)]
        return min(ends[0] - parts[0], ends[1] - parts[1])

    borders = np.unique(np.arange(PARTS) * n // PARTS).tolist()
    found = [at(kink) for kink in borders]
    open_parts: list[tuple[float, int, int, float, float]] = []

    def divide(start: int, end: int, first: float, last: float) -> None:
        if end - start > 1:
            heapq.heappush(open_parts, (bound(start, end, (first, last)), start, end, first, last))

    for i, start in enumerate(borders):
        following = (i + 1) % len(borders)
        divide(start, borders[following] if following else n, found[i], found[following])
    while open_parts:
        low, start, end, first, last = heapq.heappop(open_parts)
        if low >= values[-1]:
            break
        middle = (start + end) // 2
        here = at(middle)
        divide(start, middle, first, here)
        divide(middle, end, here, last)
    return directions[best], values
