"""Non-local pose means as one would write them with Numba: a direct loop over frames, candidates and patches.

It is given ready-made rotation vectors in the chart, continued beyond the ends, and gives back rotation vectors: less
work than the package's call, which takes and gives quaternions.
"""

import math

import numba
import numpy as np
import quatfilt as qf
from clips import Array

_LEAST_SELF_WEIGHT = math.exp(-80)


@numba.njit(parallel=True, fastmath=True)
def direct_means(padded: Array, search: int, patch: int, bandwidth: float) -> Array:
    """Average each frame with the frames of its window; `padded` is `(frames + 2 · (search + patch), coordinates)`."""
    pad = search + patch
    frames, coordinates = padded.shape[0] - 2 * pad, padded.shape[1]
    length = (2 * patch + 1) * coordinates
    flat = padded.reshape(
        -1
    )  # a patch is contiguous, so that its distance is one loop, which becomes vector code
    factor = padded.dtype.type(-1 / (2 * bandwidth * bandwidth * length))
    out = np.empty((frames, coordinates), padded.dtype)
    for t in numba.prange(frames):
        here = (t + search) * coordinates
        total = padded.dtype.type(0)
        largest = padded.dtype.type(_LEAST_SELF_WEIGHT)
        mean = np.zeros(coordinates, padded.dtype)
        for s in range(t - search, t + search + 1):
            if s == t:
                continue
            there = (s + search) * coordinates
            square = padded.dtype.type(0)
            for i in range(length):
                difference = flat[there + i] - flat[here + i]
                square += difference * difference
            weight = math.exp(square * factor)
            largest = max(largest, weight)
            total += weight
            for c in range(coordinates):
                mean[c] += weight * padded[s + pad, c]
        for c in range(coordinates):
            out[t, c] = (mean[c] + largest * padded[t + pad, c]) / (total + largest)
    return out


def vectors_in_chart(q: Array, pad: int) -> tuple[Array, Array]:
    """Return the joints' means, and rotation vectors at them with the end poses held, `(frames + 2 · pad, 3 · joints)`."""
    means = qf.mean(q, axis=0)
    path = qf.continuous(qf.multiply(np.broadcast_to(qf.conjugate(means), q.shape), q))
    path[:, np.median(path[..., 0], axis=0) < 0] *= -1
    vectors = 2 * qf.log(path)
    padded = np.pad(vectors.reshape(len(q), -1), ((pad, pad), (0, 0)), mode="edge")
    return means, np.ascontiguousarray(padded)


def rotations_from_chart(means: Array, vectors: Array) -> Array:
    """Return the quaternions of vectors at the joints' means."""
    moved = qf.exp(vectors.reshape(len(vectors), -1, 3) / 2)
    return qf.multiply(np.broadcast_to(means, moved.shape), moved)
