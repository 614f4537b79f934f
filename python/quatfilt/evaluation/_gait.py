"""The rhythm of a walk, which all parts of the body follow."""

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

Values: TypeAlias = NDArray[np.float64]

CYCLE = 1.08
"""Seconds from one strike of a foot to its next."""

STRIDE = 128.0
"""Centimetres between them."""


@dataclass
class Gait:
    """What all parts of the body follow."""

    time: Values
    phase: Values
    """Cycles since a strike of the left foot."""
    rng: np.random.Generator

    def wave(self, harmonic: int, lag: float) -> Values:
        """Cosine of a harmonic of the cycle, greatest at the phase `lag`, with an amplitude that drifts."""
        return (1 + 0.08 * drift(self.rng, self.time)) * np.cos(2 * np.pi * harmonic * (self.phase - lag))

    def shock(self, hertz: float, decay: float) -> Values:
        """Damped swing that each strike of either foot sets off; decays within `decay` seconds."""
        since = np.mod(self.phase, 0.5) * CYCLE
        return np.exp(-since / decay) * np.sin(2 * np.pi * hertz * since)


def drift(rng: np.random.Generator, time: Values) -> Values:
    """Slow random curve of size 1: no two steps are the same."""
    hertz = rng.uniform(0.05, 0.7, 4)
    phase = rng.uniform(0, 2 * np.pi, 4)
    return np.asarray(np.sin(2 * np.pi * hertz * time[:, None] + phase).sum(axis=1) / np.sqrt(2))


def turn(order: str, *degrees: Values) -> Rotation:
    """Rotations about the axes of `order`, in degrees, the last first."""
    return Rotation.from_euler(order.upper(), np.stack(degrees, axis=-1), degrees=True)


def pitched(radians: Values) -> Rotation:
    """Rotations about the x axis: forward and down."""
    return Rotation.from_rotvec(radians[:, None] * [1.0, 0.0, 0.0])
