"""Models along the principal components of the examples."""

import numpy as np

from quatfilt._reference._arrays import Reals
from quatfilt._reference.reconstruction.local_models.deviations import LEAST_DEVIATION
from quatfilt._reference.reconstruction.local_models.examples import LEAST_LEFT, LEAST_SQUARE, Examples


def components(gram: Reals, share: float) -> tuple[Reals, Reals]:
    """Largest eigenvalues of `X Xᵀ` and their vectors, `(r,)` and `(K, r)`: as many as make up a share of the trace."""
    values, vectors = np.linalg.eigh(gram)
    values, vectors = values[::-1], vectors[:, ::-1]
    kept = min(int(np.searchsorted(np.cumsum(values), share * values.sum())) + 1, len(values))
    kept = min(kept, int(np.sum(values > LEAST_EIGENVALUE * max(values[0], LEAST_SQUARE))))
    return values[:kept], vectors[:, :kept]


LEAST_EIGENVALUE = 1e-12
"""In shares of the largest: smaller ones are roundings of float64."""


def principal_component_regression(examples: Examples, share: float) -> tuple[Reals, Reals]:
    """Regression on the principal components of the inputs (Liu et al. 2011): their mean and leave-one-out residuals.

    With `X Xᵀ = U Λ Uᵀ` the prediction is `ȳ + (X x_q)ᵀ U Λ⁻¹ Uᵀ y` over the components that make up `share` of the variance.
    Where an example is left out, the components stay; one that alone decides its own prediction leaves the mean of the others.
    """
    values, vectors = components(examples.gram, share)
    scores = vectors.T @ examples.outputs
    mean = examples.output_mean + ((vectors.T @ examples.query_products) / values) @ scores
    share_of_own = examples.weights / examples.total
    left = (1 - np.sum(vectors**2, axis=1) - share_of_own)[:, None]
    without = examples.outputs / np.maximum(1 - share_of_own, LEAST_LEFT)[:, None]
    residuals = (examples.outputs - vectors @ scores) / np.maximum(left, LEAST_LEFT)
    return mean, np.where(left > LEAST_LEFT, residuals, without)


def principal_component_analysis(examples: Examples, share: float) -> tuple[Reals, Reals, Reals]:
    """Mean and principal subspace of the examples' next poses (Chai and Hodgins 2005): mean, deviation and axes.

    The axes `(D, r)` are the principal directions of the outputs, each as long as the examples deviate along it, for as many
    as make up `share` of the variance; the deviation `(D,)` is what they leave. A pose `ȳ + A s` with standard normal `s` is
    their prior.
    """
    _, vectors = components(examples.outputs @ examples.outputs.T, share)
    axes = examples.outputs.T @ vectors / np.sqrt(examples.total)
    rest = np.sum(examples.outputs**2, axis=0) / examples.total - np.sum(axes**2, axis=1)
    return examples.output_mean, np.sqrt(np.maximum(rest, LEAST_DEVIATION**2)), axes
