"""The walk of `quatfilt demo`: true, with noise, and cleaned."""

from dataclasses import dataclass

import numpy as np

from quatfilt import _validation
from quatfilt.denoise import denoise
from quatfilt.evaluation.synthetic import walk
from quatfilt.motion.motion import Motion
from quatfilt.noise.noise import add_gaussian_noise

SIGMA = 0.016
"""Radians per component of the rotation vector: the lowest noise of Dean and Lewis's Table I."""

SIGMA_TRANSLATION = 0.3
"""Centimetres per coordinate of the root."""


@dataclass(frozen=True)
class Demonstration:
    """One walk three times."""

    truth: Motion
    noisy: Motion
    denoised: Motion


def demonstrate(*, seed: int = 0, seconds: float = 8.0, sigma: float = SIGMA) -> Demonstration:
    """Make a walk, add noise to it, and clean it with the defaults of `denoise`.

    Parameters
    ----------
    seed : int, default 0
        Chooses the walk and the noise.
    seconds : float, seconds, default 8.0
        Length of the walk.
    sigma : float, radians, default 0.016
        Deviation of the noise per component of the rotation vector.

    Returns
    -------
    Demonstration
        The three motions.
    """
    rng = np.random.default_rng([_validation.integer(seed, "seed", at_least=0), 1])
    truth = walk(seconds=seconds, seed=seed)
    noisy = truth.replace(
        rotations=add_gaussian_noise(truth.rotations, sigma=sigma, rng=rng),
        translation=truth.translation + SIGMA_TRANSLATION * rng.standard_normal(truth.translation.shape),
    )
    return Demonstration(truth, noisy, denoise(noisy))


__all__ = ["SIGMA", "SIGMA_TRANSLATION", "Demonstration", "demonstrate"]
