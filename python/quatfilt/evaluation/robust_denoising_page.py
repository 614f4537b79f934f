"""The automatic method on the noise of real trackers, as a page, as numbers and as a picture."""

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from quatfilt.evaluation._markdown import cell, table
from quatfilt.evaluation._plot import CYCLE, figure, quiet
from quatfilt.evaluation.clips import Clip
from quatfilt.evaluation.noise_kinds import KINDS
from quatfilt.evaluation.robust_denoising import (
    AUTOMATIC,
    BUTTERWORTH,
    CLASSICAL_SEEDS,
    LONGEST,
    METHODS,
    RIVALS,
    Outcome,
    Unchanged,
)

STEM = "robust-denoising"

ALLOWED = -0.5
"""Decibels: no recording is to be farther below the better rival."""


@dataclass(frozen=True)
class Report:
    """Conditions and results."""

    clips: Sequence[Clip]
    outcomes: Sequence[Outcome]
    unchanged: Sequence[Unchanged]
    seeds: int
    version: str
    command: str

    @property
    def rates(self) -> list[float]:
        """The frame rates, the highest first."""
        return sorted({one.fps for one in self.outcomes}, reverse=True)

    @property
    def kinds(self) -> list[str]:
        """The kinds of noise, in the order of the table."""
        present = {one.kind for one in self.outcomes}
        return [kind for kind in KINDS if kind in present]

    def cells(self, fps: float) -> list[list[Outcome]]:
        """Return the outcomes of one frame rate: a list over the recordings for each kind and level."""
        found: dict[tuple[str, float | None], list[Outcome]] = {}
        for one in self.outcomes:
            if one.fps == fps:
                found.setdefault((one.kind, one.level), []).append(one)
        order = self.kinds
        return [found[key] for key in sorted(found, key=lambda key: (order.index(key[0]), key[1] or 0.0))]


def markdown(report: Report) -> str:
    """Return the page."""
    lines = [*_conditions(report), *_losses(report)]
    for fps in report.rates:
        lines += _rate(report, fps)
    return "\n".join([*lines, *_clean(report), *_kinds(report)])


def _conditions(report: Report) -> list[str]:
    clips = ", ".join(f"{clip.name} ({clip.what})" for clip in report.clips)
    return [
        "# The automatic method on the noise of trackers",
        "",
        f"Written by `{report.command}`, version {report.version}.",
        "",
        (
            f"`denoise(motion)` without options, beside its presets, `kalman` with its defaults and a Butterworth filter of 6 Hz (bw6), on "
            f"{len(report.clips)} recordings that no constant was tuned on: {clips}; the first {LONGEST} frames at 120 frames per second, or "
            f"every second or fourth of them. Noise is added to all joints, with {report.seeds} seeds; errors are those of the steady joints. "
            "*Best classical* is the best of Gaussian, Kalman smoother, wavelet, Butterworth and Savitzky-Golay, each with the best of 17 "
            f"settings by the truth, on {min(CLASSICAL_SEEDS, report.seeds)} of the seeds."
        ),
        "",
        f"![Decibels over bw6 by kind of noise]({STEM}.png)",
        "",
    ]


def _losses(report: Report) -> list[str]:
    rivals = " and ".join(RIVALS)
    lost = sorted((one for one in report.outcomes if one.margin < ALLOWED), key=lambda one: one.margin)
    lines = [
        "## Where it loses",
        "",
        (
            f"Of {len(report.outcomes)} combinations of recording, frame rate, kind and level, {len(lost)} are more than {-ALLOWED} dB below the "
            f"better of {rivals}."
        ),
        "",
    ]
    if not lost:
        return lines
    lines += table(
        ("kind", "fps", "level, rad", "recordings below", "worst, dB"),
        [
            (
                found[0].kind,
                f"{fps:g}",
                _level(found[0]),
                f"{sum(one.margin < ALLOWED for one in found)} of {len(found)}",
                f"{(worst := min(found, key=lambda one: one.margin)).margin:+.2f} ({worst.clip})",
            )
            for fps in report.rates
            for found in report.cells(fps)
            if any(one.margin < ALLOWED for one in found)
        ],
    )
    return [*lines, ""]


def _rate(report: Report, fps: float) -> list[str]:
    lines = [
        f"## {fps:g} frames per second",
        "",
        (
            "Mean PSNR over recordings and seeds, dB. *Margin*: `denoise` less the better of kalman and bw6 on the same recording, mean and worst. "
            "*Peak kept*: 95th percentile of the angular speed, 1 = the truth's. *Foot slide*: path of the feet while the truth's are on the ground, cm: "
            "truth, input, `denoise`."
        ),
        "",
    ]
    lines += table(
        (
            "kind",
            "level, rad",
            "input",
            *METHODS,
            "best classical",
            "margin",
            "worst",
            "peak kept",
            "foot slide",
        ),
        [
            (
                found[0].kind,
                _level(found[0]),
                _mean(found, lambda one: one.noisy),
                *(_mean(found, lambda one, name=name: one.psnr[name]) for name in METHODS),  # type: ignore[misc]
                _mean(found, lambda one: one.best_psnr),
                f"{np.mean([one.margin for one in found]):+.2f}",
                f"{min(one.margin for one in found):+.2f}",
                _mean(found, lambda one: one.peak_kept, 2),
                " / ".join(
                    _mean(found, measure)
                    for measure in (
                        lambda one: one.slide_truth,
                        lambda one: one.slide_noisy,
                        lambda one: one.slide,
                    )
                ),
            )
            for found in report.cells(fps)
        ],
    )
    return [*lines, ""]


def _clean(report: Report) -> list[str]:
    lines = [
        "## Clean recordings",
        "",
        "The same recordings without noise. *Change*: angle between the recording and the result, degrees.",
        "",
    ]
    rows = []
    for fps in report.rates:
        for name in METHODS:
            found = [one for one in report.unchanged if one.fps == fps and one.method == name]
            worst = max(found, key=lambda one: one.change)
            kept = [one.peak_kept for one in found]
            more = [one.slide - one.slide_truth for one in found]
            rows.append(
                (
                    f"{fps:g}",
                    name,
                    cell(float(np.mean([one.change for one in found])), 3),
                    f"{worst.change:.3f} ({worst.clip})",
                    cell(float(np.mean([one.change_p95 for one in found])), 3),
                    f"{np.mean(kept):.3f} ({min(kept):.3f} … {max(kept):.3f})",
                    f"{_mean(found, lambda one: one.slide_truth)} → {_mean(found, lambda one: one.slide)}",
                    cell(max(more), 1),
                )
            )
    lines += table(
        (
            "fps",
            "method",
            "change, mean",
            "largest mean",
            "change, 95 %",
            "peak kept",
            "foot slide, cm",
            "most slide added, cm",
        ),
        rows,
        left=(1,),
    )
    return [*lines, ""]


def _kinds(report: Report) -> list[str]:
    lines = ["## The kinds of noise", "", "σ is the level. Lengths are in frames at every frame rate.", ""]
    return [
        *lines,
        *table(("kind", "definition"), [(name, KINDS[name].says) for name in report.kinds], left=(0, 1)),
        "",
    ]


def _level(one: Outcome) -> str:
    return "-" if one.level is None else f"{one.level:g}"


def _mean(found: Iterable[Any], measure: Callable[[Any], float], digits: int = 1) -> str:
    return cell(float(np.mean([measure(one) for one in found])), digits)


def as_dict(report: Report) -> dict[str, Any]:
    """Return everything as plain values; what could not be measured is None."""
    return {
        "version": report.version,
        "command": report.command,
        "seeds": report.seeds,
        "frames": {clip.name: len(clip.motion) for clip in report.clips},
        "steady_joints": {clip.name: int(clip.steady.sum()) for clip in report.clips},
        "methods": METHODS,
        "kinds": {name: KINDS[name].says for name in report.kinds},
        "outcomes": [{**_plain(one), "margin": one.margin} for one in report.outcomes],
        "clean": [_plain(one) for one in report.unchanged],
    }


def _plain(one: Outcome | Unchanged) -> dict[str, Any]:
    return {
        name: None if isinstance(value, float) and not math.isfinite(value) else value
        for name, value in vars(one).items()
    }


def draw(report: Report, path: Path) -> None:
    """Draw decibels over the 6 Hz Butterworth filter by kind of noise: a panel for each frame rate, means over recordings and levels."""
    kinds, rates = report.kinds, report.rates
    page = figure(3.6 + 2.6 * len(rates), 1.6 + 0.3 * len(kinds))
    panels = page.subplots(1, len(rates), sharey=True, sharex=True, squeeze=False)[0]
    columns = [name for name in METHODS if name != BUTTERWORTH]
    for axes, fps in zip(panels, rates, strict=True):
        for number, name in enumerate([*columns, "best classical"]):
            gains = [
                [_over(one, name) for one in report.outcomes if one.fps == fps and one.kind == kind]
                for kind in kinds
            ]
            axes.plot(
                [np.mean(gain) for gain in gains],
                range(len(kinds)),
                linestyle="none",
                marker="osD^vP"[number % 6],
                color=CYCLE[1] if name == AUTOMATIC else CYCLE[(0, 2, 3, 4, 5, 6)[(number - 1) % 6]],
                markersize=7 if name == AUTOMATIC else 4.5,
                zorder=3 if name == AUTOMATIC else 2,
                label=name,
            )
        axes.axvline(0, color="black", linewidth=0.8)
        quiet(axes)
        axes.set_title(f"{fps:g} frames per second", fontsize=10)
        axes.set_xlabel("PSNR over bw6 (dB)")
    panels[0].set_yticks(range(len(kinds)), kinds, fontsize=8)
    panels[0].invert_yaxis()
    handles, labels = panels[0].get_legend_handles_labels()
    page.legend(handles, labels, loc="outside upper center", ncols=6, frameon=False)
    page.savefig(path)


def _over(one: Outcome, name: str) -> float:
    return (one.best_psnr if name == "best classical" else one.psnr[name]) - one.psnr[BUTTERWORTH]


__all__ = ["STEM", "Report", "as_dict", "draw", "markdown"]
