"""Whether trajectories are in the unit of a database."""

import math

import numpy as np

from quatfilt.reconstruction.reconstructor.examples import Examples, extent
from quatfilt.reconstruction.reconstructor.trajectories import Trajectories

CONVERSIONS = (10.0, 100.0, 1000.0)
"""Between millimetres, centimetres, decimetres and metres."""

ALIKE = 1.5
"""Ratio up to which two sizes are alike: poses differ in how far their points are apart."""

UNLIKE = 3.0
"""Ratio from which on two sizes are not: no pose differs so much."""


def check(seen: Trajectories, examples: Examples) -> None:
    """Refuse trajectories that fit the database but for their unit.

    Raises
    ------
    ValueError
        If distances and heights of the points are both off by the factor of a known conversion.
    """
    known = np.where(seen.position_weights[..., None] > 0, seen.positions, np.nan)
    ours, theirs = extent(known, examples.database.up), examples.extent
    unit = examples.database.skeleton.centimetres_per_unit
    ratios = [a / b for a, b in zip(ours, theirs, strict=True) if b > 0 and a > 0]
    for factor in sorted({*CONVERSIONS, unit, 10 * unit, unit / 10, unit / 100}):
        for ratio in (factor, 1 / factor):
            off = max(ratio, 1 / ratio) >= UNLIKE
            if off and ratios and all(_alike(ratio, found) for found in ratios):
                raise ValueError(
                    f"positions: expected the unit of the database, {unit:.4g} cm, got points that are {_times(ratios[0])} "
                    f"as far apart as its own: multiplied by {1 / ratio:.4g}, they would fit"
                )


def _alike(a: float, b: float) -> bool:
    return abs(math.log(a / b)) <= math.log(ALIKE)


def _times(ratio: float) -> str:
    return f"{ratio:.3g} times"
