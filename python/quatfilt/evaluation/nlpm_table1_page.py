"""Table I as a page. Every sentence about results comes from the numbers."""

import math

import numpy as np

from quatfilt.evaluation.methods import GRID, METHODS, NOISY, ORACLES
from quatfilt.evaluation.nlpm_table1_report import COLUMNS, ROWS, STEM, Report
from quatfilt.evaluation.noises import SIGMA

PRINTED = {"1σ": 85.58, "15σ": 85.52, "30σ": 85.29, "50σ": 84.68, "75σ": 82.46, "impulses": 85.18}
"""The row "Our method" of the paper, decibels."""


def markdown(report: Report) -> str:
    """Return the page."""
    return "\n".join(
        [*_conditions(report), *_findings(report), *_psnr(report), *_all_measures(report), *_by_clip(report)]
    )


def _conditions(report: Report) -> list[str]:
    lines = [
        "# Non-local pose means: Table I of Dean and Lewis",
        "",
        f"Written by `{report.command}`, version {report.version}.",
        "",
        (
            f"Noise is added to clean clips, {report.seeds} times with different seeds, and filtered. `mσ` is Gaussian noise "
            f"of m · {SIGMA} rad per component of the rotation vector (m · {math.degrees(SIGMA):.2f}°); impulses hit 1 % of the "
            "samples and turn them by 10° to 60° about a random axis. Noise and measures concern the steady joints: those that, in "
            "the clean clip, never turn by more than 15° in a frame at 120 frames per second. The other joints are defects of the "
            "recording: spikes to remove, not noise."
        ),
        "",
    ]
    wrapped = [f"{noise.name} {noise.wrapped:.2%}" for noise in report.noises if noise.wrapped >= 5e-5]
    if wrapped:
        lines += [
            (
                f"Noise beyond half a turn wraps round and comes out as a smaller turn the other way: {', '.join(wrapped)} of the "
                "samples."
            ),
            "",
        ]
    lines += ["| clip | motion | frames | steady joints | left out |", "|---|---|--:|--:|---|"]
    for clip in report.clips:
        others = ", ".join(clip.others) or "none"
        lines.append(
            f"| {clip.name} | {clip.what} | {len(clip.motion)} | {int(clip.steady.sum())} | {others} |"
        )
    return [
        *lines,
        "",
        (
            "Rows: `paper` is the paper's setting (window 21, patch 11, bandwidth 0.016 rad), with the mean over the patch or the "
            "printed sum; `auto` is the default, whose bandwidth is the estimated noise; `per joint` gives each joint weights of its "
            f"own; `oracle` takes for each clip and noise the best of {len(GRID)} bandwidths ({GRID[0]:.3f} to {GRID[-1]:.3f} rad), "
            "which nobody could know without the truth. No other row was tuned on these clips."
        ),
        "",
    ]


def _findings(report: Report) -> list[str]:
    lines = ["## What came out", ""]
    fair = [NOISY, *METHODS]
    for noise in report.noises:
        level = {method: report.mean(method, noise.name, "psnr") for method in ROWS}
        best = max(fair, key=lambda method: level[method])
        gain = level[best] - level[NOISY]
        best_oracle = max(ORACLES, key=lambda method: level[method])
        text = f"- {noise.name}: "
        if best == NOISY:
            text += f"no row without an oracle improves on the noisy clip ({level[NOISY]:.2f} dB)"
        else:
            kept = report.mean(best, noise.name, "peak_kept")
            text += f"`{best}` is best, {level[best]:.2f} dB ({gain:+.2f} on the noisy clip), with {kept:.2f} of the peak angular speed"
        lines.append(f"{text}; `{best_oracle}` {level[best_oracle]:.2f} dB.")
    unchanged = [
        (method, [noise.name for noise in report.noises if _same(report, method, noise.name)])
        for method in METHODS
    ]
    for method, names in unchanged:
        if names:
            lines.append(
                f"- `{method}` returns the noisy clip as it is (within 0.01 dB) at {', '.join(names)}."
            )
    return [*lines, *_beside_the_paper(report), ""]


def _same(report: Report, method: str, noise: str) -> bool:
    return abs(report.mean(method, noise, "psnr") - report.mean(NOISY, noise, "psnr")) < 0.01


def _beside_the_paper(report: Report) -> list[str]:
    names = [noise.name for noise in report.noises if noise.name in PRINTED]
    gaussian = [name for name in names if name.endswith("σ")]
    if len(gaussian) < 2:
        return []
    first, last = gaussian[0], gaussian[-1]
    printed = ", ".join(f"{name} {PRINTED[name]}" for name in names)
    falls = ", ".join(
        f"`{method}` {report.mean(method, first, 'psnr') - report.mean(method, last, 'psnr'):.1f} dB"
        for method in ("paper, mean", "auto", "oracle")
    )
    return [
        (
            f"- The paper prints, for its method on one running clip: {printed} dB. It does not say which peak and mean its PSNR has, so "
            f"that the levels cannot be compared. From {first} to {last} its values fall by "
            f"{PRINTED[first] - PRINTED[last]:.1f} dB; here {falls}."
        ),
    ]


def _psnr(report: Report) -> list[str]:
    lines = [
        "## PSNR in dB",
        "",
        f"Mean over the clips ± deviation over the {report.seeds} seeds.",
        "",
        "| method | " + " | ".join(noise.name for noise in report.noises) + " |",
        "|---|" + "--:|" * len(report.noises),
    ]
    for method in ROWS:
        cells = [
            f"{report.mean(method, noise.name, 'psnr'):.2f} ± {report.spread(method, noise.name, 'psnr'):.2f}"
            for noise in report.noises
        ]
        lines.append(f"| {method} | {' | '.join(cells)} |")
    return [*lines, "", f"![PSNR by noise]({STEM}.png)", ""]


def _all_measures(report: Report) -> list[str]:
    lines = [
        "## All measures",
        "",
        (
            "Means over clips and seeds. Angles of the error in degrees, mean and 95th percentile; joint positions in cm (all joints); "
            "rotational jerk as a multiple of the truth's; path of each foot joint while the truth's touches the ground, over the whole "
            "clip; 95th percentile of the angular speed as a share of the truth's; delay in frames."
        ),
        "",
    ]
    for noise in report.noises:
        lines += [
            f"### {noise.name}",
            "",
            "| method | " + " | ".join(title for title, _, _ in COLUMNS) + " |",
            "|---|" + "--:|" * len(COLUMNS),
        ]
        for method in ROWS:
            cells = [_cell(report.mean(method, noise.name, name), digits) for _, name, digits in COLUMNS]
            lines.append(f"| {method} | {' | '.join(cells)} |")
        truth = np.mean(
            [report.mean(NOISY, noise.name, "foot_slide_reference", clip.name) for clip in report.clips]
        )
        lines += ["", f"The truth's own foot slide is {_cell(float(truth), 1)} cm.", ""]
    return lines


def _by_clip(report: Report) -> list[str]:
    lines = ["## PSNR by clip", ""]
    for clip in report.clips:
        lines += [
            f"### {clip.name}, {clip.what}",
            "",
            "| method | " + " | ".join(noise.name for noise in report.noises) + " |",
            "|---|" + "--:|" * len(report.noises),
        ]
        for method in ROWS:
            cells = []
            for noise in report.noises:
                bandwidth = report.of(method, noise.name, clip.name)[0].bandwidth
                chosen = f" ({bandwidth:.3f})" if method in ORACLES and bandwidth is not None else ""
                cells.append(f"{report.mean(method, noise.name, 'psnr', clip.name):.2f}{chosen}")
            lines.append(f"| {method} | {' | '.join(cells)} |")
        lines.append("")
    return [*lines, "In brackets: the bandwidth that the oracle chose, in radians.", ""]


def _cell(value: float, digits: int) -> str:
    return f"{round(value, digits) + 0.0:.{digits}f}" if math.isfinite(value) else "-"  # no −0.00


__all__ = ["markdown"]
