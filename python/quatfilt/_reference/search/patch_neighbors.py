"""Patch search: the nearest patches of every frame."""

from collections import deque
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from quatfilt._reference._arrays import Indices, Mask, Reals
from quatfilt._reference.filters.boundary import extend_by_index
from quatfilt._reference.rotations.quaternion import geodesic_distance, is_missing

NO_NEIGHBOR = -1
"""Index of a missing neighbour; its distance is infinite."""


@dataclass(frozen=True)
class Poses:
    """Concatenated clips, each extended beyond its ends."""

    rotations: Reals
    """Rotations, `(N, joints, 4)`; arbitrary where they are missing."""
    present: Mask
    """Mask of the valid samples, `(N, joints)`."""
    middles: Indices
    """Indices of the clips' own frames."""


def patch_neighbors(
    q: Reals,
    library: Reals | None,
    lengths: list[int],
    patch_radius: int,
    k: int,
    exclusion: int,
    weights: Reals,
) -> tuple[NDArray[np.int64], Reals]:
    """Find the `k` nearest patches of every frame.

    The patch of a frame `t` has the offsets `o = −r … r`. Past the ends of a clip its end frame is repeated. With `θ_j` the
    rotation angle between two samples of joint `j`,

        `D(t, s)² = Σ w_j θ_j(t+o, s+o)² / Σ w_j`,

    both sums over the offsets and joints with two valid samples. Patches without such a pair are not neighbours.

    The cost is `frames · candidates · joints`, the memory linear in both.

    Parameters
    ----------
    q : array (frames, joints, 4)
        The rotations whose patches have neighbours.
    library : array (N, joints, 4) or None
        Concatenated clips, all of whose frames are candidates. `None`: the candidates of frame `t` are the frames
        `s` of `q` with `|s − t| > exclusion`.
    lengths : list of int, frames
        The lengths of the clips of the library.
    patch_radius : int, frames
        The radius `r` of a patch.
    k : int
        Number of neighbours per frame.
    exclusion : int, frames
    weights : array (joints,)
        Weight of each joint, `≥ 0`.

    Returns
    -------
    indices : array (frames, k) of int64
        Candidates, nearest first; ties go to the lower index. −1 for missing entries.
    distances : array (frames, k), radians
        Their distances `D`; infinite for missing entries.
    """
    here = extended([q], patch_radius)
    there = here if library is None else extended(np.split(library, np.cumsum(lengths)[:-1]), patch_radius)
    offsets = np.arange(-patch_radius, patch_radius + 1)
    patches = there.middles[:, None] + offsets
    indices = np.full((len(q), k), NO_NEIGHBOR, np.int64)
    nearest = np.full((len(q), k), np.inf)
    rows: deque[tuple[Reals, Reals]] = deque(maxlen=len(offsets))
    for frame in range(len(here.rotations)):
        rows.append(frame_distances(here, frame, there, weights))
        t = frame - 2 * patch_radius
        if t < 0 or not len(patches):
            continue
        squares = sum(row[0][patches[:, o]] for o, row in enumerate(rows))
        counts = sum(row[1][patches[:, o]] for o, row in enumerate(rows))
        with np.errstate(divide="ignore", invalid="ignore"):
            distances = np.where(counts > 0, np.sqrt(squares / counts), np.inf)
        if library is None:
            distances[max(0, t - exclusion) : t + exclusion + 1] = np.inf
        order = np.argsort(distances, kind="stable")[:k]
        order = order[np.isfinite(distances[order])]
        indices[t, : len(order)], nearest[t, : len(order)] = order, distances[order]
    return indices, nearest.astype(q.dtype)


def extended(clips: list[Reals], padding: int) -> Poses:
    """Extend clips by repeating their end frames, and concatenate them."""
    rotations, middles, start = [], [], 0
    for clip in clips:
        if len(clip):
            rotations.append(extend_by_index(clip.astype(np.float64), padding, "nearest"))
            middles.append(start + padding + np.arange(len(clip)))
            start += len(rotations[-1])
    together = np.concatenate(rotations) if rotations else np.zeros((0, *clips[0].shape[1:]))
    present = ~is_missing(together)
    together[~present] = [1, 0, 0, 0]
    return Poses(together, present, np.concatenate(middles) if middles else np.zeros(0, np.intp))


def frame_distances(here: Poses, frame: int, there: Poses, weights: Reals) -> tuple[Reals, Reals]:
    """Compare one frame with all others: `Σ w θ²` and `Σ w` over the joints that both have, `(N,)` each."""
    angles = geodesic_distance(here.rotations[frame], there.rotations)
    counts = weights * (here.present[frame] & there.present)
    return np.sum(counts * angles**2, axis=1), np.sum(counts, axis=1)
