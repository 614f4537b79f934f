"""The figures of exact principal geodesic analysis as a picture."""

from pathlib import Path
from typing import Any

import numpy as np

from quatfilt.evaluation._plot import CYCLE, NOISY, TRUTH, figure, quiet
from quatfilt.evaluation.channels import Values
from quatfilt.evaluation.pga_figs import COMPONENTS
from quatfilt.evaluation.pga_figs_results import Descents, Figures, Gaussian, Joints, Root
from quatfilt.motion.motion import Motion

POSES = 10
"""Figures of the strip above the root's errors."""


def draw(figures: Figures, file: Path) -> None:
    """Draw descents, the Gaussian, the root's errors under its poses, and `R_k` of joints."""
    page = figure(13.0, 13.5)
    grid = page.add_gridspec(4, 1, height_ratios=(1.0, 0.55, 1.0, 1.0))
    top = grid[0].subgridspec(1, 3)
    for place, descents in enumerate(figures.low[:2]):
        _descents(page.add_subplot(top[place]), descents)
    _gaussian(page.add_subplot(top[2]), figures.gaussian)
    strip = page.add_subplot(grid[1])
    _poses(strip, figures.root.motion)
    _root(page.add_subplot(grid[2], sharex=strip), figures.root)
    bottom = grid[3].subgridspec(1, len(figures.joints))
    first: Any = None
    for place, joints in enumerate(figures.joints):
        axes = page.add_subplot(bottom[place], sharey=first)
        first = first or axes
        _joints(axes, joints)
    page.savefig(file)


def _descents(axes: Any, descents: Descents) -> None:
    for curves, colour, name in (
        (descents.exact, CYCLE[0], "gradient of eq. (9), steps halved"),
        (descents.printed, CYCLE[1], "eq. (13) as printed"),
    ):
        first, second = (np.degrees(curve) for curve in curves)
        axes.plot(range(len(first)), first, color=colour, linewidth=1.5, label=name)
        if len(second) > 1:
            axes.plot(
                len(first) - 1 + np.arange(len(second)), second, color=colour, linewidth=1.5, linestyle="--"
            )
    quiet(axes)
    axes.set_ylim(0, None)
    axes.set_xlabel("step; dashed: the second direction, from eq. (14)")
    axes.set_ylabel("mean distance to the geodesic (degrees)")
    axes.set_title(f"Samples on {descents.what}", loc="left", fontsize=10)
    axes.legend(frameon=False, fontsize=8)


def _gaussian(axes: Any, gaussian: Gaussian) -> None:
    begun = 0
    for number, curve in enumerate(gaussian.descents):
        steps = begun + np.arange(len(curve))
        axes.plot(steps, np.degrees(curve), color=CYCLE[number % len(CYCLE)], linewidth=1.5)
        begun = int(steps[-1])
    quiet(axes)
    axes.set_ylim(0, None)
    axes.set_xlabel("step of the descents for k = 1, 2, …")
    axes.set_ylabel("mean distance (degrees)")
    axes.set_title("Gaussian on S³ (Fig. 3)", loc="left", fontsize=10)


def _poses(axes: Any, motion: Motion) -> None:
    positions = np.asarray(motion.positions(), np.float64)
    height = float(np.ptp(positions[..., 1]))
    times = ((np.arange(POSES) + 0.5) / POSES * len(motion)).astype(int)
    for frame in times:
        pose = positions[frame]
        scale = 0.09 * len(motion) / motion.fps / height
        x = frame / motion.fps + scale * (pose[:, 0] - pose[0, 0])
        y = pose[:, 1] / height
        for joint, parent in enumerate(motion.skeleton.parents):
            if parent >= 0:
                axes.plot(x[[parent, joint]], y[[parent, joint]], color=TRUTH, linewidth=1.1)
    axes.set_axis_off()


def _root(axes: Any, root: Root) -> None:
    time = np.arange(root.errors.shape[1]) / root.motion.fps
    for k, errors in enumerate(root.errors):
        axes.plot(time, np.degrees(errors), color=CYCLE[k], linewidth=1.4, label=f"k = {k + 1}")
    quiet(axes)
    axes.set_xlim(0, time[-1])
    axes.set_ylim(0, 1.15 * float(np.degrees(root.errors.max())))
    axes.set_xlabel("time (seconds)")
    axes.set_ylabel("reconstruction error (degrees)")
    axes.set_title(
        f"Root of {root.clip}, {root.motion.fps:g} frames per second (Fig. 4)", loc="left", fontsize=10
    )
    axes.legend(frameon=False, fontsize=8, ncols=COMPONENTS, loc="upper right")


def _joints(axes: Any, joints: Joints) -> None:
    steps = np.arange(1, COMPONENTS + 1)
    residuals = np.degrees(joints.residuals)
    for curve in residuals.T:
        axes.plot(steps, _above(curve), color=NOISY, linewidth=0.8)
    axes.plot(steps, _above(np.median(residuals, axis=1)), color=CYCLE[1], linewidth=1.8, label="median")
    quiet(axes)
    axes.set_yscale("log")
    axes.set_ylim(1e-4, 100)
    axes.set_xticks(steps)
    axes.set_xlabel("k")
    axes.set_ylabel("$R_k$ (degrees)")
    axes.label_outer()
    axes.set_title(f"Joints of {joints.clip}", loc="left", fontsize=10)


def _above(values: Values) -> Values:
    """Hold what a logarithmic axis would lose at its foot."""
    return np.maximum(values, 1e-4)


__all__ = ["draw"]
