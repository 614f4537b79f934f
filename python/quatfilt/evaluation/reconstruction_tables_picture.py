"""Errors of reconstruction as a picture."""

from pathlib import Path
from typing import Any

import numpy as np

from quatfilt.evaluation._plot import CYCLE, figure, quiet
from quatfilt.evaluation.reconstruction_tables import Tables
from quatfilt.evaluation.reconstruction_tables_conditions import ACTIONS, CONTROL_POINTS, MODELS
from quatfilt.evaluation.reconstruction_tables_page import models

_MEASURES = (("position", "position error (cm)"), ("angle", "angle error (degrees)"))


def draw(tables: Tables, file: Path) -> None:
    """Draw errors by control points, and by action with six and with four of them."""
    page = figure(13.0, 7.5)
    grid = page.add_gridspec(2, 3)
    for row, (measure, label) in enumerate(_MEASURES):
        axes = page.add_subplot(grid[row, 0])
        _points(axes, tables, measure)
        axes.set_ylabel(label)
        panels = [axes]
        if row == 0:
            axes.legend(frameon=False, fontsize=8)
        for column, count in enumerate((6, 4), start=1):
            bars = page.add_subplot(grid[row, column], sharey=axes)
            _actions(bars, tables, measure, count)
            panels.append(bars)
            if row == 0:
                bars.set_title(f"By action, {count} control points", loc="left", fontsize=10)
        axes.set_ylim(0, 1.05 * max(panel.dataLim.y1 for panel in panels))
    page.savefig(file)


def _points(axes: Any, tables: Tables, measure: str) -> None:
    counts = list(CONTROL_POINTS)
    for colour, model in zip(CYCLE, models(tables), strict=False):
        values = [tables.mean(measure, model=model, points=count, share=1, known=False) for count in counts]
        axes.plot(counts, values, color=colour, marker="o", markersize=4, linewidth=1.5, label=MODELS[model])
    quiet(axes)
    axes.set_xticks(counts)
    axes.set_xlabel("control points")


def _actions(axes: Any, tables: Tables, measure: str, count: int) -> None:
    actions = [action for action in ACTIONS if tables.of(action=action)]
    shown = models(tables)
    width = 0.8 / len(shown)
    for place, (colour, model) in enumerate(zip(CYCLE, shown, strict=False)):
        values = [
            tables.mean(measure, model=model, points=count, share=1, action=action, known=action == "golf")
            for action in actions
        ]
        axes.bar(np.arange(len(actions)) + (place + 0.5) * width - 0.4, values, width, color=colour)
    quiet(axes)
    axes.set_xticks(range(len(actions)), [f"{action}*" if action == "golf" else action for action in actions])


__all__ = ["draw"]
