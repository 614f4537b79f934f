"""Table I: what was run, and what came out, as numbers."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from quatfilt.evaluation.clips import Clip
from quatfilt.evaluation.methods import NOISY, ROWS
from quatfilt.evaluation.nlpm_table1 import Result
from quatfilt.evaluation.noises import SIGMA, Noise
from quatfilt.evaluation.real_jitter import Jitter

STEM = "nlpm-table1"

DIGITS = 5
"""Significant digits of the numbers that are kept: the spread over the seeds is in the third."""

COLUMNS = (
    ("PSNR dB", "psnr", 2),
    ("mean °", "angle_mean", 3),
    ("95 % °", "angle_p95", 3),
    ("position cm", "position", 3),
    ("jerk", "jerk_ratio", 2),
    ("foot slide cm", "foot_slide", 1),
    ("peak kept", "peak_kept", 3),
    ("delay", "delay", 2),
)


@dataclass(frozen=True)
class Report:
    """Clips of one frame rate, and what came out."""

    clips: Sequence[Clip]
    noises: Sequence[Noise]
    results: Sequence[Result]
    seeds: int
    version: str
    command: str

    @property
    def fps(self) -> float:
        """Frame rate of the clips."""
        return self.clips[0].motion.fps

    @cached_property
    def rows(self) -> list[str]:
        """Names of the rows, in order."""
        return list(dict.fromkeys(result.row for result in self.results))

    @property
    def oracles(self) -> list[str]:
        """The rows that chose by the result."""
        return [row for row in self.rows if ROWS[row].oracle]

    @property
    def fair(self) -> list[str]:
        """The rows that did not, without the noisy clips themselves."""
        return [row for row in self.rows if not ROWS[row].oracle and row != NOISY]

    @cached_property
    def _by_place(self) -> dict[tuple[str, str], list[Result]]:
        places: dict[tuple[str, str], list[Result]] = {}
        for result in self.results:
            places.setdefault((result.row, result.noise), []).append(result)
        return places

    def of(self, row: str, noise: str, clip: str | None = None) -> list[Result]:
        """Return the results of a row with a noise, on one clip or on all."""
        return [result for result in self._by_place[row, noise] if clip in (None, result.clip)]

    def mean(self, row: str, noise: str, measure: str, clip: str | None = None) -> float:
        """Mean over seeds, then over the clips where it could be measured."""
        means = [
            np.mean([getattr(one, measure) for one in result.measures])
            for result in self.of(row, noise, clip)
        ]
        known = [mean for mean in means if not math.isnan(mean)]
        return float(np.mean(known)) if known else math.nan

    def spread(self, row: str, noise: str, measure: str) -> float:
        """Deviation over the seeds of the mean over the clips."""
        values = [[getattr(one, measure) for one in result.measures] for result in self.of(row, noise)]
        return float(np.std(np.mean(values, axis=0)))

    def best(self, rows: Sequence[str], noise: str) -> str:
        """Return the row with the greatest mean PSNR."""
        return max(rows, key=lambda row: self.mean(row, noise, "psnr"))


@dataclass(frozen=True)
class Tables:
    """Everything on the page."""

    table: Report
    """Of Table I."""
    slow: Report
    """The same clips thinned."""
    more: Report | None
    """More clips."""
    jitter: Sequence[Jitter]
    """Real defects."""

    @property
    def reports(self) -> list[Report]:
        """All that was measured with added noise."""
        return [report for report in (self.table, self.slow, self.more) if report is not None]


def as_dict(tables: Tables) -> dict[str, Any]:
    """Return everything as plain values; what could not be measured is None."""
    first = tables.table
    return {
        "version": first.version,
        "command": first.command,
        "seeds": first.seeds,
        "sigma_radians": SIGMA,
        "clips": [
            {
                "name": clip.name,
                "what": clip.what,
                "frames": len(clip.motion),
                "fps": clip.motion.fps,
                "steady_joints": [
                    n for n, steady in zip(clip.motion.skeleton.names, clip.steady, strict=True) if steady
                ],
                "other_joints": clip.others,
            }
            for report in tables.reports
            for clip in report.clips
        ],
        "rows": {row: {"oracle": ROWS[row].oracle, "settings": ROWS[row].says} for row in first.rows},
        "measures": [name for _, name, _ in COLUMNS],
        "results": [_summary(result) for report in tables.reports for result in report.results],
        "real_jitter": [{name: _finite(value) for name, value in vars(one).items()} for one in tables.jitter],
    }


def _summary(result: Result) -> dict[str, Any]:
    values = [[getattr(one, name) for one in result.measures] for _, name, _ in COLUMNS]
    return {
        "clip": result.clip,
        "fps": result.fps,
        "noise": result.noise,
        "row": result.row,
        "setting": result.setting,
        "mean": [_short(float(np.mean(each))) for each in values],
        "spread": [_short(float(np.std(each))) for each in values],
    }


def _short(value: float) -> float | None:
    return float(f"{value:.{DIGITS}g}") if math.isfinite(value) else None


def _finite(value: Any) -> Any:
    return None if isinstance(value, float) and not math.isfinite(value) else value


__all__ = ["COLUMNS", "STEM", "Report", "Tables", "as_dict"]
