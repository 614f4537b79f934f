"""Non-local pose means: each pose becomes the mean of the poses whose surroundings look like its own.

C. J. Dean and J. P. Lewis, *Non-local Pose Means for Denoising Motion Capture Data*, 2017.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from quatfilt._reference._arrays import Indices, Reals
from quatfilt._reference.filters.boundary import Boundary, extend_by_index, extend_rotations, extend_vectors
from quatfilt._reference.filters.chart import Chart, ChartName, choose_chart
from quatfilt._reference.rotations.quaternion import continuous, normalize

SELF_WEIGHT_FLOOR = np.exp(-80.0)
"""Least weight of a frame in its own mean. The smallest normal float32 is near `exp(−87)`: with this floor a tiny
bandwidth gives back the frame itself, in both precisions, instead of the most similar of the others."""

FARTHEST = 120.0
"""Patch distance beyond which a candidate has no weight. A frame without confidence is made of the others alone, however
small their weights are, and it must not depend on the precision which of them underflow. (float32 holds `exp(40 − E)`
down to here; the common factor cancels.) Beside the least weight of a trusted frame itself, `exp(−120)` is nothing."""


@dataclass(frozen=True)
class Comparison:
    """Which frames are compared with a frame, and how."""

    lags: list[int]
    """Candidates are `t + lag`; the nearest first, and of two equally near ones the earlier."""
    within_clip: bool
    """Whether only the clip's own frames are candidates."""
    past: int
    future: int
    """The patch has the offsets `−past … future`."""
    bandwidth: Reals
    """Radians of rotation per coordinate, `(joints,)`."""
    averaged: bool
    """Whether squared differences are averaged over a patch, or summed."""
    per_joint: bool
    """Whether each joint has weights of its own."""


@dataclass(frozen=True)
class Clip:
    """A clip continued beyond its ends. Frame `t` of the clip is frame `padding + t` here."""

    frames: int
    """How many frames the clip itself has."""
    padding: int
    chart: Chart
    translation: Reals
    """Positions of the root, `(N, 3)`."""
    confidence: Reals
    """Confidences, `(N, joints)`."""


def nonlocal_pose_means(
    q: Reals,
    translation: Reals | None,
    confidence: Reals | None,
    bandwidth: Reals,
    search_radius: int,
    patch_radius: int,
    distance: Literal["mean", "sum"],
    weights: Literal["pose", "joint"],
    neighbors: int,
    chart: ChartName,
    boundary: Boundary,
    lookahead: int,
) -> tuple[Reals, Reals | None]:
    """Average each frame `t` with the frames `s` of its window, weighted by the likeness of their patches.

    The weight of `s` is `f(t, s) = exp(−E(t, s))` with the patch distance `E` of :func:`patch_distances`, and 0 where
    `E > 120`. The frame itself has the largest weight of the others, at least `exp(−80)`. With the rotation vectors `x` of the chart,

        `x̂_t = Σ_s f(t, s) c_s x_s / Σ_s f(t, s) c_s`,

    where `c_s` is the confidence of the candidate. If the denominator is 0 the frame stays as it is. The sum is written
    with differences, `x̂_t = x_t + Σ f c (x_s − x_t) / Σ f c`, because those exist in every chart.

    The cost is `frames · window · joints`, the memory linear in frames.

    Parameters
    ----------
    q : array (frames, joints, 4)
        Rotations without missing samples.
    translation : array (frames, 3) or None
        Positions of the root, averaged with the weights and confidences of joint 0.
    confidence : array (frames, joints) or None
        Confidences in [0, 1]; `None` stands for 1.
    bandwidth : array (joints,), radians of rotation per coordinate
        Scale of the differences that count as noise, `> 0`.
    search_radius : int, frames
        Candidates are `t − k … t + k`, also beyond the ends; −1: all frames of the clip and no others.
    patch_radius : int, frames
        Patches are `t − r … t + r`.
    distance : "mean" or "sum"
        Whether squared differences are averaged over the patch, or summed as in the paper's equation (3).
    weights : "pose" or "joint"
        Whether all joints share the weights of the pose, or each has weights of its own.
    neighbors : int
        How many candidates, those with the smallest `E`, have a weight; −1: all. Of equal ones the nearer in time
        counts, then the earlier.
    chart : "mean", "identity" or "local"
        Where rotations are turned into vectors; see :func:`.chart.choose_chart`.
    boundary : "mirror", "linear" or "nearest"
        How the clip goes on beyond its ends; see :mod:`.boundary`.
    lookahead : int, frames
        With `a ≥ 0` only frames up to `t + a` are compared: patches end at `t + min(r, a)` and candidates at
        `t + min(k, a − min(r, a))`; −1: no such limit. (The chart `"mean"`, and a mirrored start, still come from
        later frames.)

    Returns
    -------
    rotations : array (frames, joints, 4)
        Unit quaternions, continuous in sign from the hemisphere of the input's first frame.
    translation : array (frames, 3) or None
    """
    frames, joints = q.shape[:2]
    if frames < 2 or joints == 0:
        return normalize(q), None if translation is None else translation.copy()
    lags, future = causal_window(frames, search_radius, patch_radius, lookahead)
    how = Comparison(
        lags,
        within_clip=search_radius < 0,
        past=patch_radius,
        future=future,
        bandwidth=bandwidth,
        averaged=distance == "mean",
        per_joint=weights == "joint",
    )
    padding = max(search_radius, 0) + patch_radius
    clip = extend(q, translation, confidence, padding, boundary, chart)
    rotations, positions = average(clip, how, nearest_lags(clip, how, neighbors))
    rotations = in_hemisphere_of(rotations, q).astype(q.dtype)
    return rotations, None if translation is None else positions.astype(translation.dtype)


def causal_window(
    frames: int, search_radius: int, patch_radius: int, lookahead: int
) -> tuple[list[int], int]:
    """Lags of the candidates, nearest first, and the last offset of the patch."""
    radius = frames - 1 if search_radius < 0 else search_radius
    future, last = patch_radius, radius
    if lookahead >= 0:
        future = min(patch_radius, lookahead)
        last = min(radius, lookahead - future)
    lags = [lag for lag in range(-radius, last + 1) if lag != 0]
    return sorted(lags, key=abs), future


def extend(
    q: Reals,
    translation: Reals | None,
    confidence: Reals | None,
    padding: int,
    boundary: Boundary,
    chart: ChartName,
) -> Clip:
    """Continue a clip beyond its ends and choose its chart."""
    frames, joints = q.shape[:2]
    path = continuous(normalize(q.astype(np.float64)))
    translation = np.zeros((frames, 3)) if translation is None else translation.astype(np.float64)
    confidence = np.ones((frames, joints)) if confidence is None else confidence.astype(np.float64)
    return Clip(
        frames,
        padding,
        choose_chart(extend_rotations(path, padding, boundary), path, chart),
        extend_vectors(translation, padding, boundary),
        extend_by_index(confidence, padding, boundary),
    )


def frames_with_candidate(clip: Clip, how: Comparison, lag: int) -> Indices:
    """Frames `t` of the clip for which `t + lag` is a candidate."""
    t = np.arange(clip.frames)
    if how.within_clip:
        t = t[(t + lag >= 0) & (t + lag < clip.frames)]
    return t


def patch_distances(clip: Clip, how: Comparison, lag: int) -> Reals:
    """Distances `E(t, s)` between the patches around `t` and `s = t + lag`, for all `t` that have this candidate.

    `E(t, s) = Σ_{o, j} c_{t+o} c_{s+o} |x_{s+o} − x_{t+o}|² / (2 h_j²)` over the patch's offsets `o` and the joints `j`
    with bandwidths `h_j`; averaged: divided by `3 Σ_{o, j} c_{t+o} c_{s+o}`. It is infinite where that sum is 0, for then
    nothing tells whether the patches are alike. With weights per joint, each joint has its own `E`: the sums are over
    `o` alone.

    Returns
    -------
    array (n, joints) or (n, 1)
    """
    t = frames_with_candidate(clip, how, lag)
    u = clip.padding + np.arange(t[0] - how.past, t[-1] + how.future + 1)
    confidence = clip.confidence[u] * clip.confidence[u + lag]
    squares = np.sum(clip.chart.differences(u, u + lag) ** 2, axis=-1)
    terms = confidence * squares / (2 * how.bandwidth**2)
    if not how.per_joint:
        terms = terms.sum(axis=1, keepdims=True)
        confidence = confidence.sum(axis=1, keepdims=True)
    patch = how.past + how.future + 1
    numerator = sliding_window_view(terms, patch, axis=0).sum(axis=-1)
    trusted = sliding_window_view(confidence, patch, axis=0).sum(axis=-1)
    denominator = 3 * trusted if how.averaged else 1.0
    return np.where(trusted == 0, np.inf, numerator / np.where(trusted == 0, 1, denominator))


def nearest_lags(clip: Clip, how: Comparison, neighbors: int) -> Indices | None:
    """Lags of the candidates with the smallest patch distances, `(frames, joints or 1, neighbors)`.

    Lags come in the order of preference, so that a later one has to be strictly better. Places without a candidate hold
    0. `None` if there is no limit.
    """
    if neighbors < 0:
        return None
    columns = len(how.bandwidth) if how.per_joint else 1
    smallest = np.full((clip.frames, columns, neighbors), np.inf)
    lags = np.zeros(smallest.shape, np.intp)
    for lag in how.lags:
        t = frames_with_candidate(clip, how, lag)
        found = patch_distances(clip, how, lag)[..., None]
        distances = np.concatenate([smallest[t], found], axis=-1)
        order = np.argsort(distances, axis=-1, kind="stable")[..., :neighbors]
        smallest[t] = np.take_along_axis(distances, order, axis=-1)
        with_this = np.concatenate([lags[t], np.full(found.shape, lag)], axis=-1)
        lags[t] = np.take_along_axis(with_this, order, axis=-1)
    return lags


def average(clip: Clip, how: Comparison, kept: Indices | None) -> tuple[Reals, Reals]:
    """Weighted means of the rotations, `(frames, joints, 4)`, and of the positions, `(frames, 3)`."""
    joints = len(how.bandwidth)
    own = clip.padding + np.arange(clip.frames)
    largest = np.zeros((clip.frames, joints if how.per_joint else 1))
    total = np.zeros((clip.frames, joints))
    turn = np.zeros((clip.frames, joints, 3))
    shift = np.zeros((clip.frames, 3))
    for lag in how.lags:
        t = frames_with_candidate(clip, how, lag)
        here, there = own[t], own[t] + lag
        distances = patch_distances(clip, how, lag)
        likeness = np.where(distances <= FARTHEST, np.exp(-distances), 0)
        if kept is not None:
            likeness[~(kept[t] == lag).any(axis=-1)] = 0
        largest[t] = np.maximum(largest[t], likeness)
        weight = likeness * clip.confidence[there]
        total[t] += weight
        turn[t] += weight[..., None] * clip.chart.differences(here, there)
        shift[t] += weight[:, :1] * (clip.translation[there] - clip.translation[here])
    total += np.maximum(largest, SELF_WEIGHT_FLOOR) * clip.confidence[own]
    total[total == 0] = 1
    rotations = clip.chart.moved(own, turn / total[..., None])
    return rotations, clip.translation[own] + shift / total[:, :1]


def in_hemisphere_of(rotations: Reals, q: Reals) -> Reals:
    """Make a path continuous in sign, from the hemisphere of the first frame of `q`."""
    path = continuous(rotations)
    opposite = np.sum(path[0] * q[0], axis=-1) < 0
    return path * np.where(opposite, -1, 1)[:, None]
