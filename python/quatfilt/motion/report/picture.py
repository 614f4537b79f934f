"""A report as a picture: curves of the joints that changed most, jerk, and the slide of the feet."""

import io
from typing import TYPE_CHECKING, Any

import numpy as np

from quatfilt.evaluation._plot import DENOISED, NOISY, TRUTH, figure, quiet
from quatfilt.motion.metrics import _samples
from quatfilt.motion.metrics._samples import Values
from quatfilt.motion.report import text
from quatfilt.motion.report.sides import Side
from quatfilt.rotations.mean import mean

if TYPE_CHECKING:
    from quatfilt.motion.report.report import Report

_CURVES = 4
"""Joints whose curves are drawn."""

_WIDE, _CLOSE = 3.0, 0.4
"""Seconds of a clip that are shown, as a whole and close up; shorter clips are shown whole."""

_USUAL_RATE = 100.0
"""Frames per second, for the length of the views of clips that do not know theirs."""

_BARS = 34
"""Joints whose jerk is drawn: more names are not legible."""

_MARGIN = 0.3
"""Room above and below the filtered curve, of its height; spikes of the noisy one go beyond."""

_BELOW = 3.0
"""How far the axis of the jerk goes below the least jerk: joints that do not move at all in the reference have none."""

_LEAST_JERK = 1e-6
"""Of the largest jerk: below it is the rounding of joints that do not move, and no motion."""

GAP, CLOSE_UP = "#DCE9F5", "#F6EBD9"
"""Pale blue where samples were missing, pale yellow where the close view is."""

_LEAST_HEIGHT = 2.0
"""Degrees: a joint that hardly moves is not blown up any more."""


def draw(report: "Report", sides: tuple[Side, ...], form: str) -> bytes:
    """Draw a report, and return the file's content.

    Parameters
    ----------
    report : Report
        The numbers.
    sides : tuple of Side
        Before, after and, if there is one, the reference.
    form : {"png", "pdf", "svg"}
        Format of the file.

    Returns
    -------
    bytes
        The picture.

    Raises
    ------
    ImportError
        Without matplotlib.
    """
    chosen = text.changed_most(report, _CURVES) if report.frames else []
    page = figure(13.0, 1.5 + 1.6 * max(len(chosen), 3))
    left, right = page.subfigures(1, 2, width_ratios=(2.2, 1))
    if chosen:
        grid = left.subplots(len(chosen), 2, width_ratios=(2.2, 1), squeeze=False)
        for row, joint in zip(grid, chosen, strict=True):
            _curves(row, report, sides, joint)
        for axes in grid[-1]:
            axes.set_xlabel("time, seconds" if sides[0].fps else "frame")
        handles, labels = grid[0][0].get_legend_handles_labels()
        left.legend(handles, labels, loc="outside upper left", ncols=4, frameon=False)
    if report.feet:
        count = min(len(report.joints), _BARS)
        above, below = right.subplots(2, 1, height_ratios=(max(count, 8), 2 + 1.4 * len(report.feet)))
        _feet(below, report)
    else:
        above = right.subplots()
    _jerk(above, report)
    page.suptitle(text.summary(report), x=0.01, ha="left", fontsize=10)
    content = io.BytesIO()
    page.savefig(content, format=form)
    return content.getvalue()


def _curves(row: Any, report: "Report", sides: tuple[Side, ...], joint: int) -> None:
    """Draw the angle of a joint about the axis it moves about most, where the filter changed it most, and close up."""
    wide, close = row
    rate = sides[0].fps or _USUAL_RATE
    curves = _angles([side.rotations[:, joint] for side in sides])
    change = np.abs(curves[0] - curves[1])
    window = _window(change, 0, report.frames, round(_WIDE * rate))
    near = _window(change, *window, round(_CLOSE * rate))
    time = np.arange(report.frames) / (sides[0].fps or 1.0)
    missing = np.isnan(curves[0])
    for axes, (start, end) in ((wide, window), (close, near)):
        shown = [curve[start:end] for curve in curves]
        styles = (("before", NOISY, 0.9, 1), ("after", DENOISED, 1.4, 3), ("reference", TRUTH, 1.4, 2))
        for curve, (name, colour, width, order) in zip(shown, styles, strict=False):
            axes.plot(time[start:end], curve, color=colour, linewidth=width, zorder=order, label=name)
        low, high = _range(shown[1:])
        axes.set_ylim(low, high)
        axes.fill_between(
            time[start:end], low, high, where=missing[start:end], step="mid", color=GAP, linewidth=0, zorder=0
        )
        axes.margins(x=0)
        quiet(axes)
    if near != window:
        wide.axvspan(time[near[0]], time[near[1] - 1], color=CLOSE_UP, linewidth=0, zorder=0)
    wide.set_ylabel("angle, °")
    found = report.joints[joint]
    title = f"{found.name}, turned by {found.change_mean:.2f}° on average"
    wide.set_title(title, loc="left", fontsize=9, pad=3)
    if joint == text.changed_most(report, 1)[0]:
        close.set_title("close up", loc="left", fontsize=9, pad=3)


def _range(curves: list[Values]) -> tuple[float, float]:
    """Return the limits of an axis for curves, with some room."""
    values = np.concatenate(curves)
    values = values[~np.isnan(values)]
    low, high = (float(values.min()), float(values.max())) if len(values) else (0.0, 0.0)
    room = _MARGIN * max(high - low, _LEAST_HEIGHT)
    return low - room, high + room


def _angles(clips: list[Values]) -> list[Values]:
    """Return the angles of clips of one joint in degrees, ``(frames,)``, about the main axis of the second one."""
    centre = clips[1][~np.isnan(clips[1]).any(axis=-1)]
    if not len(centre):
        return [np.full(len(clip), np.nan) for clip in clips]
    middle = np.asarray(mean(centre), np.float64)
    vectors = [np.degrees(_samples.turns(np.broadcast_to(middle, clip.shape), clip)) for clip in clips]
    spread = np.degrees(_samples.turns(np.broadcast_to(middle, centre.shape), centre))
    _, _, axes = np.linalg.svd(spread - spread.mean(axis=0), full_matrices=False)
    # The sign of an axis is nobody's choice: the larger part of it points ahead.
    axis = axes[0] * np.sign(axes[0][np.argmax(np.abs(axes[0]))])
    return [vector @ axis for vector in vectors]


def _window(change: Values, start: int, end: int, length: int) -> tuple[int, int]:
    """Return the frames between `start` and `end` that changed most over a while."""
    if end - start <= max(length, 2):
        return start, end
    total = np.concatenate([[0.0], np.cumsum(np.nan_to_num(change[start:end]))])
    first = start + int(np.argmax(total[length:] - total[:-length]))
    return first, first + length


def _jerk(axes: Any, report: "Report") -> None:
    """Draw the jerk of each joint before and after, as dots on a logarithmic axis."""
    scale, unit = text.jerk_unit(report)
    joints = list(report.joints)
    title = "Jerk of each joint"
    if len(joints) > _BARS:
        joints = sorted(joints, key=lambda joint: -np.nan_to_num(joint.jerk_before))[:_BARS]
        title = f"Jerk of the {_BARS} roughest joints"
    pairs = [
        (joint.jerk_before / scale, joint.jerk_after / scale, joint.jerk_reference / scale)
        for joint in joints
    ]
    _pairs(axes, [joint.name for joint in joints], pairs)
    shown = _moving([value for values in pairs for value in values[:2]])
    if shown:
        axes.set_xscale("log")
        axes.set_xlim(min(shown) / _BELOW, max(shown) * _BELOW)
    axes.set_title(title, loc="left", fontsize=9, pad=3)
    axes.set_xlabel(unit)


def _moving(jerks: list[float]) -> list[float]:
    """Return those that a logarithmic axis has room for: joints that stand still have the jerk of their rounding."""
    least = _LEAST_JERK * max((jerk for jerk in jerks if jerk > 0), default=0.0)
    return [jerk for jerk in jerks if jerk > least]


def _feet(axes: Any, report: "Report") -> None:
    """Draw how far the feet slide before and after."""
    pairs = [(foot.slide_before, foot.slide_after, foot.slide_reference) for foot in report.feet]
    _pairs(axes, [foot.name for foot in report.feet], pairs)
    axes.set_xlim(left=0)
    axes.set_title("Slide of the feet on the ground", loc="left", fontsize=9, pad=3)
    axes.set_xlabel("cm")


def _pairs(axes: Any, names: list[str], pairs: list[tuple[float, float, float]]) -> None:
    """Draw values before and after, joined by a line, and those of the reference."""
    rows = np.arange(len(names))
    before, after, reference = np.array(pairs, np.float64).reshape(-1, 3).T
    axes.hlines(rows, before, after, color=NOISY, linewidth=1.2, zorder=1)
    axes.plot(before, rows, "o", color=NOISY, markersize=4, zorder=2)
    axes.plot(reference, rows, "|", color=TRUTH, markersize=9, markeredgewidth=1.6, zorder=3)
    axes.plot(after, rows, "o", color=DENOISED, markersize=4.5, zorder=4)
    axes.set_yticks(rows, names, fontsize=7)
    axes.set_ylim(len(names) - 0.4, -0.6)
    quiet(axes)


__all__ = ["draw"]
