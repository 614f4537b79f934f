"""Neighbours of patches as they are compared."""

import numpy as np

RADIUS, COUNT = 2, 5


def neighbors(backend, q, library=None, *, radius=RADIUS, k=COUNT, exclusion=RADIUS, weights=None):
    """Ask a backend, with `library` as a list of clips."""
    lengths = [] if library is None else [len(clip) for clip in library]
    together = None if library is None else np.ascontiguousarray(np.concatenate(library)).astype(q.dtype)
    weights = np.ones(q.shape[1]) if weights is None else np.asarray(weights, float)
    return backend.patch_neighbors(np.ascontiguousarray(q), together, lengths, radius, k, exclusion, weights)


def all_distances(backend, q, library=None, *, exclusion=RADIUS, **options):
    """Distances of all patches, ``(frames, candidates)``; infinite where they are left out."""
    candidates = len(q) if library is None else sum(map(len, library))
    indices, distances = neighbors(backend, q, library, k=max(candidates, 1), exclusion=exclusion, **options)
    result = np.full((len(q), candidates), np.inf)
    frame, place = np.nonzero(indices >= 0)
    result[frame, indices[frame, place]] = distances[frame, place]
    return result


def same_neighbors(found, expected, exact, tolerance):
    """Ask for the same distances, and for indices that have them by the `exact` distances of all patches."""
    (indices, distances), (_, others) = found, expected
    assert distances.dtype == others.dtype
    assert indices.dtype == np.int64
    assert indices.shape == distances.shape == others.shape
    some = np.isfinite(others)
    np.testing.assert_array_equal(np.isfinite(distances), some)
    np.testing.assert_array_equal(indices >= 0, some)
    np.testing.assert_allclose(distances[some], others[some], rtol=0, atol=tolerance)
    frame, place = np.nonzero(some)
    np.testing.assert_allclose(exact[frame, indices[frame, place]], others[some], rtol=0, atol=tolerance)
    for row, kept in zip(indices, some, strict=True):
        assert len(set(row[kept])) == kept.sum()
