"""A joint in the coordinates of a frame: how many of them are needed, and how exactly."""

import numpy as np

from quatfilt._reference._arrays import Reals
from quatfilt._reference.geodesics.compress import chart
from quatfilt._reference.geodesics.compress.arithmetic import Doubles, sin_cos

COMPONENTS = 3
"""Coordinates of a rotation."""

SHARE = 0.7
"""Part of the tolerance that coordinates which are left out may take."""

MARGIN = 0.97
"""Of a step: numbers are computed in 1/64 of it, and their rounding must fit too."""

FARTHEST = 1e5
"""Coordinates are smaller (radians): sines beyond lose digits."""


class Fit:
    """Coordinates of valid samples in a frame, as it can be stored."""

    def __init__(self, valid: Doubles, frame: Reals, width: int) -> None:
        self.width = width
        self.numbers = [chart.rounded(q, width) for q in frame]
        self.centre, self.axes = (chart.from_rounded(numbers, width) for numbers in self.numbers)
        self.s = chart.coordinates(valid, self.centre, self.axes)
        s1, s2, s3 = self.s.T
        self.farthest = float(np.abs(self.s).max())
        self.left = [
            2.0 * float(np.sqrt(s1 * s1 + s2 * s2 + s3 * s3).max()),
            2.0 * float(np.sqrt(s2 * s2 + s3 * s3).max()),
            2.0 * float(np.abs(s3).max()),
            0.0,
        ]
        # The first and the last axis are orthogonal only where the turn between them is 0.
        self.skew = float(np.abs(sin_cos(2.0 * s2)[0]).max()) if self.farthest < FARTHEST else 1.0

    def components(self, bound: float) -> int:
        """Return how many coordinates are needed."""
        return next(k for k, left in enumerate(self.left) if left <= SHARE * bound)

    def step(self, components: int, bound: float) -> float:
        """Return a step whose errors stay within the bound, as it can be stored."""
        left = min(self.left[components], SHARE * bound)
        axes = components + (2.0 * self.skew if components == COMPONENTS else 0.0)
        return MARGIN * float(np.sqrt(bound * bound - left * left)) / float(np.sqrt(axes))
