"""A latent variable model of poses."""

import warnings

import numpy as np
from numpy.typing import ArrayLike, NDArray

from quatfilt import _validation
from quatfilt._backend import ops
from quatfilt._extras import extra
from quatfilt.reconstruction._latent import LatentProcess
from quatfilt.reconstruction.local_models import PosePrediction

MOST_POSES = 2000
"""Poses that a model learns from at most: the cost is cubic."""

_LEAST_DEVIATION = 0.002
"""Radians, and units of the root's numbers; as for local models."""

_LATENT_DEVIATION = 0.1
"""How far the latent point of the next pose may lie from that of the last, in units of its prior's deviation: the likelihood
of the poses of people who were left out is greatest there, and changes by 2 % between 0.05 and 0.2."""

_SMALLEST_SPREAD = 1e-9
"""Numbers of the root that spread less are constant."""


class PoseGPLVM:
    """Gaussian process latent variable model of poses, the baseline of style-based inverse kinematics.

    A pose is a smooth function of a few latent numbers, which are learned with it from a subset of poses by GPy
    (``pip install 'quatfilt[gplvm]'``). Unlike the models of `predict_pose` it is learned once, and knows no motion.

    Parameters
    ----------
    poses : array_like, shape (N, joints, 4)
        Unit quaternions without missing samples. The root's rotation should be seen from its heading.
    root_steps : array_like or None, shape (N, n), default None
        Other numbers of each pose: steps of the root, its height, how it turns.
    dimensions : int, default 6
        Latent numbers.
    subset : int, default 500
        How many poses are learned from, evenly spaced among all; at most 2000.
    iterations : int, default 100
        Steps of GPy's optimiser (L-BFGS-B).
    scalar_first : bool, default True
        Whether quaternions are ``(w, x, y, z)``; False for SciPy's ``(x, y, z, w)``.

    Raises
    ------
    ImportError
        Without GPy.
    ValueError, TypeError
        If an argument has another shape, type or range than stated; the message names it.

    Notes
    -----
    Cost: ``subset³`` for each step: 500 poses take 15 seconds, 1000 two minutes. A prediction takes ``subset²`` for each of ten
    to thirty steps, some milliseconds.

    References
    ----------
    .. [1] K. Grochow, S. L. Martin, A. Hertzmann, Z. Popović, "Style-based inverse kinematics", ACM Transactions on Graphics
       23, 2004.
    .. [2] N. D. Lawrence, "Gaussian process latent variable models for visualisation of high dimensional data", NIPS 2003.

    Examples
    --------
    >>> import numpy as np, quatfilt as qf
    >>> swing = qf.exp(0.4 * np.sin(np.arange(90) / 10)[:, None, None] * [[0.0, 0.0, 1.0], [0.0, 1.0, 0.0]])
    >>> model = qf.PoseGPLVM(swing, dimensions=1, subset=30, iterations=20)
    >>> prediction = model.predict_pose(swing[40:41])
    >>> bool(np.degrees(qf.geodesic_distance(prediction.pose, swing[40]).max()) < 1)
    True
    """

    def __init__(
        self,
        poses: ArrayLike,
        *,
        root_steps: ArrayLike | None = None,
        dimensions: int = 6,
        subset: int = 500,
        iterations: int = 100,
        scalar_first: bool = True,
    ) -> None:
        every = _validation.quaternions(poses, "poses", scalar_first=scalar_first)
        if every.ndim != 3 or len(every) < 2 or every.shape[1] < 1:
            raise ValueError(
                f"poses: expected shape (N, joints, 4) with at least two poses, got {every.shape}"
            )
        _, missing = _validation.clip(every, "poses")
        if missing:
            raise ValueError(f"poses: expected no missing samples, got {missing}")
        steps = _validation.root_steps(root_steps, every)
        most = min(every.shape[1] * 3 + steps.shape[1], len(every) - 1)
        latent = _validation.integer(dimensions, "dimensions", at_least=1, at_most=most)
        count = _validation.integer(subset, "subset", at_least=latent + 1, at_most=MOST_POSES)
        limit = _validation.integer(iterations, "iterations", at_least=1)
        used = np.unique(np.linspace(0, len(every) - 1, min(count, len(every))).round().astype(int))
        self._scalar_first = scalar_first
        self._chart = ops().mean(every[used], None).astype(np.float64)
        numbers = np.concatenate([self._vectors(every[used]), steps[used].astype(np.float64)], axis=1)
        spread = numbers.std(axis=0)
        angles = 3 * len(self._chart)
        usual = np.sqrt(np.mean(spread[:angles] ** 2))
        # The process has one variance for all numbers: those of the root are brought to that of the angles.
        self._scale = np.ones(len(spread))
        varies = spread[angles:] > _SMALLEST_SPREAD
        self._scale[angles:][varies] = spread[angles:][varies] / max(usual, _SMALLEST_SPREAD)
        self._mean = numbers.mean(axis=0)
        self._process = _learn((numbers - self._mean) / self._scale, latent, limit)

    @property
    def poses(self) -> int:
        """How many poses were learned from."""
        return len(self._process.points)

    def predict_pose(self, recent: ArrayLike) -> PosePrediction:
        """Predict the next pose: that of the latent point which is most likely for the last one.

        Parameters
        ----------
        recent : array_like, shape (m, joints, 4)
            The last poses, of which the last one counts, in the order of components of the model's poses.

        Returns
        -------
        PosePrediction
            Its axes are how the pose changes with the latent numbers.

        Raises
        ------
        ValueError, TypeError
            If the poses have another shape than stated, or a sample is missing.

        Examples
        --------
        >>> import numpy as np, quatfilt as qf
        >>> swing = qf.exp(0.4 * np.sin(np.arange(90) / 10)[:, None, None] * [[0.0, 0.0, 1.0], [0.0, 1.0, 0.0]])
        >>> model = qf.PoseGPLVM(swing, dimensions=1, subset=30, iterations=20)
        >>> model.predict_pose(swing[40:41]).axes.shape
        (6, 1)
        """
        last = _validation.quaternions(recent, "recent", scalar_first=self._scalar_first)
        joints = len(self._chart)
        if last.ndim != 3 or len(last) < 1 or last.shape[1] != joints:
            raise ValueError(
                f"recent: expected shape (m, {joints}, 4) as the model's poses, got {last.shape}"
            )
        _, missing = _validation.clip(last[-1:], "recent")
        if missing:
            raise ValueError(f"recent: expected no missing samples, got {missing}")
        angles = 3 * joints
        here = (self._vectors(last[-1:])[0] - self._mean[:angles]) / self._scale[:angles]
        point = self._process.find(here)
        mean, variance, change, _ = self._process.at(point)
        mean = self._mean + self._scale * mean
        rotations = ops().multiply(self._chart, ops().exp(mean[:angles].reshape(-1, 3) / 2))
        return PosePrediction(
            pose=_validation.scalar_order(rotations.astype(last.dtype), scalar_first=self._scalar_first),
            root_step=mean[angles:],
            chart=np.asarray(
                _validation.scalar_order(self._chart, scalar_first=self._scalar_first), np.float64
            ),
            mean=mean,
            deviation=np.maximum(self._scale * np.sqrt(variance), _LEAST_DEVIATION),
            axes=_LATENT_DEVIATION * self._scale[:, None] * change.T,
        )

    def _vectors(self, q: NDArray[np.floating]) -> NDArray[np.float64]:
        """Rotation vectors of poses seen from the chart, the shorter way, ``(N, 3·joints)``."""
        wide = q.reshape(-1, 4).astype(np.float64)
        turned = ops().multiply(np.tile(ops().conjugate(self._chart), (len(q), 1)), wide)
        short = turned * np.where(turned[:, :1] < 0, -1.0, 1.0)
        vectors: NDArray[np.float64] = 2 * ops().log(short).reshape(len(q), -1)
        return vectors


def _learn(outputs: NDArray[np.float64], dimensions: int, iterations: int) -> LatentProcess:
    """Learn latent points and constants with GPy, from principal components on."""
    with warnings.catch_warnings():
        # Of GPy's and of the optimiser's first steps.
        warnings.simplefilter("ignore")
        gpy = extra("GPy", "GPy", "gplvm", "latent variable models")
        left, sizes, _ = np.linalg.svd(outputs, full_matrices=False)
        scores = left[:, :dimensions] * sizes[:dimensions]
        start = scores / np.maximum(scores.std(axis=0), _SMALLEST_SPREAD)
        kernel = gpy.kern.RBF(dimensions) + gpy.kern.Bias(dimensions)
        model = gpy.models.GPLVM(outputs, dimensions, X=start, kernel=kernel)
        model.optimize("lbfgsb", max_iters=iterations, messages=False)
    return LatentProcess.of(
        np.array(model.X),
        outputs,
        variance=float(model.kern.rbf.variance[0]),
        length=float(model.kern.rbf.lengthscale[0]),
        bias=float(model.kern.bias.variance[0]),
        noise=float(model.likelihood.variance[0]),
    )


__all__ = ["MOST_POSES", "PoseGPLVM"]
