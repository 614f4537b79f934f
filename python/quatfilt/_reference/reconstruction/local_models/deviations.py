"""How far the truth may lie from a prediction."""

import numpy as np

from quatfilt._reference._arrays import Reals
from quatfilt._reference.reconstruction.local_models.examples import Examples

LEAST_DEVIATION = 0.002
"""Radians, and units of the root's numbers: no prediction is trusted further. A tenth of a degree is what optical motion
capture measures."""

UNKNOWN_DEVIATION = 0.2
"""Radians, and units of the root's numbers: what one example alone can tell of deviations. People differ from the most similar
pose of another by 10 to 12 degrees."""

MOST_GROWTH = 100.0
"""How much more a prediction far from all examples may deviate than those of the examples from each other."""


def left_out(examples: Examples, residuals: Reals) -> Reals:
    """Deviation of the leave-one-out residuals `√ω_k (y_k − ŷ_k)`, `(K, D)` → `(D,)`: `√(Σ r² / Σ ω)`."""
    deviation: Reals = np.sqrt(np.sum(residuals**2, axis=0) / examples.total)
    return deviation


def predictive(examples: Examples, residuals: Reals) -> Reals:
    """Deviation at the query, from leave-one-out residuals `(K, D)` → `(D,)`.

    A ridge regression is the mean of a Gaussian process with a linear covariance and noise of variance `s λ`. Seen from the
    others, example k has the variance `s / A_kk`, and the query `s (λ + x²)`, where x is what the examples do not show of
    it. The scale `s` of each output is what makes the first fit the residuals: `s = Σ r² A_kk / Σ ω`.

    Leave-one-out residuals alone are far too small where the query lies beside its examples rather than among them, as it
    does when they are frames of a few other clips.
    """
    scale = np.diag(examples.inverse) @ residuals**2 / examples.total
    most = MOST_GROWTH * left_out(examples, residuals)
    deviation: Reals = np.minimum(np.sqrt(scale * examples.unseen), most)
    return deviation


DEVIATIONS = {"leave_one_out": left_out, "predictive": predictive}
"""The two estimates of the deviations, by name."""
