"""Candidates: which frames are compared with a frame, how, and which of them are the nearest."""

from dataclasses import dataclass

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from quatfilt._reference._arrays import Indices, Reals
from quatfilt._reference.filters.chart import Chart
from quatfilt._reference.rotations.quaternion import geodesic_distance
from quatfilt._reference.search.patch_neighbors import Poses


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

    @property
    def columns(self) -> int:
        """How many patch distances a pair of frames has."""
        return len(self.bandwidth) if self.per_joint else 1


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


def library_distances(clip: Clip, how: Comparison, library: Poses, t: int) -> Reals:
    """Distances `E` between the patch around the frame `t` and those of the library, as :func:`patch_distances`.

    Returns
    -------
    array (N, joints) or (N, 1)
    """
    numerator = np.zeros((len(library.middles), how.columns))
    trusted = np.zeros_like(numerator)
    for offset in range(-how.past, how.future + 1):
        here, there = clip.padding + t + offset, library.middles + offset
        confidence = clip.confidence[here] * library.present[there]
        angles = geodesic_distance(clip.chart.rotations[here], library.rotations[there])
        terms = confidence * angles**2 / (2 * how.bandwidth**2)
        numerator += terms if how.per_joint else terms.sum(axis=1, keepdims=True)
        trusted += confidence if how.per_joint else confidence.sum(axis=1, keepdims=True)
    denominator = 3 * trusted if how.averaged else 1.0
    return np.where(trusted == 0, np.inf, numerator / np.where(trusted == 0, 1, denominator))


@dataclass(frozen=True)
class Kept:
    """The candidates with the smallest patch distances; places without a candidate hold 0 or −1."""

    lags: Indices
    """Lags of those of the clip, `(frames, joints or 1, neighbors)`."""
    others: Indices
    """Numbers of those of the library, of the same shape."""
    distances: Reals
    """Their patch distances, of the same shape."""


def nearest_candidates(clip: Clip, how: Comparison, neighbors: int, library: Poses | None) -> Kept | None:
    """Find the candidates with the smallest patch distances.

    They come in the order of preference, so that a later one has to be strictly better. `None` if there is no limit.
    """
    if neighbors < 0:
        return None
    smallest = np.full((clip.frames, how.columns, neighbors), np.inf)
    lags = np.zeros(smallest.shape, np.intp)
    others = np.full(smallest.shape, -1)
    for lag in how.lags:
        t = frames_with_candidate(clip, how, lag)
        found = patch_distances(clip, how, lag)[..., None]
        distances = np.concatenate([smallest[t], found], axis=-1)
        order = np.argsort(distances, axis=-1, kind="stable")[..., :neighbors]
        smallest[t] = np.take_along_axis(distances, order, axis=-1)
        with_this = np.concatenate([lags[t], np.full(found.shape, lag)], axis=-1)
        lags[t] = np.take_along_axis(with_this, order, axis=-1)
    if library is not None:
        for frame in range(clip.frames):
            found = library_distances(clip, how, library, frame).T
            distances = np.concatenate([smallest[frame], found], axis=-1)
            order = np.argsort(distances, axis=-1, kind="stable")[..., :neighbors]
            smallest[frame] = np.take_along_axis(distances, order, axis=-1)
            none, all_of_them = (
                np.zeros(found.shape, np.intp),
                np.broadcast_to(np.arange(found.shape[1]), found.shape),
            )
            lags[frame] = np.take_along_axis(np.concatenate([lags[frame], none], axis=-1), order, axis=-1)
            others[frame] = np.take_along_axis(
                np.concatenate([others[frame], all_of_them], axis=-1), order, axis=-1
            )
    return Kept(lags, others, smallest)
