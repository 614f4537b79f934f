"""Table I as a picture."""

import math
from pathlib import Path

import numpy as np

from quatfilt.evaluation._plot import CYCLE, figure, quiet
from quatfilt.evaluation.methods import NOISY, ROWS
from quatfilt.evaluation.nlpm_table1_report import Report
from quatfilt.evaluation.noises import SIGMA

_MARKERS = "osD^vP*Xhd<>"


def draw(report: Report, path: Path) -> None:
    """Draw the gain of each row over the noisy clip by noise, with fixed settings and with oracles, and the peak speed kept."""
    page = figure(13.0, 5.4)
    fixed, oracle, peaks = page.subplots(1, 3)
    oracle.sharey(fixed)
    oracle.tick_params(labelleft=False)
    names = [noise.name for noise in report.noises]
    # Impulses are no further step of the noise's size: they stand apart.
    places = np.array([place + 0.5 * (noise.multiple is None) for place, noise in enumerate(report.noises)])
    graded = [place for place, noise in enumerate(report.noises) if noise.multiple is not None]
    apart = [place for place, noise in enumerate(report.noises) if noise.multiple is None]
    families = list(dict.fromkeys(row.removesuffix(", oracle") for row in report.rows if row != NOISY))
    for number, family in enumerate(families):
        style = {
            "color": CYCLE[number % len(CYCLE)],
            "marker": _MARKERS[number % len(_MARKERS)],
            "markersize": 4.5,
            "linewidth": 1.2,
            "linestyle": "-" if number < len(CYCLE) else "--",
        }
        for row, axes in ((family, fixed), (f"{family}, oracle", oracle)):
            if row not in report.rows:
                continue
            gains = np.array([report.mean(row, n, "psnr") - report.mean(NOISY, n, "psnr") for n in names])
            kept = np.array([report.mean(row, n, "peak_kept") for n in names])
            drawn = [(axes, gains), *([(peaks, kept)] if not ROWS[row].oracle else [])]
            for where, values in drawn:
                where.plot(places[graded], values[graded], label=family, **style)
                where.plot(places[apart], values[apart], **{**style, "linestyle": "none"})
    fixed.set_ylabel("PSNR gained over the noisy clip (dB)")
    fixed.set_title("Fixed settings", loc="left", fontsize=10)
    oracle.set_title("The best of 17 settings (oracle)", loc="left", fontsize=10)
    peaks.set_title("Fixed settings: peak angular speed, 1 = the truth's", loc="left", fontsize=10)
    peaks.set_yscale("log")
    peaks.axhline(1, color="black", linewidth=0.8)
    for axes in (fixed, oracle):
        axes.axhline(0, color="black", linewidth=0.8)
    for axes in (fixed, oracle, peaks):
        quiet(axes)
        axes.set_xticks(places, names, fontsize=8)
        axes.set_xlabel(f"noise (σ = {math.degrees(SIGMA):.2f}°)")
    found: dict[str, object] = {}
    for axes in (fixed, oracle):
        for handle, label in zip(*axes.get_legend_handles_labels(), strict=True):
            found.setdefault(label, handle)
    page.legend(list(found.values()), list(found), loc="outside upper center", ncols=6, frameon=False)
    page.savefig(path)


__all__ = ["draw"]
