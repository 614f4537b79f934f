"""Calls of the non-local pose means with defaults, and options drawn by Hypothesis."""

import numpy as np
from hypothesis import strategies as st

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
    "library": None,
    "lengths": [],
}


def arguments(q, **options):
    """Positional arguments of a backend's function; `bandwidth` is a number or one per joint, `library` a list."""
    chosen = DEFAULTS | options
    chosen["bandwidth"] = np.broadcast_to(chosen["bandwidth"], q.shape[1]).astype(np.float64)
    for name in ("translation", "confidence"):
        if chosen[name] is not None:
            chosen[name] = np.require(chosen[name], q.dtype, "C")
    if chosen["library"] is not None:
        chosen["lengths"] = [len(clip) for clip in chosen["library"]]
        chosen["library"] = np.require(np.concatenate(chosen["library"]), q.dtype, "C")
    return np.ascontiguousarray(q), *(chosen[name] for name in DEFAULTS)


def rotations(backend, q, **options):
    """Filter the rotations."""
    return backend.nonlocal_pose_means(*arguments(q, **options))[0]


def positions(backend, q, **options):
    """Filter the positions of the root."""
    return backend.nonlocal_pose_means(*arguments(q, **options))[1]


def options(*, neighbors=True, search_radius=(-1, 0, 1, 4, 30), lookahead=True):
    """Everything but the chart."""
    return st.fixed_dictionaries(
        {
            "search_radius": st.sampled_from(search_radius),
            "patch_radius": st.integers(0, 3),
            "distance": st.sampled_from(["mean", "sum"]),
            "weights": st.sampled_from(["pose", "joint"]),
            "neighbors": st.sampled_from([-1, 1, 3]) if neighbors else st.just(-1),
            "boundary": st.sampled_from(["mirror", "linear", "nearest"]),
            "lookahead": st.sampled_from([-1, 0, 2, 5]) if lookahead else st.just(-1),
            "bandwidth": st.sampled_from([0.02, 0.1, 1.0]),
        }
    )
