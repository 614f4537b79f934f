"""The filter: its window, the clip beyond its ends, and what comes out."""

from typing import Literal

import numpy as np

from quatfilt._reference._arrays import Reals
from quatfilt._reference.filters.boundary import Boundary, extend_by_index, extend_rotations, extend_vectors
from quatfilt._reference.filters.chart import ChartName, choose_chart
from quatfilt._reference.filters.nonlocal_pose_means.candidates import Clip, Comparison, nearest_candidates
from quatfilt._reference.filters.nonlocal_pose_means.means import average
from quatfilt._reference.rotations.quaternion import continuous, normalize
from quatfilt._reference.search.patch_neighbors import extended


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
    library: Reals | None,
    lengths: list[int],
) -> tuple[Reals, Reals | None]:
    """Average each frame `t` with the frames `s` of its window, weighted by the similarity of their patches.

    The weight of `s` is `f(t, s) = exp(−E(t, s))` with the patch distance `E` of :func:`.candidates.patch_distances`, and 0 where
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
    library : array (N, joints, 4) or None
        Clips one after the other, whose frames are candidates of every frame, wherever it is. Their patches are held beyond
        the ends of their clips; missing samples have confidence 0. Of candidates at equal distances those of the clip
        count first, then the earlier in the library. They have no part in the translation. Only with the chart `"local"`
        and a number of neighbours.
    lengths : list of int, frames
        The lengths of the clips of the library.

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
    others = None
    if library is not None:
        others = extended(np.split(library, np.cumsum(lengths)[:-1]), patch_radius)
    rotations, positions = average(clip, how, nearest_candidates(clip, how, neighbors, others), others)
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


def in_hemisphere_of(rotations: Reals, q: Reals) -> Reals:
    """Make a path continuous in sign, from the hemisphere of the first frame of `q`."""
    path = continuous(rotations)
    opposite = np.sum(path[0] * q[0], axis=-1) < 0
    return path * np.where(opposite, -1, 1)[:, None]
