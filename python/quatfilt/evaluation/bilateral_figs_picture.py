"""The bilateral filter's figures as a picture."""

import math
from pathlib import Path
from typing import Any

import numpy as np

from quatfilt.evaluation._plot import CYCLE, DENOISED, NOISY, TRUTH, figure, quiet
from quatfilt.evaluation.bilateral_figs_conditions import FIVE, PASSES
from quatfilt.evaluation.bilateral_figs_results import Drawn, Figures, path, speed

_GAUSSIAN = CYCLE[0]


def draw(figures: Figures, file: Path) -> None:
    """Draw MSE by passes, the drift of other filters, angular speed and paths of the hand."""
    page = figure(13.0, 12.0)
    grid = page.add_gridspec(3, 12, height_ratios=(1.0, 0.9, 1.0))
    top = [page.add_subplot(grid[0, place : place + 4]) for place in (0, 4, 8)]
    _errors(top[0], figures, every=False)
    _errors(top[1], figures, every=True)
    _drift(top[2], figures.drawn)
    _speeds(page.add_subplot(grid[1, :]), figures.drawn)
    first = page.add_subplot(grid[2, 0:3])
    others = [page.add_subplot(grid[2, place : place + 3], sharex=first, sharey=first) for place in (3, 6, 9)]
    _paths([first, *others], figures.drawn)
    page.savefig(file)


def _errors(axes: Any, figures: Figures, *, every: bool) -> None:
    curves = figures.curves[0]
    noisy = curves.noisy_all if every else curves.noisy
    for number, (sigma, values) in enumerate((curves.every if every else curves.joint).items()):
        infinite = math.isinf(sigma)
        axes.plot(
            range(PASSES + 1),
            1e3 * np.array([noisy, *values]),
            color=TRUTH if infinite else CYCLE[number],
            linestyle="--" if infinite else "-",
            marker="osD^v"[number],
            markersize=4,
            linewidth=1.4,
            label="∞ (Gaussian)" if infinite else f"{sigma:g}",
        )
    quiet(axes)
    axes.set_ylim(0, None)
    axes.set_xticks(range(0, PASSES + 1, 2))
    axes.set_xlabel("passes")
    axes.set_ylabel("MSE (10⁻³ rad², on S³)")
    axes.set_title(
        f"{'All joints' if every else figures.drawn.joint}, {curves.fps:g} frames per second",
        loc="left",
        fontsize=10,
    )
    if every:
        axes.legend(
            title="σ_g",
            frameon=False,
            fontsize=8,
            title_fontsize=8,
            loc="center right",
            bbox_to_anchor=(1.0, 0.62),
        )


_STYLES = {
    "R⁴, renormalised": ("#56B4E9", "-"),
    "one global chart": ("#CC79A7", "-"),
    "displacements integrated": ("#009E73", "-"),
    "Gaussian (Lee and Shin)": (_GAUSSIAN, "--"),
}
"""Colour and line of the filters whose error is drawn by frame."""


def _drift(axes: Any, drawn: Drawn) -> None:
    for name, (colour, line) in _STYLES.items():
        error = drawn.errors[name]
        axes.plot(error, color=colour, linestyle=line, linewidth=1.4, label=name)
    quiet(axes)
    axes.set_ylim(0, 1.3 * max(float(drawn.errors[name].max()) for name in _STYLES))
    axes.set_xlabel("frame")
    axes.set_ylabel("mean error of the joints (degrees)")
    axes.set_title("Section 3.2: one pass of other filters", loc="left", fontsize=10)
    axes.legend(frameon=False, fontsize=8, loc="upper left")


_COLOURS = (NOISY, _GAUSSIAN, DENOISED, CYCLE[2])
"""Of the motions that are drawn."""


def _speeds(axes: Any, drawn: Drawn) -> None:
    fps = drawn.truth.fps
    curves = {name: speed(motion, drawn.joint) for name, motion in drawn.motions.items()}
    time = (np.arange(len(drawn.truth) - 1) + 0.5) / fps
    axes.plot(time, speed(drawn.truth, drawn.joint), color=TRUTH, linewidth=2.2, zorder=2, label="truth")
    for (name, values), colour in zip(curves.items(), _COLOURS, strict=True):
        noisy = colour == NOISY
        axes.plot(
            time,
            values,
            color=colour,
            linewidth=0.8 if noisy else 1.4,
            zorder=1 if noisy else 3,
            label=name if noisy else f"{name}, {FIVE} passes",
        )
    quiet(axes)
    axes.set_ylim(0, 1.05 * max(float(values.max()) for values in curves.values()))
    axes.set_xlim(0, len(drawn.truth) / fps)
    axes.set_xlabel("time (seconds)")
    axes.set_ylabel("degrees per second")
    axes.set_title(f"Angular speed of {drawn.joint}", loc="left", fontsize=10)
    axes.legend(frameon=False, fontsize=8, loc="lower right", bbox_to_anchor=(1.0, 0.99), ncols=5)


def _paths(panels: list[Any], drawn: Drawn) -> None:
    truth = path(drawn.truth, drawn.hand)
    for axes, (name, motion), colour in zip(panels, drawn.motions.items(), _COLOURS, strict=True):
        found = path(motion, drawn.hand)
        away = float(np.linalg.norm(found - truth, axis=1).mean())
        axes.plot(truth[:, 0], truth[:, 1], color=TRUTH, linewidth=1.8, zorder=2)
        axes.plot(found[:, 0], found[:, 1], color=colour, linewidth=1.1, zorder=1 if colour == NOISY else 3)
        quiet(axes)
        axes.set_aspect("equal", adjustable="box")
        axes.set_xlabel("to the side (cm)")
        title = name if name == "noisy" else f"{name}, {FIVE} passes"
        axes.set_title(f"{title}:\n{away:.1f} cm off in the mean", loc="left", fontsize=10)
    panels[0].set_ylabel(f"{drawn.hand}: up (cm); black: truth")
    for axes in panels[1:]:
        axes.tick_params(labelleft=False)


__all__ = ["draw"]
