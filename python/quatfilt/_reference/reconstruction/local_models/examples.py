"""The examples of a local model, weighted and about their means."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from quatfilt._reference._arrays import Reals

LEAST_SQUARE = 1e-12
"""Squared radians that stand for no distance: what roundings of float32 make of a pose of a hundred numbers. It scales weights
where half of the examples are at no distance; examples that are no further from each other are equal."""

LEAST_LEFT = 1e-9
"""In shares of all: thousands of roundings of float64 for each of a thousand examples."""


@dataclass(frozen=True)
class Examples:
    """K examples in the scale of their weights: row k is `√ω_k` times the difference from the mean."""

    weights: Reals
    """`ω_k`, the nearest example's being 1, `(K,)`."""
    inputs: Reals
    """`X`: the poses before, `(K, n)`, radians."""
    outputs: Reals
    """`Y`: what is to be predicted, `(K, D)`."""
    output_mean: Reals
    """`Σ ω y / Σ ω`, `(D,)`."""
    query: Reals
    """The recent poses less the mean of the inputs, `(n,)`, radians."""
    ridge: float
    """`λ`, squared radians."""

    @cached_property
    def total(self) -> float:
        """`Σ ω`."""
        return float(self.weights.sum())

    @property
    def alone(self) -> bool:
        """Whether one example has all of the weight, so that there is nothing to learn from."""
        return self.total - float(self.weights.max()) < LEAST_LEFT * self.total

    @cached_property
    def gram(self) -> Reals:
        """`G = X Xᵀ`, `(K, K)`."""
        return self.inputs @ self.inputs.T

    @cached_property
    def inverse(self) -> Reals:
        """`A = (G + λ I)⁻¹`, `(K, K)`: the dual of the ridge regression, for all outputs at once."""
        return np.linalg.inv(self.gram + self.ridge * np.eye(len(self.gram)))

    @cached_property
    def query_products(self) -> Reals:
        """`X` times the query: what the examples see of it, `(K,)`."""
        return self.inputs @ self.query

    @cached_property
    def left(self) -> Reals:
        """`1 − h_k − ω_k/Σω`: what is left of an example's residual where the fit, whose hat matrix is `H = G A`, sees it."""
        return np.maximum(self.ridge * np.diag(self.inverse) - self.weights / self.total, LEAST_LEFT)

    @cached_property
    def unseen(self) -> float:
        """`λ + x²`, where `x` is the part of the query that the examples do not show: `|x_q|² − (X x_q)ᵀ A (X x_q)`."""
        seen = float(self.query_products @ self.inverse @ self.query_products)
        return self.ridge + max(float(self.query @ self.query) - seen, 0.0)


def gather(
    inputs: Reals, outputs: Reals, query: Reals, scale: Reals, bandwidth: float, ridge: float
) -> Examples:
    """Weigh examples by their distance from the query, and take their means away.

    The weight of example k is `ω_k = exp(−½ (d_k² − d²) / s)`, where `d_k² = (x_k − x_q)ᵀ W (x_k − x_q)`, W is diagonal
    and d is the least of the distances: a factor common to all weights changes no model, and so they do not all underflow.

    Parameters
    ----------
    inputs, outputs, query : arrays (K, n), (K, D), (n,)
        Examples and the recent poses, in a chart.
    scale : array (n,)
        The diagonal of W.
    bandwidth : float, radians
        The root of `s`; with 0, `s` is the median of `d_k²`, the upper one of two.
    ridge : float
        `λ` in shares of the mean of the eigenvalues of `G`, its trace over K.
    """
    squares = np.sum(scale * (inputs - query) ** 2, axis=1)
    spread = np.sort(squares)[len(squares) // 2] if bandwidth == 0 else bandwidth**2
    weights = np.exp(-0.5 * (squares - squares.min()) / max(spread, LEAST_SQUARE))
    roots, total = np.sqrt(weights)[:, None], weights.sum()
    input_mean, output_mean = weights @ inputs / total, weights @ outputs / total
    x, y = roots * (inputs - input_mean), roots * (outputs - output_mean)
    variance = float(np.sum(x * x)) / len(x)
    if variance < LEAST_SQUARE:
        # Any ridge will do: 1 leaves no roundings.
        return Examples(weights, np.zeros_like(x), y, output_mean, query - input_mean, 1.0)
    return Examples(weights, x, y, output_mean, query - input_mean, ridge * variance)
