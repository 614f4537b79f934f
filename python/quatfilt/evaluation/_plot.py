"""The door to matplotlib, which is an optional extra."""

from typing import Any

from quatfilt._extras import extra

TRUTH, NOISY, DENOISED = "#000000", "#9AA5B1", "#D55E00"
"""Black, grey and vermilion (Okabe and Ito): told apart by every eye, and in print without colour."""

CYCLE = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000")
"""Okabe and Ito's palette, the strongest first."""


def figure(width: float, height: float) -> Any:
    """Make an empty figure, in inches, that draws into files alone."""
    matplotlib = [
        extra(f"matplotlib.{module}", "matplotlib", "plot", "pictures")
        for module in ("figure", "backends.backend_agg")
    ]
    result = matplotlib[0].Figure(figsize=(width, height), dpi=150, layout="constrained")
    matplotlib[1].FigureCanvasAgg(result)
    return result


def quiet(axes: Any) -> None:
    """Take away the lines that say nothing."""
    axes.spines[["top", "right"]].set_visible(False)
    axes.grid(visible=True, color="#E3E7EB", linewidth=0.6)
    axes.set_axisbelow(True)


__all__ = ["CYCLE", "DENOISED", "NOISY", "TRUTH", "figure", "quiet"]
