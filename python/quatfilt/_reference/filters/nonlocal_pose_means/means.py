"""Weighted means of the candidates."""

import numpy as np

from quatfilt._reference._arrays import Reals
from quatfilt._reference.filters.nonlocal_pose_means.candidates import (
    Clip,
    Comparison,
    Kept,
    frames_with_candidate,
    patch_distances,
)
from quatfilt._reference.rotations.quaternion import between, log_short
from quatfilt._reference.search.patch_neighbors import Poses

SELF_WEIGHT_FLOOR = np.exp(-80.0)
"""Least weight of a frame in its own mean. The smallest normal float32 is near `exp(−87)`: with this floor a tiny
bandwidth gives back the frame itself, in both precisions, instead of the most similar of the others."""

FARTHEST = 120.0
"""Patch distance beyond which a candidate has no weight. A frame without confidence is made of the others alone, however
small their weights are, and it must not depend on the precision which of them underflow. (float32 holds `exp(40 − E)`
down to here; the common factor cancels.) Beside the least weight of a trusted frame itself, `exp(−120)` is nothing."""


def average(clip: Clip, how: Comparison, kept: Kept | None, library: Poses | None) -> tuple[Reals, Reals]:
    """Weighted means of the rotations, `(frames, joints, 4)`, and of the positions, `(frames, 3)`."""
    joints = len(how.bandwidth)
    own = clip.padding + np.arange(clip.frames)
    largest: Reals = np.zeros((clip.frames, how.columns))
    total = np.zeros((clip.frames, joints))
    turn = np.zeros((clip.frames, joints, 3))
    shift = np.zeros((clip.frames, 3))
    for lag in how.lags:
        t = frames_with_candidate(clip, how, lag)
        here, there = own[t], own[t] + lag
        weights = weights_of(patch_distances(clip, how, lag))
        if kept is not None:
            weights[~(kept.lags[t] == lag).any(axis=-1)] = 0
        largest[t] = np.maximum(largest[t], weights)
        weight = weights * clip.confidence[there]
        total[t] += weight
        turn[t] += weight[..., None] * clip.chart.differences(here, there)
        shift[t] += weight[:, :1] * (clip.translation[there] - clip.translation[here])
    moved_total = total[:, :1].copy()
    if kept is not None and library is not None and len(library.middles):
        for place in range(kept.others.shape[-1]):
            number = np.broadcast_to(kept.others[..., place], (clip.frames, joints))
            borrowed = np.where(kept.others[..., place] < 0, 0, weights_of(kept.distances[..., place]))
            largest = np.maximum(largest, borrowed)
            frame = library.middles[number]
            weight = borrowed * library.present[frame, np.arange(joints)]
            total += weight
            rotations = library.rotations[frame, np.arange(joints)]
            turn += weight[..., None] * 2 * log_short(between(clip.chart.rotations[own], rotations))
    self_weight = np.maximum(largest, SELF_WEIGHT_FLOOR) * clip.confidence[own]
    total += self_weight
    moved_total += self_weight[:, :1]
    total[total == 0] = 1
    moved_total[moved_total == 0] = 1
    rotations = clip.chart.moved(own, turn / total[..., None])
    return rotations, clip.translation[own] + shift / moved_total


def weights_of(distances: Reals) -> Reals:
    """Weights of patch distances."""
    return np.where(distances <= FARTHEST, np.exp(-distances), 0)
