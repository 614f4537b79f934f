"""A picture of the principal geodesics of a motion."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from quatfilt._typing import Array
from quatfilt.evaluation._plot import CYCLE, NOISY, TRUTH, figure, quiet
from quatfilt.evaluation.pga_of_motion import Joint, of
from quatfilt.geodesics.pga import PrincipalGeodesicAnalysis
from quatfilt.motion.motion import Motion
from quatfilt.rotations.continuity import continuous
from quatfilt.rotations.quaternion import conjugate, log, multiply

_SHOWN = 3
"""Reconstructions that are drawn."""

_LEAST = 1e-4
"""Degrees: the foot of the logarithmic axis."""


def draw(motion: Motion, joints: Sequence[Joint], file: Path) -> None:
    """Draw `R_k` of the joints, and the one with the widest spread rebuilt from one, two and three geodesics.

    Parameters
    ----------
    motion : Motion
        What was analysed.
    joints : sequence of Joint
        What came out; at least one of them without trouble.
    file : Path
        A ``.png``, ``.pdf`` or ``.svg``.
    """
    known = [joint for joint in joints if not joint.trouble]
    widest = max(known, key=lambda joint: joint.spread)
    page = figure(12.0, 8.0)
    grid = page.add_gridspec(3, 3, width_ratios=(1.0, 1.0, 1.0))
    _residuals(page.add_subplot(grid[:, 0]), known)
    q = of(motion, motion.skeleton.names.index(widest.name))
    fitted = PrincipalGeodesicAnalysis(n_components=min(_SHOWN, len(widest.residuals))).fit(q)
    scores = fitted.transform(q)
    rebuilt = [fitted.inverse_transform(scores[:, :k]) for k in range(1, scores.shape[1] + 1)]
    curves = [_vectors(fitted.mean_, rotations) for rotations in (q, *rebuilt)]
    time = np.arange(len(motion)) / motion.fps
    for row in range(3):
        axes = page.add_subplot(grid[row, 1:])
        axes.plot(time, curves[0][:, row], color=TRUTH, linewidth=2.2, label="recorded")
        for k, curve in enumerate(curves[1:], start=1):
            axes.plot(time, curve[:, row], color=CYCLE[k], linewidth=1.1, label=f"k = {k}")
        quiet(axes)
        axes.set_ylabel(f"{'xyz'[row]} (degrees)")
        if row == 0:
            axes.set_title(
                f"{widest.name}: rotation vector from its mean, rebuilt from k geodesics",
                loc="left",
                fontsize=10,
            )
            axes.legend(frameon=False, fontsize=8, ncols=len(curves), loc="upper right")
        if row < 2:
            axes.tick_params(labelbottom=False)
    axes.set_xlabel("time (seconds)")
    page.savefig(file)


def _residuals(axes: Any, joints: Sequence[Joint]) -> None:
    steps = np.arange(len(joints[0].residuals) + 1)
    curves = [np.degrees([joint.spread, *joint.residuals]) for joint in joints]
    widest = sorted(range(len(joints)), key=lambda place: -joints[place].spread)
    for rank, place in enumerate(widest):
        named = rank < len(CYCLE) - 1
        axes.plot(
            steps,
            np.maximum(curves[place], _LEAST),
            color=CYCLE[1 + rank] if named else NOISY,
            linewidth=1.5 if named else 0.9,
            label=joints[place].name if named else None,
            zorder=2 if named else 1,
        )
    quiet(axes)
    axes.set_yscale("log")
    axes.set_xticks(steps)
    axes.set_xlabel("k")
    axes.set_ylabel("mean angle that k geodesics leave, $R_k$ (degrees)")
    axes.set_title("The widest joints, and all", loc="left", fontsize=10)
    axes.legend(frameon=False, fontsize=8)


def _vectors(mean: Array, q: Array) -> Array:
    """Rotation vectors from the mean, degrees; gaps stay gaps."""
    return np.asarray(np.degrees(2 * log(continuous(multiply(conjugate(mean), q)))))


__all__ = ["draw"]
