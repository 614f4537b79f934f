"""Streams that were interpolated: frames on geodesics between measurements that all joints have in common."""

import numpy as np

from quatfilt._reference._arrays import Mask, Reals
from quatfilt._reference.noise.noise import increments

PROBE = 4096
"""Frames, from the start, on which it is decided whether a stream was interpolated."""

RADIUS = 12
"""Frames before and after over which the speed and the largest bend of a joint are taken."""

SLOWEST = np.radians(0.02)
"""Radians per frame: a joint that is slower says nothing about bends."""

LEAST_BEND = 1e-5
"""Radians per frame: bends below are rounding."""

HIGH = 0.9
"""Quantile of the bends of a joint that stands for its knots."""

STEP = 0.15
"""Share of that quantile from which a joint bends."""

KNOT, INSIDE = 0.4, 0.2
"""Share of the joints that bend: above `KNOT` the frame is a knot, below `INSIDE` it lies between knots."""

FEWEST_JOINTS = 3
"""Joints that must be fast enough for a frame to be judged."""

CLEAR = 0.8
"""Share of the judged frames that must be knots or inside, and of the knots that must be at most two frames long."""

MOST_KNOTS = 0.65
"""Share of the judged frames that may be knots: measurements 10/3 frames apart bend two of them each."""

STRAIGHT = 0.12
"""Median bend inside, over the median bend at knots, that is straight."""

FEWEST_KNOTS = 10
"""Knots that there must be more of."""


def knot_times(q: Reals) -> Reals | None:
    """Return the times of the measurements between which a stream was interpolated, or None.

    The increments `w_t = 2 log(q_t⁻¹ q_{t+1})` of such a stream are constant but at its knots, where the bend `a_t = |w_{t+1} − w_t|` is
    large in all joints at once. A knot between the frames `t + 1` and `t + 2` bends the path at both; it lies at

        `t + 1 + f`,    `f = Σ a_{t+1} / (Σ a_t + Σ a_{t+1})`,

    with sums over the joints. One bend alone is a knot at its frame; the frames of longer runs are knots each.

    Returns
    -------
    array (n,), frames, or None
        Increasing, from 0 to the last frame.
    """
    if not interpolated(q[:PROBE]):
        return None
    bends, counted, bent = joints_that_bend(q)
    _, knots = judged(counted, bent)
    weight = np.sum(np.where(counted, bends, 0), axis=1)
    times = [0.0]
    edges = np.flatnonzero(np.diff(np.concatenate([[False], knots, [False]])))
    for start, end in zip(edges[::2], edges[1::2], strict=True):
        if end - start == 2:
            times.append(start + 1 + weight[start + 1] / (weight[start] + weight[start + 1]))
        else:
            times += [float(t + 1) for t in range(start, end)]
    return np.unique([*times, len(q) - 1.0])


def interpolated(q: Reals) -> bool:
    """Say whether the bends of a stream are those of interpolation."""
    if len(q) < 2 * RADIUS:
        return False
    bends, counted, bent = joints_that_bend(q)
    inside, knots = judged(counted, bent)
    sure = counted.sum(axis=1) >= FEWEST_JOINTS
    lengths = np.diff(np.flatnonzero(np.diff(np.concatenate([[False], knots, [False]]))))[::2]
    if len(lengths) <= FEWEST_KNOTS or not inside.any():
        return False
    return bool(
        np.sum(inside | knots) > CLEAR * np.sum(sure)
        and np.sum(knots) < MOST_KNOTS * np.sum(sure)
        and np.sum(lengths <= 2) > CLEAR * len(lengths)
        and middle(bends[inside[:, None] & counted]) < STRAIGHT * middle(bends[knots[:, None] & counted])
    )


def joints_that_bend(q: Reals) -> tuple[Reals, Mask, Mask]:
    """Return the bends of the joints, which of them count, and which of those are large; all `(frames − 2, joints)`."""
    steps = increments(q)
    bends = np.linalg.norm(np.diff(steps, axis=0), axis=-1)
    speed = window_mean(np.linalg.norm(steps, axis=-1))[:-1]
    largest = window_largest(bends)
    counted = np.isfinite(bends) & (speed > SLOWEST) & (largest > LEAST_BEND)
    relative = np.where(counted, bends / np.where(speed > 0, speed, 1), 0)
    bent = np.zeros(bends.shape, bool)
    for joint in range(bends.shape[1]):
        values = np.sort(relative[counted[:, joint], joint])
        if len(values):
            bent[:, joint] = counted[:, joint] & (
                relative[:, joint] > STEP * values[int(HIGH * (len(values) - 1))]
            )
    return bends, counted, bent


def judged(counted: Mask, bent: Mask) -> tuple[Mask, Mask]:
    """Return the frames inside and those at knots, each `(frames,)`."""
    total, many = counted.sum(axis=1), bent.sum(axis=1)
    sure = total >= FEWEST_JOINTS
    return sure & (many < INSIDE * total), sure & (many > KNOT * total)


def window_mean(values: Reals) -> Reals:
    """Mean of the finite values within `RADIUS` frames, 0 where there is none; along axis 0."""
    there = np.isfinite(values)
    total, count = np.zeros(values.shape), np.zeros(values.shape)
    for t in range(len(values)):
        window = slice(max(t - RADIUS, 0), t + RADIUS + 1)
        total[t] = np.where(there[window], values[window], 0).sum(axis=0)
        count[t] = there[window].sum(axis=0)
    return np.where(count > 0, total / np.maximum(count, 1), 0)


def window_largest(values: Reals) -> Reals:
    """Largest of the finite values within `RADIUS` frames, 0 where there is none; along axis 0."""
    known = np.where(np.isfinite(values), values, 0)
    windows = [known[max(t - RADIUS, 0) : t + RADIUS + 1].max(axis=0) for t in range(len(values))]
    return np.array(windows).reshape(values.shape)


def middle(values: Reals) -> float:
    """Lower median."""
    return float(np.sort(values)[(len(values) - 1) // 2])
