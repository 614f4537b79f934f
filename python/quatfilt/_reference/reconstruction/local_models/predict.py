"""The next pose, by any of the local models."""

import numpy as np

from quatfilt._reference._arrays import Reals
from quatfilt._reference.reconstruction.local_models.chart import mean_chart, seen_from
from quatfilt._reference.reconstruction.local_models.deviations import (
    DEVIATIONS,
    LEAST_DEVIATION,
    UNKNOWN_DEVIATION,
    left_out,
)
from quatfilt._reference.reconstruction.local_models.examples import Examples, gather
from quatfilt._reference.reconstruction.local_models.principal import (
    principal_component_analysis,
    principal_component_regression,
)
from quatfilt._reference.reconstruction.local_models.regression import regression


def predict_pose(
    segments: Reals,
    root_steps: Reals,
    signals: Reals,
    recent: Reals,
    joint_weights: Reals,
    model: str,
    target: str,
    deviation: str,
    bandwidth: float,
    ridge: float,
    share: float,
) -> tuple[Reals, Reals, Reals, Reals]:
    """Predict the next pose from the last ones, as the examples that are most like them went on.

    Parameters
    ----------
    segments : array (K, m + 1, joints, 4)
        Examples: m poses, the oldest first, and the next one. No sample is missing.
    root_steps : array (K, R)
        Further outputs of the next pose: steps forward and sideways, height, turn, in their own units.
    signals : array (K, S)
        Further inputs, in radians or in units that count like radians: differences from the query, whose
        own are 0.
    recent : array (m, joints, 4)
        The last m poses, the oldest first.
    joint_weights : array (joints,), float64
        The diagonal of W, by which joints count in the distances that weigh examples.
    model : str
        "local_regression" and "partial_least_squares", along one direction for each output; "local_pcr"; "local_pca";
        "nearest", the next pose of the nearest example; "mean_pose", the weighted mean of the next poses.
    target : "pose" or "change"
        Whether the vectors of the next pose are predicted, or their changes from the last one.
    deviation : "predictive" or "leave_one_out"
        Of the regressions.
    bandwidth : float, radians
        How far examples count; 0 for the median of their distances.
    ridge : float
        In shares of the mean eigenvalue of `X Xᵀ`.
    share : float
        Of the variance that principal components make up.

    Returns
    -------
    chart : array (joints, 4), float64
        Rotations about which the others are vectors.
    mean : array (3·joints + R,), float64
        Rotation vectors of the next pose in radians: joint j is `chart_j · exp(mean_j / 2)`. Then the root's steps.
    deviation : array (3·joints + R,), float64
        Standard deviations beside the axes, at least `LEAST_DEVIATION`.
    axes : array (3·joints + R, r), float64
        The covariance is `diag(deviation²) + axes axesᵀ`; r is 0 but for "local_pca".
    """
    count, frames, joints = segments.shape[:3]
    numbers = joints * 3
    chart = mean_chart(segments)
    vectors = seen_from(chart, segments)
    query = seen_from(chart, recent).reshape(-1)
    inputs = vectors[:, :-1].reshape(count, -1)
    outputs = np.concatenate([vectors[:, -1].reshape(count, -1), root_steps.astype(np.float64)], axis=1)
    last = np.zeros(outputs.shape[1])
    if target == "change":
        outputs[:, :numbers] -= inputs[:, -numbers:]
        last[:numbers] = query[-numbers:]
    scale = np.tile(np.repeat(joint_weights, 3), frames - 1)
    inputs = np.concatenate([inputs, signals.astype(np.float64)], axis=1)
    query, scale = (
        np.concatenate([row, np.full(signals.shape[1], x)]) for row, x in ((query, 0.0), (scale, 1.0))
    )
    examples = gather(inputs, outputs, query, scale, bandwidth, ridge)
    mean, spread, axes = predicted(examples, model, deviation, share)
    return chart, last + mean, np.maximum(spread, LEAST_DEVIATION), axes


def predicted(examples: Examples, model: str, deviation: str, share: float) -> tuple[Reals, Reals, Reals]:
    """Mean, deviation and axes of the outputs, `(D,)`, `(D,)` and `(D, r)`."""
    y = examples.outputs
    no_axes = np.zeros((y.shape[1], 0))
    if examples.alone:
        return examples.output_mean, np.full(y.shape[1], UNKNOWN_DEVIATION), no_axes
    if model == "local_pca":
        return principal_component_analysis(examples, share)
    if model == "mean_pose":
        return examples.output_mean, left_out(examples, y), no_axes
    if model == "nearest":
        nearest = y[np.argmax(examples.weights)]
        from_it = y - np.sqrt(examples.weights)[:, None] * nearest
        return examples.output_mean + nearest, left_out(examples, from_it), no_axes
    if model == "local_pcr":
        mean, residuals = principal_component_regression(examples, share)
    else:
        mean, residuals = regression(examples, DIRECTIONS[model])
    return mean, DEVIATIONS[deviation](examples, residuals), no_axes


DIRECTIONS = {"local_regression": "least_squares", "partial_least_squares": "partial_least_squares"}
"""Which direction the regressions take."""
