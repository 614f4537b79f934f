"""Figures 2 to 4 of Courty's bilateral filter, the filters its section 3.2 sets aside, and its time."""

from collections.abc import Callable
from pathlib import Path

from quatfilt.evaluation import bilateral_figs_parts
from quatfilt.evaluation.bilateral_figs_conditions import CLIP, JOINTS, START, THINNING, cut
from quatfilt.evaluation.bilateral_figs_results import Figures
from quatfilt.evaluation.clips import load, thinned


def run(data: Path | None, *, seeds: int, progress: Callable[[int, int], None] | None = None) -> Figures:
    """Compute everything that the figures show.

    Parameters
    ----------
    data : Path or None
        Folder of CMU's recordings; None for the built-in walk.
    seeds : int
        How many noises.
    progress : callable or None, default None
        Is told how many of how many parts are done.

    Returns
    -------
    Figures
        The numbers behind the figures.
    """
    clip = load(data, CLIP)[0]
    motions = [cut(thinned(clip, every).motion, START[clip.name]) for every in THINNING]
    joint, hand = JOINTS[clip.name]
    parts = len(motions) + 3
    tell = progress or (lambda _done, _total: None)
    curves = []
    for motion in motions:
        curves.append(bilateral_figs_parts.curves(motion, joint, seeds))
        tell(len(curves), parts)
    compared = bilateral_figs_parts.comparisons(motions[0], seeds)
    tell(len(motions) + 1, parts)
    timings = bilateral_figs_parts.timings(motions[0])
    tell(len(motions) + 2, parts)
    drawn = bilateral_figs_parts.drawn(motions[0], joint, hand)
    tell(parts, parts)
    return Figures(
        clip=clip.name,
        what=clip.what,
        start=START[clip.name],
        curves=tuple(curves),
        comparisons=compared,
        sparse=tuple(bilateral_figs_parts.sparse(step) for step in (2.0, 15.0, 60.0, 120.0)),
        timings=timings,
        drawn=drawn,
    )


__all__ = ["run"]
