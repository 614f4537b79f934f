"""A Gaussian process from latent coordinates to poses, whose points and constants were learned elsewhere."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

STEPS = 50
"""Steps of the search for a latent point, at most; ten to thirty are usual."""


LEAST_NOISE = 1e-6
"""Of the variance of the process, how much the noise has at least: with less, roundings decide what is between the poses."""


@dataclass(frozen=True)
class LatentProcess:
    """Poses ``f(x)`` of latent points: covariance ``v exp(−|x − x'|² / 2l²) + b`` for each number alike, and noise."""

    points: Floats
    """Latent points of the poses that were learned from, ``(N, q)``."""
    outputs: Floats
    """Their poses less the mean, ``(N, D)``."""
    variance: float
    """``v``, squared radians."""
    length: float
    """``l``."""
    bias: float
    """``b``, squared radians."""
    noise: float
    """Variance of the noise, squared radians."""
    inverse: Floats
    """Inverse of the covariance of the outputs, ``(N, N)``."""
    factors: Floats
    """The inverse times the outputs, ``(N, D)``."""

    @classmethod
    def of(
        cls, points: Floats, outputs: Floats, *, variance: float, length: float, bias: float, noise: float
    ) -> "LatentProcess":
        """Prepare predictions."""
        squares = np.sum((points[:, None] - points) ** 2, axis=-1)
        covariance = variance * np.exp(squares / (-2 * length**2)) + bias
        noise = max(noise, LEAST_NOISE * (variance + bias))
        inverse = np.linalg.inv(covariance + noise * np.eye(len(points)))
        return cls(points, outputs, variance, length, bias, noise, inverse, inverse @ outputs)

    def at(self, x: Floats) -> tuple[Floats, float, Floats, Floats]:
        """Return mean ``(D,)`` and variance of the numbers at a latent point, and how they change with it, ``(q, D)`` and ``(q,)``."""
        apart = x - self.points
        local = self.variance * np.exp(np.sum(apart**2, axis=1) / (-2 * self.length**2))
        seen = local + self.bias
        change = local[:, None] * apart / -(self.length**2)
        solution = self.inverse @ seen
        variance = self.variance + self.bias + self.noise - float(seen @ solution)
        # Rounding may eat up what is left, but not the noise.
        mean = seen @ self.factors
        return mean, max(variance, self.noise), change.T @ self.factors, -2 * (change.T @ solution)

    def find(self, pose: Floats) -> Floats:
        """Return the latent point that is most likely for the first numbers of a pose, less the mean, from the most similar pose on.

        It minimises ``|y − f(x)|² / 2σ²(x) + (D/2) ln σ²(x) + |x|² / 2`` (Grochow et al. 2004, eq. 6, with equal weights).
        """
        from scipy.optimize import minimize  # noqa: PLC0415 - SciPy is loaded when it is needed

        count = len(pose)

        def objective(x: Floats) -> tuple[float, Floats]:
            mean, variance, change, variance_change = self.at(x)
            rest = pose - mean[:count]
            square = float(rest @ rest)
            value = square / (2 * variance) + count / 2 * np.log(variance) + float(x @ x) / 2
            by_variance = (count - square / variance) / (2 * variance)
            return value, by_variance * variance_change - change[:, :count] @ rest / variance + x

        start = self.points[np.argmin(np.sum((self.outputs[:, :count] - pose) ** 2, axis=1))]
        found = minimize(objective, start, jac=True, method="L-BFGS-B", options={"maxiter": STEPS})
        return np.asarray(found.x, np.float64)


__all__ = ["LatentProcess"]
