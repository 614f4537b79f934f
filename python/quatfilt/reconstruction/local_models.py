"""The next pose, from examples of how motion goes on."""

from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from quatfilt import _validation
from quatfilt._backend import ops
from quatfilt._typing import Array

LocalModel: TypeAlias = Literal["local_regression", "local_pcr", "local_pca", "nearest", "mean_pose"]

_MODELS: tuple[LocalModel, ...] = ("local_regression", "local_pcr", "local_pca", "nearest", "mean_pose")

_MOST_RIDGE = 1e6
"""Mean eigenvalues: what is left of a prediction is then its mean to six digits."""


@dataclass(frozen=True)
class PosePrediction:
    """A pose that is predicted, and how far the truth may lie from it.

    Rotation vectors ``v`` are seen from the chart: joint ``j`` is turned by ``chart[j] · exp(v / 2)``. Of ``D = 3·joints + n``
    numbers the first are those vectors, joint by joint, and the last the root's.

    Parameters
    ----------
    pose : ndarray, shape (joints, 4)
        The rotations that the mean stands for.
    root_step : ndarray, shape (n,)
        The last numbers of the mean.
    chart : ndarray, shape (joints, 4)
        Rotations about which the others are vectors.
    mean : ndarray, shape (D,), radians
        What is most likely.
    deviation : ndarray, shape (D,), radians
        Standard deviations beside the axes; at least 0.002. Those of the root's numbers are in their own units.
    axes : ndarray, shape (D, r), radians
        Directions in which the numbers vary together, each as long as they deviate along it: the covariance is
        ``diag(deviation²) + axes axesᵀ``. Only "local_pca" has any.

    Examples
    --------
    >>> import numpy as np, quatfilt as qf
    >>> swing = qf.exp(0.4 * np.sin(np.arange(300) / 20)[:, None, None] * [[0.0, 0.0, 1.0]])
    >>> segments = np.stack([swing[start : start + 4] for start in range(0, 250, 8)])
    >>> prediction = qf.predict_pose(segments, swing[260:263])
    >>> isinstance(prediction, qf.PosePrediction)
    True
    """

    pose: Array
    root_step: NDArray[np.float64]
    chart: NDArray[np.float64]
    mean: NDArray[np.float64]
    deviation: NDArray[np.float64]
    axes: NDArray[np.float64]


def predict_pose(
    segments: ArrayLike,
    recent: ArrayLike,
    *,
    root_steps: ArrayLike | None = None,
    model: LocalModel = "local_regression",
    direction: Literal["least_squares", "partial_least_squares"] = "least_squares",
    target: Literal["pose", "change"] = "pose",
    deviation: Literal["predictive", "leave_one_out"] = "predictive",
    joint_weights: ArrayLike | None = None,
    bandwidth: float | Literal["auto"] = "auto",
    ridge: float = 0.01,
    variance: float = 0.99,
    scalar_first: bool = True,
) -> PosePrediction:
    """Predict the next pose by a local model: from the few examples in a database that are most like the last poses.

    Parameters
    ----------
    segments : array_like, shape (K, m + 1, joints, 4)
        Examples: ``m`` poses, the oldest first, and the one that followed. The root's rotation should be seen from the
        heading of the last pose but one, as that of `recent` is seen from its last.
    recent : array_like, shape (m, joints, 4)
        The last poses, the oldest first.
    root_steps : array_like or None, shape (K, n), default None
        Whatever else of the next pose is to be predicted: steps of the root, its height, how it turns.
    model : {"local_regression", "local_pcr", "local_pca", "nearest", "mean_pose"}, default "local_regression"
        Regression along one direction of the inputs for each number [1]_; on their principal components [2]_; mean and
        principal subspace of the examples' next poses [3]_; the next pose of the nearest example; the mean of them all.
    direction : {"least_squares", "partial_least_squares"}, default "least_squares"
        The direction of "local_regression".
    target : {"pose", "change"}, default "pose"
        Whether poses are predicted or their changes from the last one. Changes are predicted better as long as the last pose
        is right; poses lead back to the examples where it is not.
    deviation : {"predictive", "leave_one_out"}, default "predictive"
        How the deviations of the regressions are taken: from the residuals of the examples, each left out in turn; and,
        unless these alone are asked for, the larger the further the query lies beside the examples.
    joint_weights : array_like or None, shape (joints,), default None
        How joints count in the squared distances that weigh examples; None counts all alike.
    bandwidth : "auto" or float, radians, default "auto"
        Examples weigh ``exp(−(d² − d₀²) / 2s²)``, where ``d`` is the distance of their rotation vectors from the query's and
        ``d₀`` the least of them. ``s`` is `bandwidth`, 1 for what the paper prints, or the median of the distances.
    ridge : float, default 0.01
        What is added to the variance of the inputs in every direction, in shares of the mean of the K largest.
    variance : float, default 0.99
        Share of the variance that principal components make up.
    scalar_first : bool, default True
        Whether quaternions are ``(w, x, y, z)``; False for SciPy's ``(x, y, z, w)``. The chart has the same order.

    Returns
    -------
    PosePrediction
        Its pose has the dtype of the rotations; all else is float64.

    Raises
    ------
    ValueError, TypeError
        If an argument has another shape, type or range than stated, or a sample is missing; the message names it.

    Notes
    -----
    Examples should lie apart in time. The frames of a database that are nearest to the last poses are neighbours in a few
    clips, and say the same again and again; of examples that begin at every eighth frame, at 60 frames per second, the nearest
    64 halve the error of the regressions.

    Of one example alone, or of one that has all of the weight, deviations are 0.2.

    Cost: ``K²·m·joints + K³``. 64 examples of 3 poses of 31 joints take 0.3 ms on one core.

    References
    ----------
    .. [1] C. Mousas, P. Newbury, C.-N. Anagnostopoulos, "Data-driven motion reconstruction using local regression models",
       AIAI 2014.
    .. [2] H. Liu, X. Wei, J. Chai, I. Ha, T. Rhee, "Realtime human motion control with a small number of inertial sensors",
       I3D 2011.
    .. [3] J. Chai, J. K. Hodgins, "Performance animation from low-dimensional control signals", ACM Transactions on Graphics
       24, 2005.

    Examples
    --------
    >>> import numpy as np, quatfilt as qf
    >>> swing = qf.exp(0.4 * np.sin(np.arange(300) / 20)[:, None, None] * [[0.0, 0.0, 1.0]])
    >>> segments = np.stack([swing[start : start + 4] for start in range(0, 250, 8)])
    >>> prediction = qf.predict_pose(segments, swing[260:263])
    >>> error = qf.geodesic_distance(prediction.pose, swing[263])
    >>> bool(np.degrees(error).max() < 0.5)
    True
    """
    examples, poses = _validation.segments(segments, recent, scalar_first=scalar_first)
    steps = _validation.root_steps(root_steps, examples)
    weights = _validation.joint_weights(joint_weights, examples.shape[2])
    kind: str = _validation.choice(model, "model", _MODELS)
    way = _validation.choice(direction, "direction", ("least_squares", "partial_least_squares"))
    if kind == "local_regression" and way == "partial_least_squares":
        kind = way
    if isinstance(bandwidth, str):
        reach = 0.0
        _validation.known(bandwidth, "bandwidth", ("auto",), "'auto' or a number")
    else:
        reach = _validation.number(bandwidth, "bandwidth", at_least=1e-6)
    chart, mean, spread, axes = ops().predict_pose(
        examples,
        steps,
        np.zeros((len(examples), 0), examples.dtype),
        poses,
        weights,
        kind,
        _validation.choice(target, "target", ("pose", "change")),
        _validation.choice(deviation, "deviation", ("predictive", "leave_one_out")),
        reach,
        _validation.number(ridge, "ridge", at_least=1e-9, at_most=_MOST_RIDGE),
        _validation.number(variance, "variance", above=0, at_most=1),
    )
    numbers = 3 * len(chart)
    rotations = ops().multiply(chart, ops().exp(mean[:numbers].reshape(-1, 3) / 2))
    return PosePrediction(
        pose=_validation.scalar_order(rotations.astype(poses.dtype), scalar_first=scalar_first),
        root_step=mean[numbers:],
        chart=np.asarray(_validation.scalar_order(chart, scalar_first=scalar_first), np.float64),
        mean=mean,
        deviation=spread,
        axes=axes,
    )


__all__ = ["LocalModel", "PosePrediction", "predict_pose"]
