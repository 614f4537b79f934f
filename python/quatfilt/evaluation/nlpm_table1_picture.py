"""Table I as a picture."""

import math
from pathlib import Path

import numpy as np

from quatfilt.evaluation._plot import CYCLE, figure, quiet
from quatfilt.evaluation.methods import NOISY, ORACLES
from quatfilt.evaluation.nlpm_table1_report import ROWS, Report
from quatfilt.evaluation.noises import SIGMA


def draw(report: Report, path: Path) -> None:
    """Draw the gain of each method over the noisy clip, and how much of the peak speed it keeps, by noise."""
    page = figure(9.0, 4.4)
    left, right = page.subplots(1, 2)
    names = [noise.name for noise in report.noises]
    # Impulses are no further step of the noise's size: they stand apart.
    places = np.array([place + 0.5 * (noise.multiple is None) for place, noise in enumerate(report.noises)])
    graded = [place for place, noise in enumerate(report.noises) if noise.multiple is not None]
    apart = [place for place, noise in enumerate(report.noises) if noise.multiple is None]
    markers = "osD^vP"
    for number, method in enumerate(ROWS[1:]):
        style = {
            "color": CYCLE[number % len(CYCLE)],
            "marker": markers[number % len(markers)],
            "markersize": 5,
            "linewidth": 1.4,
        }
        gains = np.array([report.mean(method, n, "psnr") - report.mean(NOISY, n, "psnr") for n in names])
        kept = np.array([report.mean(method, name, "peak_kept") for name in names])
        for axes, values in ((left, gains), (right, kept)):
            line = "--" if method in ORACLES else "-"
            axes.plot(places[graded], values[graded], linestyle=line, label=method, **style)
            axes.plot(places[apart], values[apart], linestyle="none", **style)
    left.set_ylabel("PSNR gained over the noisy clip (dB)")
    right.set_ylabel("peak angular speed kept (1 = the truth's)")
    right.set_yscale("log")
    right.axhline(1, color="black", linewidth=0.8)
    for axes in (left, right):
        quiet(axes)
        axes.set_xticks(places, names, fontsize=8)
        axes.set_xlabel(f"noise (σ = {math.degrees(SIGMA):.2f}°)")
    handles, labels = left.get_legend_handles_labels()
    page.legend(handles, labels, loc="outside upper center", ncols=3, frameon=False)
    page.savefig(path)


__all__ = ["draw"]
