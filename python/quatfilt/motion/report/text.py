"""A report as tables, for a terminal or as plain text."""

import math
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from quatfilt.motion.report.measured import Placed
    from quatfilt.motion.report.report import Report

SHOWN = 8
"""Joints in the table: those that changed most."""

_THOUSAND = 1000.0


class Table(NamedTuple):
    """Rows of text under a title; the first column is left-aligned, the others right."""

    title: str
    columns: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]


def summary(report: "Report") -> str:
    """Return one line about the whole clip."""
    overall = report.overall
    return (
        f"{report.frames} frames of {len(report.joints)} joints: turned by {_number(overall.change_mean)}° on average, "
        f"95 % by less than {_number(overall.change_p95)}°, at most {_number(overall.change_max)}°; "
        f"peak angular speed kept {_number(overall.peak_kept)}"
        f"{f'; {report.source}' if report.source else ''}"
    )


def tables(report: "Report") -> list[Table]:
    """Return the whole clip, the joints that changed most, and the feet."""
    result = [_whole(report), _joints(report)]
    if report.feet:
        result.append(_feet(report))
    return result


def plain(report: "Report") -> str:
    """Return the report as text."""
    return "\n\n".join([summary(report), *map(_plain_table, tables(report)), *notes(report)])


def notes(report: "Report") -> list[str]:
    """Return sentences about the noise before, and about how the feet were measured."""
    result = [f"Noise before: {report.noise}."] if report.noise else []
    if report.placed is not None:
        result.append(turned(report.placed))
    if report.feet and report.foot_scale != 1:
        result.append(scaled(report.foot_scale))
    return result


def turned(placed: "Placed") -> str:
    """Return the sentence that says by how much joints were turned to hold feet on the ground."""
    if not placed.frames:
        return "Feet: no joint was turned to hold them on the ground."
    return (
        f"Feet: joints were turned in {placed.frames} frames to hold them on the ground, by at most {_number(placed.turned_max)}° "
        f"({placed.joint}, frame {placed.frame})."
    )


def scaled(factor: float) -> str:
    """Return the sentence that goes with foot slide in a unit that is not known."""
    return f"Foot slide: the unit of the skeleton is not known; lengths were multiplied by {factor:.3g}, for a leg of 90 cm."


def changed_most(report: "Report", count: int) -> list[int]:
    """Return the indices of the joints that changed most on average."""
    mean = [-1.0 if math.isnan(joint.change_mean) else joint.change_mean for joint in report.joints]
    return sorted(range(len(mean)), key=lambda joint: -mean[joint])[:count]


def jerk_unit(report: "Report") -> tuple[float, str]:
    """Return what jerk is divided by in reports, and the name of that unit."""
    return (1.0, "°/frame³") if report.fps == 1 else (_THOUSAND, "10³ °/s³")


def _whole(report: "Report") -> Table:
    overall = report.overall
    known = has_reference(report)
    scale, unit = jerk_unit(report)
    rows: list[tuple[str, ...]] = [
        ("estimated noise, °", _number(overall.noise_before, 3), _number(overall.noise_after, 3), ""),
        (
            f"jerk, {unit}",
            _significant(overall.jerk_before / scale),
            _significant(overall.jerk_after / scale),
            _significant(overall.jerk_reference / scale),
        ),
        ("missing samples", str(overall.missing), str(overall.missing - overall.filled), ""),
        ("spikes", str(overall.spikes), str(overall.spikes - overall.spikes_replaced), ""),
    ]
    if report.feet:
        slides = [
            sum(values) / len(report.feet)
            for values in zip(
                *((foot.slide_before, foot.slide_after, foot.slide_reference) for foot in report.feet),
                strict=True,
            )
        ]
        rows.append(("foot slide, mean of the feet, cm", *(_number(slide, 1) for slide in slides)))
    if known:
        rows += [
            ("angle error, mean °", _number(overall.error_before, 3), _number(overall.error_after, 3), ""),
            (
                "angle error, 95th percentile °",
                _number(overall.error_p95_before, 3),
                _number(overall.error_p95_after, 3),
                "",
            ),
            (
                "peak signal-to-noise ratio, dB",
                _number(overall.psnr_before, 1),
                _number(overall.psnr_after, 1),
                "",
            ),
            (
                "peak angular speed, of the reference's",
                _number(overall.peak_before),
                _number(overall.peak_after),
                "1.00",
            ),
        ]
    columns = ("measure", "before", "after", "reference")
    wide = len(columns) if known else len(columns) - 1
    return Table("", columns[:wide], tuple(row[:wide] for row in rows))


def _joints(report: "Report") -> Table:
    shown = [report.joints[index] for index in changed_most(report, SHOWN)]
    columns: dict[str, list[str]] = {
        "joint": [joint.name for joint in shown],
        "mean °": [_number(joint.change_mean) for joint in shown],
        "max °": [_number(joint.change_max, 1) for joint in shown],
        "noise °": [_pair(joint.noise_before, joint.noise_after) for joint in shown],
        "jerk": [_percent(joint.jerk_after, joint.jerk_before) for joint in shown],
        "peak": [_number(joint.peak_kept) for joint in shown],
    }
    if has_reference(report):
        columns["error °"] = [_pair(joint.error_before, joint.error_after) for joint in shown]
    # What no joint had needs no column: a terminal is narrow.
    if report.overall.missing:
        columns["filled"] = [str(joint.filled) for joint in shown]
    if report.overall.spikes:
        columns["spikes"] = [str(joint.spikes_replaced) for joint in shown]
    title = "Joints that changed most" if len(report.joints) > SHOWN else "Joints"
    return Table(title, tuple(columns), tuple(zip(*columns.values(), strict=True)))


def _feet(report: "Report") -> Table:
    known = has_reference(report)
    columns = ("foot slide, cm", "before", "after", "reference")
    wide = len(columns) if known else len(columns) - 1
    rows = [
        (
            foot.name,
            _number(foot.slide_before, 1),
            _number(foot.slide_after, 1),
            _number(foot.slide_reference, 1),
        )[:wide]
        for foot in report.feet
    ]
    return Table("", columns[:wide], tuple(rows))


def has_reference(report: "Report") -> bool:
    """Whether the report was made with a reference."""
    return not math.isnan(report.overall.error_before)


def _plain_table(table: Table) -> str:
    lines = [table.columns, *table.rows]
    widths = [max(map(len, column)) for column in zip(*lines, strict=True)]
    text = [
        "  ".join(
            cell.rjust(width) if place else cell.ljust(width)
            for place, (cell, width) in enumerate(zip(line, widths, strict=True))
        ).rstrip()
        for line in lines
    ]
    return "\n".join([table.title, *text] if table.title else text)


def _pair(before: float, after: float) -> str:
    return f"{_number(before)}→{_number(after)}"


def _percent(part: float, whole: float) -> str:
    if math.isnan(part) or math.isnan(whole) or whole == 0:
        return "-"
    return f"{_significant(100 * part / whole)} %"


def _number(value: float, digits: int = 2) -> str:
    if math.isnan(value):
        return "-"
    return "∞" if math.isinf(value) else f"{value:.{digits}f}"


def _significant(value: float) -> str:
    """Return a number with three digits that count, and no exponent."""
    if math.isnan(value):
        return "-"
    digits = 2 - math.floor(math.log10(abs(value))) if value else 0
    return f"{value:.{min(max(digits, 0), 6)}f}"


__all__ = [
    "SHOWN",
    "Table",
    "changed_most",
    "has_reference",
    "jerk_unit",
    "notes",
    "plain",
    "scaled",
    "summary",
    "tables",
    "turned",
]
