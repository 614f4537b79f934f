"""Patch search against angles of SciPy's rotations, all patches with all."""

import clips
import numpy as np
import patches
import pytest
import tolerances


def brute_force(q, candidates, radius, exclusion):
    """Distances of all patches, written out."""
    distances = np.full((len(q), len(candidates)), np.inf)
    for t in range(len(q)):
        for s in range(len(candidates)):
            if exclusion is not None and abs(s - t) <= exclusion:
                continue
            here = [min(max(t + o, 0), len(q) - 1) for o in range(-radius, radius + 1)]
            there = [min(max(s + o, 0), len(candidates) - 1) for o in range(-radius, radius + 1)]
            distances[t, s] = np.sqrt(np.mean(clips.angles(q[here], candidates[there]) ** 2))
    return distances


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("own", [True, False])
def test_brute_force(backend, dtype, own):
    rng = np.random.default_rng(8)
    q = clips.noisy(rng, clips.smooth(rng, 70, 3, swing=3), 0.02).astype(dtype)
    library = None if own else [clips.smooth(rng, 50, 3, swing=3).astype(dtype)]
    exact = brute_force(q, q if own else library[0], 3, 4 if own else None)
    nearest = np.sort(exact, axis=1)[:, :6]
    found = patches.neighbors(backend, q, library, radius=3, k=6, exclusion=4)
    patches.same_neighbors(found, (None, nearest.astype(dtype)), exact, tolerances.filtered(dtype))
