"""Examples for local models, seeded."""

import clips
import numpy as np

MODELS = ("local_regression", "partial_least_squares", "local_pcr", "local_pca", "nearest", "mean_pose")

REGRESSIONS = MODELS[:3]

APART = 9
"""Frames from one example to the next."""


def examples(rng, count, order, joints, *, swing=0.6):
    """Segments ``(count, order + 1, joints, 4)`` of a smooth motion, root steps ``(count, 4)``, and last poses near some of them."""
    q = clips.smooth(rng, count * APART + order + 1, joints, swing=swing)
    starts = np.arange(count) * APART
    segments = np.stack([q[start : start + order + 1] for start in starts])
    start = int(rng.integers(0, len(q) - order))
    recent = clips.noisy(rng, q[start : start + order], 0.02)
    return segments, rng.standard_normal((count, 4)), recent


def predict(
    backend,
    segments,
    steps,
    recent,
    model="local_regression",
    *,
    signals=None,
    target="pose",
    deviation="predictive",
    weights=None,
    bandwidth=0.0,
    ridge=0.01,
    share=0.99,
):
    """Chart, mean, deviation and axes."""
    weights = np.ones(segments.shape[2]) if weights is None else weights
    signals = np.zeros((len(segments), 0), segments.dtype) if signals is None else signals
    return backend.predict_pose(
        segments, steps, signals, recent, weights, model, target, deviation, bandwidth, ridge, share
    )


def pose(prediction):
    """The rotations that the mean of a prediction stands for, ``(joints, 4)``."""
    chart, mean = prediction[:2]
    return clips.product(chart, clips.from_vectors(mean[: 3 * len(chart)].reshape(-1, 3)))


def vectors(chart, q):
    """Rotation vectors seen from a chart, ``(..., joints · 3)``, by SciPy."""
    turned = clips.rotation(np.broadcast_to(chart, q.shape)).inv() * clips.rotation(q)
    return turned.as_rotvec().reshape(*q.shape[:-2], -1)
