"""The goal of the automatic method, as a page, as numbers and as a picture."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from quatfilt.evaluation._markdown import cell, table
from quatfilt.evaluation._plot import CYCLE, figure, quiet
from quatfilt.evaluation.clips import Clip
from quatfilt.evaluation.methods import ROWS
from quatfilt.evaluation.noises import SIGMA
from quatfilt.evaluation.smooth_goal import LONGEST, Outcome

STEM = "smooth-goal"


@dataclass(frozen=True)
class Report:
    """What was run, and what came out."""

    clips: Sequence[Clip]
    outcomes: Sequence[Outcome]
    method: str
    seeds: int
    version: str
    command: str

    @property
    def multiples(self) -> list[int]:
        """The levels of the noise."""
        return sorted({one.multiple for one in self.outcomes})

    def at(self, multiple: int) -> list[Outcome]:
        """Return the outcomes of one level."""
        return [one for one in self.outcomes if one.multiple == multiple]


def markdown(report: Report) -> str:
    """Return the page."""
    return "\n".join([*_conditions(report), *_levels(report), *_by_clip(report), *_filters(report)])


def _conditions(report: Report) -> list[str]:
    rows = ", ".join(row.removesuffix(", oracle") for row in report.outcomes[0].classical)
    return [
        "# The automatic method beside the best classical filters",
        "",
        f"Written by `{report.command}`, version {report.version}.",
        "",
        (
            f"`denoise(method={report.method!r})`, without any option, on {len(report.clips)} recordings that nothing was tuned on: the "
            f"first {LONGEST} frames, steady joints, white Gaussian noise of m · {SIGMA} rad per component of the rotation vector, "
            f"{report.seeds} seeds. Against it stands, for each recording and level, the best of {rows}, each with the best of 17 settings "
            "by the truth, on rotation vectors or components, whichever is better."
        ),
        "",
    ]


def _levels(report: Report) -> list[str]:
    lines = [
        "## By level",
        "",
        (
            "*Margin*: PSNR of the automatic method less that of the best classical filter, dB. *Peak kept*: 95th percentile of the "
            "angular speed, 1 = the truth's. *Impulses*: mean error when impulses hit 1 % of the samples besides, less the mean error "
            "without, degrees."
        ),
        "",
    ]
    rows = []
    for multiple in report.multiples:
        found = report.at(multiple)
        margins = [one.margin for one in found]
        least = min(found, key=lambda one: one.margin)
        kept = [one.peak_kept for one in found]
        spoiled = [one.angle_with_impulses - one.angle for one in found]
        rows.append(
            (
                str(multiple),
                f"{np.mean([one.noisy for one in found]):.2f}",
                f"{np.mean([one.classical[one.best] for one in found]):.2f}",
                f"{np.mean([one.automatic for one in found]):.2f}",
                f"{np.mean(margins):+.2f}",
                f"{least.margin:+.2f} ({least.clip})",
                f"{sum(margin > 0 for margin in margins)} of {len(margins)}",
                f"{np.mean(kept):.3f} ({min(kept):.2f} … {max(kept):.2f})",
                cell(float(np.mean([one.best_peak_kept for one in found])), 3),
                f"{np.mean(spoiled):+.3f}",
            )
        )
    lines += table(
        (
            "m",
            "noisy dB",
            "best classical dB",
            "automatic dB",
            "mean margin",
            "least margin",
            "better",
            "peak kept",
            "peak kept, best classical",
            "impulses",
        ),
        rows,
    )
    return [*lines, "", f"![Margin by recording]({STEM}.png)", ""]


def _by_clip(report: Report) -> list[str]:
    lines = ["## By recording", "", "Margin in dB, and the filter that it is measured against.", ""]
    found = {(one.clip, one.multiple): one for one in report.outcomes}
    lines += table(
        ("recording", "motion", "frames", "joints", *(f"m = {m}" for m in report.multiples)),
        [
            (
                clip.name,
                clip.what,
                str(len(clip.motion)),
                str(int(clip.steady.sum())),
                *(
                    f"{found[clip.name, m].margin:+.2f} {found[clip.name, m].best.removesuffix(', oracle')}"
                    for m in report.multiples
                ),
            )
            for clip in report.clips
        ],
        left=(0, 1),
    )
    return [*lines, ""]


def _filters(report: Report) -> list[str]:
    lines = ["## The classical filters", "", "Mean PSNR of each with its best settings, dB.", ""]
    lines += table(
        ("", *(f"m = {m}" for m in report.multiples)),
        [
            (
                row.removesuffix(", oracle"),
                *(f"{np.mean([one.classical[row] for one in report.at(m)]):.2f}" for m in report.multiples),
            )
            for row in report.outcomes[0].classical
        ],
    )
    return [*lines, ""]


def as_dict(report: Report) -> dict[str, Any]:
    """Return everything as plain values; what could not be measured is None."""
    return {
        "version": report.version,
        "command": report.command,
        "method": report.method,
        "seeds": report.seeds,
        "sigma_radians": SIGMA,
        "frames": {clip.name: len(clip.motion) for clip in report.clips},
        "steady_joints": {clip.name: int(clip.steady.sum()) for clip in report.clips},
        "classical": {row: ROWS[row].says for row in report.outcomes[0].classical},
        "outcomes": [
            {
                **{name: _finite(value) for name, value in vars(one).items()},
                "best": one.best,
                "margin": one.margin,
            }
            for one in report.outcomes
        ],
    }


def _finite(value: Any) -> Any:
    return None if isinstance(value, float) and not math.isfinite(value) else value


def draw(report: Report, path: Path) -> None:
    """Draw the margin of every recording at every level."""
    page = figure(9.0, 1.6 + 0.28 * len(report.clips))
    axes = page.subplots()
    names = [clip.name for clip in report.clips]
    places = np.arange(len(names))
    for number, multiple in enumerate(report.multiples):
        margins = {one.clip: one.margin for one in report.at(multiple)}
        axes.plot(
            [margins[name] for name in names],
            places,
            linestyle="none",
            marker="osD^v"[number % 5],
            color=CYCLE[number % len(CYCLE)],
            markersize=6,
            label=f"m = {multiple}",
        )
    axes.axvline(0, color="black", linewidth=0.8)
    quiet(axes)
    axes.set_yticks(places, [f"{clip.name}  {clip.what}" for clip in report.clips], fontsize=8)
    axes.invert_yaxis()
    axes.set_xlabel("PSNR of the automatic method less that of the best classical filter (dB)")
    page.legend(loc="outside upper right", ncols=len(report.multiples), frameon=False)
    page.savefig(path)


__all__ = ["STEM", "Report", "as_dict", "draw", "markdown"]
