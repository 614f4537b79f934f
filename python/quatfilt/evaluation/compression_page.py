"""Compression of recordings, as a page, as numbers and as a picture."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from quatfilt.evaluation._markdown import table
from quatfilt.evaluation._plot import CYCLE, figure, quiet
from quatfilt.evaluation.clips import Clip
from quatfilt.evaluation.compression import FLOAT16, OURS, RATE, SMALLEST, VERTEX, VERTEX_ERROR, WAYS, Outcome

STEM = "compression"

_ACL_BYTES = 40
"""What ACL counts for a bone in a frame: rotation, translation and scale as ten float32."""

_ROOT_BYTES = 12
"""Of the root's translation in a frame as float32: it is counted as it is, for `compress` takes rotations."""


@dataclass(frozen=True)
class Report:
    """What was run, and what came out."""

    clips: Sequence[Clip]
    outcomes: Sequence[Outcome]
    as_acl: Sequence[Outcome]
    ratios: Mapping[float, float]
    threads: int
    version: str
    command: str

    def of(self, way: str) -> list[Outcome]:
        """Return the outcomes of a way, by clip."""
        return [one for one in self.outcomes if one.way == way]


def markdown(report: Report) -> str:
    """Return the page."""
    return "\n".join(
        [*_conditions(report), *_ways(report), *_by_clip(report), *_by_tolerance(report), *_acl(report)]
    )


def _conditions(report: Report) -> list[str]:
    return [
        "# Compression to a tolerance",
        "",
        f"Written by `{report.command}`, version {report.version}, {report.threads} threads.",
        "",
        (
            f"{len(report.clips)} recordings at 120 frames per second, all joints with their defects, as float32 quaternions: 16 bytes for each joint and "
            "frame, which is what ratios count against. The method was tried on others (02_01, 05_02, 09_01, 86_01). *Angle*: rotation "
            f"angle of a joint between the recording and what comes back. *Point*: a point {VERTEX:g} cm off each bone along each axis of its "
            "joint, in space: errors of all joints above add up there (the measure of the Animation Compression Library, ACL). "
            "Times are the shortest of three, whole calls."
        ),
        "",
    ]


def total(outcomes: Sequence[Outcome]) -> dict[str, float]:
    """Return the measures of several clips together."""
    raw = sum(one.raw_bytes for one in outcomes)
    frames = sum(one.frames for one in outcomes)
    return {
        "ratio": raw / sum(one.bytes for one in outcomes),
        "angle_max": max(one.angle_max for one in outcomes),
        "angle_mean": sum(one.angle_mean * one.frames for one in outcomes) / frames,
        "vertex_max": max(one.vertex_max for one in outcomes),
        "vertex_99": max(one.vertex_99 for one in outcomes),
        "write_megabytes": raw / 1e6 / sum(one.write_seconds for one in outcomes),
        "read_megabytes": raw / 1e6 / sum(one.read_seconds for one in outcomes),
    }


def _ways(report: Report) -> list[str]:
    rows = []
    for way in WAYS:
        sums = total(report.of(way))
        rows.append(
            (
                way,
                f"{sums['ratio']:.1f}",
                f"{sums['angle_max']:.3f}",
                f"{sums['angle_mean']:.4f}",
                f"{sums['vertex_max']:.3f}",
                f"{sums['vertex_99']:.3f}",
                f"{sums['write_megabytes']:.0f}",
                f"{sums['read_megabytes']:.0f}",
            )
        )
    lines = ["## All recordings together", ""]
    lines += table(
        ("", "ratio", "angle max °", "mean °", "point max cm", "99 % cm", "write MB/s", "read MB/s"), rows
    )
    return [
        *lines,
        "",
        (
            "The 99 % are those of the worst recording. The two plain formats are written in NumPy; their times are there for the scale. They need no "
            "neighbours in time, so that a single frame can be read."
        ),
        "",
    ]


def _by_clip(report: Report) -> list[str]:
    lines = ["## By recording", "", f"`{OURS}`.", ""]
    what = {clip.name: clip.what for clip in report.clips}
    lines += table(
        (
            "recording",
            "motion",
            "frames",
            "bytes",
            "ratio",
            "angle max °",
            "point max cm",
            "write ms",
            "read ms",
        ),
        [
            (
                one.clip,
                what[one.clip],
                str(one.frames),
                str(one.bytes),
                f"{one.ratio:.1f}",
                f"{one.angle_max:.4f}",
                f"{one.vertex_max:.3f}",
                f"{1e3 * one.write_seconds:.1f}",
                f"{1e3 * one.read_seconds:.1f}",
            )
            for one in report.of(OURS)
        ],
        left=(0, 1),
    )
    return [*lines, ""]


def _by_tolerance(report: Report) -> list[str]:
    lines = ["## By tolerance", ""]
    lines += table(
        ("tolerance °", *(f"{np.degrees(tolerance):g}" for tolerance in report.ratios)),
        [("ratio", *(f"{ratio:.1f}" for ratio in report.ratios.values()))],
    )
    return [*lines, "", f"![Ratio by tolerance]({STEM}.png)", ""]


def acl_ratio(report: Report) -> float:
    """Return the ratio as ACL counts it, the root's translation stored as it is."""
    joints = {clip.name: len(clip.motion.skeleton) for clip in report.clips}
    raw = sum(one.frames * joints[one.clip] * _ACL_BYTES for one in report.as_acl)
    return raw / sum(one.bytes + one.frames * _ROOT_BYTES for one in report.as_acl)


def _acl(report: Report) -> list[str]:
    sums = total(report.as_acl)
    return [
        "## Beside ACL's figures",
        "",
        (
            "ACL 2.0 publishes 19.81 : 1 for CMU's database (2534 clips, 24 frames per second, another skeleton; docs/cmu_performance.md of its "
            f"repository), with a threshold of {VERTEX_ERROR:g} cm at points {VERTEX:g} cm off each bone (largest error 0.0725 cm, 99.86 % of samples below the "
            "threshold), compressing 12.7 MB/s. It counts 40 bytes for each bone and frame, ten float32, of which most translations and all "
            "scales are constant, and its files are made to be sampled at any time in any order within microseconds, which ours are not."
        ),
        "",
        (
            f"Here, every fifth frame of the same recordings, {RATE:g} per second; tolerances by joint, each in proportion to one over the length of bones below it, "
            f"and all as large as the threshold allows: largest error {sums['vertex_max']:.4f} cm. The ratio is {sums['ratio']:.1f} against float32 quaternions, and "
            f"**{acl_ratio(report):.1f}** as ACL counts, with the root's translation stored as three float32. Recordings, skeletons and what is counted differ: this is no race."
        ),
        "",
    ]


def as_dict(report: Report) -> dict[str, Any]:
    """Return everything as plain values."""
    return {
        "version": report.version,
        "command": report.command,
        "threads": report.threads,
        "totals": {way: total(report.of(way)) for way in WAYS},
        "ratios_by_tolerance_radians": {
            f"{tolerance:.6g}": ratio for tolerance, ratio in report.ratios.items()
        },
        "acl_ratio": acl_ratio(report),
        "outcomes": [{**vars(one), "ratio": one.ratio} for one in report.outcomes],
        "to_vertex_error": [{**vars(one), "ratio": one.ratio} for one in report.as_acl],
    }


def draw(report: Report, path: Path) -> None:
    """Draw the ratio by tolerance, and the plain formats as points."""
    page = figure(7.0, 4.2)
    axes = page.subplots()
    degrees = np.degrees(list(report.ratios))
    axes.plot(
        degrees,
        list(report.ratios.values()),
        color=CYCLE[0],
        marker="o",
        label="quatfilt.compress, tolerance",
    )
    for number, way in enumerate((SMALLEST, FLOAT16)):
        sums = total(report.of(way))
        axes.plot(
            [sums["angle_max"]],
            [sums["ratio"]],
            linestyle="none",
            marker="sD"[number],
            color=CYCLE[number + 1],
            label=f"{way}, largest error",
        )
    axes.set_xscale("log")
    axes.set_yscale("log")
    ticks = [1, 2, 5, 10, 20, 50, 100]
    axes.set_yticks(ticks, [str(tick) for tick in ticks])
    axes.set_xlabel("largest rotation angle of the error (°)")
    axes.set_ylabel("ratio to float32 quaternions")
    quiet(axes)
    axes.legend(frameon=False)
    page.savefig(path)


__all__ = ["STEM", "Report", "acl_ratio", "as_dict", "draw", "markdown", "total"]
