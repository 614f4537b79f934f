"""Recordings of trackers before and after, as a page, as numbers and as a picture."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from quatfilt._typing import Array
from quatfilt.evaluation._markdown import cell, table
from quatfilt.evaluation._plot import DENOISED, NOISY, figure, quiet
from quatfilt.evaluation.trackers import CAP, CLEAR, EVERY, SLOW, Take
from quatfilt.presets import PRESETS
from quatfilt.rotations.continuity import continuous
from quatfilt.rotations.mean import mean
from quatfilt.rotations.quaternion import conjugate, geodesic_distance, log, multiply

STEM = "trackers"

SEEN = {
    "azure_kinect_a": "The corners at the knots are round. A peak of the wrist at 9.75 s is a third lower; nothing says whether it is motion.",
    "mediapipe_dance": (
        "Wrong: the result swings over by 50° in the frame after the jump at 9.15 s, and by 30° after that at 9.95 s. Flips of the whole body stay. "
        'Wrong with "video": the pose that is held at 9.6 s becomes a slope, and the forearm leads up to 100° away from the recording before 9.95 s.'
    ),
    "mediapipe_dance1": (
        "Single frames that stick out are gone; tops of quick turns are lower, by 20° at 3.2 s. "
        'Wrong with "video": the head\'s swing of 240° in three frames at 2.65 s becomes a jump in one frame.'
    ),
    "mediapipe_dance7": (
        'Nothing is done, with "video" neither: the stairs in the forearm from 2.5 to 3.8 s, and its trembling by 5° about 7 s, stay.'
    ),
    "mediapipe_flips": (
        "Single frames are gone, as at 10.15 s. Wrong: beside the jump at 9.8 s the result lies up to 50° beside the recording. "
        'Wrong with "video": after the jump at 9.0 s it takes three frames to come back.'
    ),
    "mocapnet_push": "The recording is smooth, and the result is the same curve.",
    "shadermotion_vr": (
        "The stairs of held frames, seen from 3 to 6 s, become a smooth curve. The recording begins with a jump of 290° in 0.1 s; the result follows, where it "
        "should be cut off."
    ),
    "xsens_boxlift": "The recording is smooth, and the result is the same curve.",
}
"""By recording: the picture in words, looked at by eye."""

CLOSE = 1.5
"""Seconds of the close view."""


@dataclass(frozen=True)
class Report:
    """Conditions and results."""

    takes: Sequence[Take]
    version: str
    command: str


def markdown(report: Report) -> str:
    """Return the page."""
    return "\n".join(
        [*_conditions(report), *_measures(report), *_presets(report), *_seen(report), *_sources(report)]
    )


def _conditions(report: Report) -> list[str]:
    return [
        "# Recordings of trackers, before and after",
        "",
        f"Written by `{report.command}`, version {report.version}.",
        "",
        (
            f"`denoise(motion)` without options on {len(report.takes)} recordings of consumer trackers. They have no truth. Each row of the picture "
            "is one recording: the joint that jerks most, one coordinate of its rotation vector in degrees, the whole take and a close view."
        ),
        "",
        f"![Recordings before and after]({STEM}.png)",
        "",
    ]


def _measures(report: Report) -> list[str]:
    lines = [
        "## Measures without truth",
        "",
        (
            "*Jerk left*: mean rotational jerk, result over recording, also for `kalman`. *Slow path moved*: mean angle "
            f"between the eigenvectors of Gaussian sums of q qᵀ ({SLOW} s), where the largest eigenvalue has a share of at least {CLEAR}; *masked*: "
            "share of the samples where it has not. *Peaks kept*: 95th percentile of the excursion from the slow path. *Withheld*: mean error of one "
            f"of {EVERY} measurements that was withheld, capped at {CAP:g}°, and the same for geodesics between neighbours. *Speed*, *acceleration*: "
            "99th percentiles of the result; clean recordings of people have at most about 5 rad/s and 210 rad/s²."
        ),
        "",
    ]
    lines += table(
        (
            "recording",
            "fps",
            "jerk left",
            "kalman",
            "slow path moved, °",
            "masked",
            "peaks kept",
            "change, °",
            "withheld, °",
            "interpolated, °",
            "speed, rad/s",
            "acceleration, rad/s²",
        ),
        [
            (
                take.name,
                f"{take.before.fps:.3g}",
                *(cell(value, 2) for value in (take.jerk_left, take.jerk_left_kalman)),
                cell(take.slow_moved, 3),
                f"{100 * take.masked:.0f} %",
                cell(take.peaks_kept, 2),
                cell(take.change, 3),
                cell(take.withheld, 2),
                cell(take.withheld_plain, 2),
                cell(take.speed, 1),
                cell(take.acceleration, 0),
            )
            for take in report.takes
        ],
    )
    return [*lines, ""]


def _presets(report: Report) -> list[str]:
    lines = [
        "## Presets",
        "",
        (
            "Jerk left / slow path moved, ° / peaks kept / change, ° of `denoise(motion, preset=...)`. Shares of peaks on noisy recordings count the noise's "
            "peaks too."
        ),
        "",
    ]
    rows = [
        (
            take.name,
            *(
                " / ".join(
                    cell(found[measure], digits)
                    for measure, digits in (
                        ("jerk_left", 2),
                        ("slow_moved", 2),
                        ("peaks_kept", 2),
                        ("change", 2),
                    )
                )
                for found in take.presets.values()
            ),
        )
        for take in report.takes
    ]
    return [*lines, *table(("recording", *PRESETS), rows), ""]


def _seen(report: Report) -> list[str]:
    rows = [(take.name, SEEN[take.name]) for take in report.takes if take.name in SEEN]
    if not rows:
        return []
    return ["## The pictures in words", "", *table(("recording", "before and after"), rows, left=(0, 1)), ""]


def _sources(report: Report) -> list[str]:
    lines = [
        "## Sources",
        "",
        "The same words as `quatfilt info`. *Flips*: the root turns by more than 90° in a frame.",
        "",
    ]
    rows = [(take.name, take.source or "every frame was measured", str(take.flips)) for take in report.takes]
    return [*lines, *table(("recording", "source", "flips"), rows, left=(0, 1)), ""]


def as_dict(report: Report) -> dict[str, Any]:
    """Return everything as plain values."""
    return {
        "version": report.version,
        "command": report.command,
        "takes": [
            {
                **{
                    name: None if isinstance(value, float) and not math.isfinite(value) else value
                    for name, value in vars(take).items()
                    if name not in ("before", "after")
                },
                "frames": len(take.before),
                "fps": take.before.fps,
            }
            for take in report.takes
        ],
    }


def draw(report: Report, path: Path) -> None:
    """Draw each recording before and after: the whole take, and the part where it jerks most."""
    page = figure(11.0, 1.75 * len(report.takes) + 0.4)
    rows = page.subplots(len(report.takes), 2, squeeze=False, width_ratios=(2, 1))
    for (wide, close), take in zip(rows, report.takes, strict=True):
        joint, frame = roughest(take.before.rotations)
        time = np.arange(len(take.before)) / take.before.fps
        before, after = curves(take, joint)
        coordinate = int(np.argmax(np.ptp(before, axis=0)))
        for axes in (wide, close):
            quiet(axes)
            axes.plot(
                time,
                before[:, coordinate],
                color=NOISY,
                linewidth=1.0,
                marker=".",
                markersize=2,
                label="recording",
            )
            axes.plot(time, after[:, coordinate], color=DENOISED, linewidth=0.9, label="denoise")
        start = float(np.clip(time[frame] - CLOSE / 2, 0, max(time[-1] - CLOSE, 0)))
        close.set_xlim(start, start + CLOSE)
        window = (time >= start) & (time <= start + CLOSE)
        low, high = before[window, coordinate].min(), before[window, coordinate].max()
        margin = 0.08 * (high - low) + 0.1
        close.set_ylim(low - margin, high + margin)
        wide.set_title(f"{take.name}, {take.before.skeleton.names[joint]}", loc="left", fontsize=9)
        wide.tick_params(labelsize=7)
        close.tick_params(labelsize=7)
    rows[-1][0].set_xlabel("seconds", fontsize=8)
    handles, labels = rows[0][0].get_legend_handles_labels()
    page.legend(handles, labels, loc="outside upper right", ncols=2, frameon=False)
    page.savefig(path)


def roughest(q: Array) -> tuple[int, int]:
    """Return the joint with the largest median bend from frame to frame, and the frame around which it bends most."""
    speed = geodesic_distance(q[:-1], q[1:])
    bends = np.abs(np.diff(speed, axis=0))
    joint = int(np.argmax(np.percentile(bends, 75, axis=0)))
    around = np.convolve(bends[:, joint], np.ones(15), mode="same")
    return joint, int(np.argmax(around)) + 1


def curves(take: Take, joint: int) -> tuple[Array, Array]:
    """Return the rotation vectors of a joint before and after in degrees, about the recording's mean.

    The signs of the result are those of the recording, so that both unroll alike where the joint jumps by half a turn.
    """
    before, after = (motion.rotations[:, [joint]] for motion in (take.before, take.after))
    base = conjugate(mean(before)[None])
    path = multiply(base, continuous(before))
    if path[..., 0].sum() < 0:
        path = -path
    beside = multiply(base, after)
    beside = beside * np.where(np.sum(path * beside, axis=-1, keepdims=True) < 0, -1.0, 1.0)
    return np.degrees(2 * log(path))[:, 0], np.degrees(2 * log(beside))[:, 0]


__all__ = ["STEM", "Report", "as_dict", "draw", "markdown"]
