"""Whether trajectories are in the unit of a database."""

import math

import numpy as np

from quatfilt.reconstruction.reconstructor.examples import Examples, extents
from quatfilt.reconstruction.reconstructor.trajectories import Trajectories

CONVERSIONS = (10.0, 100.0, 1000.0)
"""Between millimetres, centimetres, decimetres and metres."""

ALIKE = 2.0
"""Ratio up to which two sizes are alike: poses differ in how far their points are apart, and how high."""

UNLIKE = 3.0
"""Ratio from which on two sizes are not: no pose differs so much."""


def check(seen: Trajectories, examples: Examples) -> None:
    """Refuse trajectories that fit the database but for their unit.

    Points that are never seen are left out. A size that some pose of the database has tells nothing: a toe on the ground is a
    tenth as high as a toe usually is.

    Raises
    ------
    ValueError
        If distances and heights of the points are both off by the factor of a known conversion.
    """
    places = np.where(seen.position_weights[..., None] > 0, seen.positions, np.nan)
    used = np.logical_or.reduce(seen.position_weights > 0, axis=0)
    ours, theirs = extents(places[:, used], examples.database.up), examples.extents(used)
    if not ours.size:
        return
    sizes, usual = np.median(ours, axis=1), np.median(theirs, axis=1)
    telling = (sizes > 0) & (usual > 0)
    met = (theirs.min(axis=1) <= sizes) & (sizes <= theirs.max(axis=1))
    if not telling.any() or met[telling].any():
        return
    unit = examples.database.skeleton.centimetres_per_unit
    ratios = sizes[telling] / usual[telling]
    factors = {*CONVERSIONS, unit, 10 * unit, unit / 10, unit / 100}
    conversions = [
        ratio
        for factor in factors
        for ratio in (factor, 1 / factor)
        if abs(math.log(ratio)) >= math.log(UNLIKE)
    ]
    missed, ratio = min((float(np.abs(np.log(ratios / ratio)).max()), ratio) for ratio in conversions)
    if missed <= math.log(ALIKE):
        raise ValueError(
            f"positions: expected the unit of the database, {unit:.4g} cm, got points that are {ratios[0]:.3g} times "
            f"as far apart as its own: multiplied by {1 / ratio:.4g}, they would fit"
        )
