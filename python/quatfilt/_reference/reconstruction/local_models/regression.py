"""Regression along one direction for each output (Mousas, Newbury and Anagnostopoulos 2014)."""

import numpy as np

from quatfilt._reference._arrays import Reals
from quatfilt._reference.reconstruction.local_models.examples import LEAST_LEFT, Examples


def regression(examples: Examples, direction: str) -> tuple[Reals, Reals]:
    """Predict each output along the one direction of the inputs that goes with it best.

    The matrix of eqs. (5) to (8) has rank one. Its eigenvector is the direction of the weighted least squares with a ridge,
    `u ∝ (XᵀX + λ I)⁻¹ Xᵀ y = Xᵀ A y` (the weights are in X and y); that of partial least squares is `u ∝ Xᵀ y`. Along it
    the coefficient is fitted again (eq. 9), `γ = (Xu)ᵀy / |Xu|²`.

    Parameters
    ----------
    examples : Examples
    direction : "least_squares" or "partial_least_squares"

    Returns
    -------
    mean : array (D,)
    residuals : array (K, D)
        `√ω_k (y_k − ŷ_k)`, where `ŷ_k` is what the model would predict for example k if it had been left out, means and `γ`
        included, with the same ridge.
    """
    y = examples.outputs
    least_squares = direction == "least_squares"
    operator: Reals
    dual: Reals
    along: Reals
    if least_squares:
        # H = G A = I − λ A.
        operator = np.eye(len(y)) - examples.ridge * examples.inverse
        dual = examples.inverse @ y
        rest = examples.ridge * dual
        along = y - rest
    else:
        operator, dual = examples.gram, y
        along = operator @ y
    factor = quotient(np.sum(along * y, axis=0), np.sum(along * along, axis=0))
    mean = examples.output_mean + factor * (examples.query_products @ dual)

    # Without example k the means move, by which all that is left of the example itself grows by b = Σω / (Σω − ω_k). Its
    # product with x_k then leaves XᵀX and Xᵀy, and u moves by −κ times column k of what leads from y to u.
    growth = (1 / np.maximum(1 - examples.weights / examples.total, LEAST_LEFT))[:, None]
    change = rest / examples.left[:, None] if least_squares else growth * y
    diagonal = np.diag(operator)[:, None]
    here = along - change * diagonal
    product = np.sum(along * y, axis=0) - change * along - growth * y * here
    whole = np.sum(along * along, axis=0)
    square = (
        whole
        - 2 * change * (operator @ along)
        + change**2 * np.sum(operator**2, axis=0)[:, None]
        - growth * here**2
    )
    square = np.where(square > LEAST_LEFT * whole, square, 0)
    return mean, growth * (y - quotient(product, square) * here)


def quotient(product: Reals, square: Reals) -> Reals:
    """`product / square`, and 0 where the square is 0."""
    positive = square > 0
    return np.where(positive, product / np.where(positive, square, 1), 0.0)
