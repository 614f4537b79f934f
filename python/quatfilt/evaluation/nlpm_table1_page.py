"""Table I as a page. Every sentence about results comes from the numbers."""

import math
from collections.abc import Sequence

import numpy as np

from quatfilt.evaluation._markdown import cell, table
from quatfilt.evaluation.methods import CLASSICAL, NOISY, ROWS
from quatfilt.evaluation.nlpm_table1_report import COLUMNS, STEM, Report, Tables
from quatfilt.evaluation.noises import SIGMA
from quatfilt.evaluation.real_jitter import AROUND, DEFECTS, Jitter

PRINTED = {
    "Gaussian, oracle": {
        "1σ": 73.89,
        "15σ": 73.87,
        "30σ": 73.76,
        "50σ": 73.33,
        "75σ": 72.02,
        "impulses": 73.61,
    },
    "Kalman (forward), oracle": {"1σ": 80.46, "15σ": 80.42, "30σ": 78.50, "50σ": 73.83, "impulses": 80.01},
    "Blender, oracle": {
        "1σ": 93.39,
        "15σ": 92.53,
        "30σ": 84.99,
        "50σ": 84.40,
        "75σ": 78.99,
        "impulses": 88.61,
    },
    "wavelet, oracle": {"1σ": 93.76, "15σ": 67.01, "impulses": 82.59},
    "Butterworth, oracle": {
        "1σ": 82.21,
        "15σ": 82.14,
        "30σ": 81.69,
        "50σ": 80.30,
        "75σ": 77.21,
        "impulses": 81.39,
    },
    "NLPM, oracle": {"1σ": 85.58, "15σ": 85.52, "30σ": 85.29, "50σ": 84.68, "75σ": 82.46, "impulses": 85.18},
}
"""The paper's Table I, decibels, beside the rows of ours that correspond: the paper tuned all methods."""


def markdown(tables: Tables) -> str:
    """Return the page."""
    report = tables.table
    return "\n".join(
        [
            *_conditions(report),
            *_findings(report),
            *_psnr(report),
            *_beside_the_paper(report),
            *_slow(tables.slow),
            *(_more(tables.more) if tables.more else []),
            *(_real_jitter(tables.jitter) if tables.jitter else []),
            *_all_measures(report),
            *_by_clip(report),
        ]
    )


def _conditions(report: Report) -> list[str]:
    lines = [
        "# Denoising: Table I of Dean and Lewis",
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
    lines += table(
        ("clip", "motion", "frames", "steady joints", "left out"),
        [
            (
                clip.name,
                clip.what,
                str(len(clip.motion)),
                str(int(clip.steady.sum())),
                ", ".join(clip.others) or "none",
            )
            for clip in report.clips
        ],
        left=(0, 1, 4),
    )
    lines += [
        "",
        (
            "An `oracle` takes for each clip and noise the best of 17 settings, which nobody could know without the truth; no other row "
            "was tuned on these clips. The classical filters run on numbers, as users run them: on rotation vectors seen from the mean "
            "and not folded back, and on the four components with continuous signs, made unit again. The better of the two counts, for "
            "each clip and noise, in the rows with fixed settings too."
        ),
        "",
    ]
    lines += table(("row", "settings"), [(row, ROWS[row].says) for row in report.rows], left=(0, 1))
    return [*lines, ""]


def _findings(report: Report) -> list[str]:
    lines = ["## What came out", ""]
    classical = [row for row in CLASSICAL if row in report.rows]
    others = [row for row in report.oracles if row not in classical]
    for noise in report.noises:
        level = {row: report.mean(row, noise.name, "psnr") for row in report.rows}
        best = report.best([NOISY, *report.fair], noise.name)
        text = f"- {noise.name}: "
        if best == NOISY:
            text += f"no row without an oracle improves on the noisy clip ({level[NOISY]:.2f} dB)"
        else:
            kept = report.mean(best, noise.name, "peak_kept")
            gain = level[best] - level[NOISY]
            text += f"of the rows without an oracle `{best}` is best, {level[best]:.2f} dB ({gain:+.2f} on the noisy clip), with {kept:.2f} of the peak angular speed"
        for rows in (classical, others):
            if rows:
                row = report.best(rows, noise.name)
                text += f"; `{row}` {level[row]:.2f} dB"
        lines.append(text + ".")
    for row in report.fair:
        same = [noise.name for noise in report.noises if _same(report, row, noise.name)]
        if same:
            lines.append(f"- `{row}` returns the noisy clip as it is (within 0.01 dB) at {', '.join(same)}.")
    if {"Gaussian, oracle", "NLPM, oracle"} <= set(report.rows):
        apart = ", ".join(
            f"{noise.name} {report.mean('NLPM, oracle', noise.name, 'psnr') - report.mean('Gaussian, oracle', noise.name, 'psnr'):+.2f}"
            for noise in report.noises
        )
        lines.append(f"- `NLPM, oracle` less `Gaussian, oracle`, dB: {apart}.")
    chosen = [
        result.setting
        for row in classical
        for noise in report.noises
        for result in report.of(row, noise.name)
    ]
    if chosen:
        vectors = sum(setting.endswith("vectors") for setting in chosen)
        lines.append(
            f"- The classical oracles chose rotation vectors {vectors} times of {len(chosen)}, components otherwise."
        )
    return [*lines, ""]


def _same(report: Report, row: str, noise: str) -> bool:
    return abs(report.mean(row, noise, "psnr") - report.mean(NOISY, noise, "psnr")) < 0.01


def _psnr(report: Report) -> list[str]:
    lines = ["## PSNR in dB", "", f"Mean over the clips ± deviation over the {report.seeds} seeds.", ""]
    lines += _psnr_table(report)
    return [*lines, "", f"![PSNR by noise]({STEM}.png)", ""]


def _psnr_table(report: Report) -> list[str]:
    names = [noise.name for noise in report.noises]
    return table(
        ("row", *names),
        [
            (
                row,
                *(f"{report.mean(row, n, 'psnr'):.2f} ± {report.spread(row, n, 'psnr'):.2f}" for n in names),
            )
            for row in report.rows
        ],
    )


def _beside_the_paper(report: Report) -> list[str]:
    rows = [row for row in PRINTED if row in report.rows]
    names = [noise.name for noise in report.noises if noise.name in PRINTED["NLPM, oracle"]]
    if len(rows) < 2 or not names:
        return []
    lines = [
        "## Beside the paper",
        "",
        (
            "The paper prints one running clip, and tuned every method on it; beside it stand our oracles. It does not say which peak "
            "and mean its PSNR has, so that only the order can be compared: the place in the column is in brackets."
        ),
        "",
    ]
    printed = {n: _placed({row: PRINTED[row].get(n, math.nan) for row in rows}) for n in names}
    found = {n: _placed({row: report.mean(row, n, "psnr") for row in rows}) for n in names}
    lines += table(
        ("row", *(f"{n}: paper" for n in names), *(f"{n}: here" for n in names)),
        [(row, *(printed[n][row] for n in names), *(found[n][row] for n in names)) for row in rows],
    )
    gaussian = [n for n in names if n.endswith("σ")]
    if len(gaussian) > 1:
        first, last = gaussian[0], gaussian[-1]
        ours = PRINTED["NLPM, oracle"]
        falls = ", ".join(
            f"`{row}` {report.mean(row, first, 'psnr') - report.mean(row, last, 'psnr'):.1f} dB"
            for row in ("NLPM, paper, mean", "NLPM", "NLPM, oracle")
            if row in report.rows
        )
        lines += [
            "",
            f"From {first} to {last} the paper's values for its method fall by {ours[first] - ours[last]:.1f} dB; here {falls}.",
        ]
    return [*lines, ""]


def _placed(levels: dict[str, float]) -> dict[str, str]:
    known = sorted((level for level in levels.values() if not math.isnan(level)), reverse=True)
    return {
        row: "-" if math.isnan(level) else f"{level:.2f} ({known.index(level) + 1})"
        for row, level in levels.items()
    }


def _slow(slow: Report) -> list[str]:
    lines = [
        f"## At {slow.fps:g} frames per second",
        "",
        (
            "The same clips with one frame of four, the same joints and kinds of noise: the motion is faster, and there are fewer samples "
            "of it. PSNR in dB; then the share of the peak angular speed."
        ),
        "",
        *_psnr_table(slow),
        "",
    ]
    names = [noise.name for noise in slow.noises]
    lines += table(
        ("row", *names),
        [(row, *(cell(slow.mean(row, n, "peak_kept"), 2) for n in names)) for row in slow.rows],
    )
    return [*lines, ""]


def _more(more: Report) -> list[str]:
    lines = ["## More clips", "", "PSNR in dB, 120 frames per second.", ""]
    names = [noise.name for noise in more.noises]
    for clip in more.clips:
        joints = f"{len(clip.motion)} frames, {int(clip.steady.sum())} steady joints"
        lines += [f"### {clip.name}, {clip.what} ({joints})", "", *_clip_table(more, clip.name, names), ""]
    return lines


def _clip_table(report: Report, clip: str, names: Sequence[str]) -> list[str]:
    return table(
        ("row", *names),
        [(row, *(f"{report.mean(row, n, 'psnr', clip):.2f}" for n in names)) for row in report.rows],
    )


def _real_jitter(jitter: Sequence[Jitter]) -> list[str]:
    lines = [
        "## Real defects",
        "",
        (
            "Recordings as they are, nothing added. What stands for the truth is the *bridge* from the last good frame to the next. "
            "*Off*: farthest from the bridge in the bad frames; *step*: largest turn from one frame to the next there; *around*: mean "
            f"turn away from the recording in the {AROUND} frames before and the {AROUND} after, which were good. Degrees; where all "
            "joints stand still, means over the joints. The classical filters ran on rotation vectors."
        ),
        "",
    ]
    for defect in DEFECTS:
        where = (
            f"frames {defect.first} to {defect.last}"
            if defect.last > defect.first
            else f"frame {defect.first}"
        )
        lines.append(f"- {defect.clip}, {defect.joint or 'all joints'}, {where}: {defect.what}.")
    lines += ["", "*Off* / *step* / *around*:", ""]
    found = {(one.row, one.clip): one for one in jitter}
    lines += table(
        ("row", *(f"{defect.clip} {defect.joint or 'frozen'}" for defect in DEFECTS)),
        [
            (
                "as recorded" if row == NOISY else row,
                *(
                    " / ".join(
                        cell(getattr(found[row, defect.clip], what), 1) for what in ("off", "step", "around")
                    )
                    for defect in DEFECTS
                ),
            )
            for row in dict.fromkeys(one.row for one in jitter)
        ],
    )
    return [*lines, ""]


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
        lines += [f"### {noise.name}", ""]
        lines += table(
            ("row", *(title for title, _, _ in COLUMNS)),
            [
                (row, *(cell(report.mean(row, noise.name, name), digits) for _, name, digits in COLUMNS))
                for row in report.rows
            ],
        )
        truth = np.mean(
            [
                report.mean(report.rows[0], noise.name, "foot_slide_reference", clip.name)
                for clip in report.clips
            ]
        )
        lines += ["", f"The truth's own foot slide is {cell(float(truth), 1)} cm.", ""]
    return lines


def _by_clip(report: Report) -> list[str]:
    lines = ["## PSNR by clip", "", f"What the oracles chose stands in `{STEM}.json`.", ""]
    names = [noise.name for noise in report.noises]
    for clip in report.clips:
        lines += [f"### {clip.name}, {clip.what}", "", *_clip_table(report, clip.name, names), ""]
    return lines


__all__ = ["markdown"]
