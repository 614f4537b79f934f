"""The picture of a segmentation: the growth of the error, its limit, and the motion below."""

from pathlib import Path

import numpy as np

from quatfilt._typing import Array
from quatfilt.evaluation._plot import CYCLE, figure, quiet
from quatfilt.geodesics.segment import Segments
from quatfilt.motion.motion import Motion
from quatfilt.rotations.mean import mean
from quatfilt.rotations.quaternion import geodesic_distance

_BRIGHTEST = 97
"""Percentile of the turns that has the darkest colour."""


def draw(motion: Motion, found: Segments, path: Path, *, title: str) -> None:
    """Draw into a file; raises ImportError without matplotlib."""
    page = figure(11.0, 6.5)
    growth, turns = page.subplots(2, 1, sharex=True, height_ratios=(1, 2))
    seconds = np.arange(len(motion)) / motion.fps
    growth.plot(seconds, found.growth, color=CYCLE[0], linewidth=1.2, label="growth of the error")
    growth.plot(seconds, found.limit, color=CYCLE[1], linewidth=1.0, label="limit")
    growth.legend(frameon=False, loc="upper left", ncols=2)
    growth.set_ylabel("sin² of half angles")
    growth.set_title(title, loc="left", fontsize=10)
    away = _away(motion.rotations)
    top = float(np.nanpercentile(away, _BRIGHTEST)) if away.size else 1.0
    turns.imshow(
        np.minimum(away.T, top),
        aspect="auto",
        interpolation="nearest",
        cmap="Greys",
        extent=(0.0, len(motion) / motion.fps, len(motion.skeleton) - 0.5, -0.5),
    )
    turns.set_yticks(range(len(motion.skeleton)), motion.skeleton.names, fontsize=6)
    turns.set_xlabel("seconds; darker: farther from the joint's mean")
    quiet(growth)
    for cut in found.cuts / motion.fps:
        for axes in (growth, turns):
            axes.axvline(cut, color=CYCLE[1], linewidth=1.2, linestyle="--")
    page.savefig(path)


def _away(rotations: Array) -> Array:
    """Return the angle of every sample to the mean of its joint, in degrees."""
    return np.degrees(geodesic_distance(rotations, mean(rotations)[None]))


__all__ = ["draw"]
