"""Calls of the non-local pose means with defaults, for the laws and the oracle."""

import numpy as np

DEFAULTS = {
    "translation": None,
    "confidence": None,
    "bandwidth": 0.05,
    "search_radius": 4,
    "patch_radius": 2,
    "distance": "mean",
    "weights": "pose",
    "neighbors": -1,
    "chart": "mean",
    "boundary": "nearest",
    "lookahead": -1,
}


def arguments(q, **options):
    """Positional arguments of a backend's function; `bandwidth` is a number or one per joint."""
    chosen = DEFAULTS | options
    chosen["bandwidth"] = np.broadcast_to(chosen["bandwidth"], q.shape[1]).astype(np.float64)
    for name in ("translation", "confidence"):
        if chosen[name] is not None:
            chosen[name] = np.require(chosen[name], q.dtype, "C")
    return np.ascontiguousarray(q), *(chosen[name] for name in DEFAULTS)


def rotations(backend, q, **options):
    """Filter the rotations."""
    return backend.nonlocal_pose_means(*arguments(q, **options))[0]


def positions(backend, q, **options):
    """Filter the positions of the root."""
    return backend.nonlocal_pose_means(*arguments(q, **options))[1]
