"""The noise that the tables add to clean clips."""

import math
from dataclasses import dataclass

import numpy as np

from quatfilt._typing import Array
from quatfilt.evaluation.clips import Clip
from quatfilt.noise.noise import add_gaussian_noise, add_impulse_noise

SIGMA = 0.016
"""Radians: the paper's σ = 0.008 of log-quaternions, as a rotation."""

MULTIPLES = (1, 5, 15, 30, 50, 75, 100)

IMPULSES = 0.01
MAGNITUDE = (math.radians(10), math.radians(60))


@dataclass(frozen=True)
class Noise:
    """One column of the table."""

    name: str
    multiple: int | None
    """Deviation in units of `SIGMA`; None for impulses."""

    @property
    def wrapped(self) -> float:
        """Share of the samples that the noise turns by more than half a turn: they come out as smaller turns."""
        if self.multiple is None:
            return 0.0
        # The length of three normal components has the chi distribution with three degrees of freedom.
        x = math.pi / (self.multiple * SIGMA)
        return math.erfc(x / math.sqrt(2)) + math.sqrt(2 / math.pi) * x * math.exp(-x * x / 2)

    def add(self, q: Array, rng: np.random.Generator) -> Array:
        """Return noisy rotations."""
        if self.multiple is None:
            return add_impulse_noise(q, probability=IMPULSES, magnitude=MAGNITUDE, rng=rng)
        return add_gaussian_noise(q, sigma=self.multiple * SIGMA, rng=rng)


NOISES = (*(Noise(f"{multiple}σ", multiple) for multiple in MULTIPLES), Noise("impulses", None))


def versions(clip: Clip, noise: Noise, seeds: int) -> list[Array]:
    """Return the steady joints of a clip with noises that the seed, the clip's name and the noise's name choose."""
    return [
        noise.add(
            clip.steady_rotations, np.random.default_rng([seed, *clip.name.encode(), *noise.name.encode()])
        )
        for seed in range(seeds)
    ]


__all__ = ["NOISES", "SIGMA", "Noise", "versions"]
