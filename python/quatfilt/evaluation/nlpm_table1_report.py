"""Table I: what was run, and what came out, as numbers."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from quatfilt.evaluation.clips import Clip
from quatfilt.evaluation.methods import GRID, METHODS, NOISY, ORACLES
from quatfilt.evaluation.nlpm_table1 import Result
from quatfilt.evaluation.noises import SIGMA, Noise

STEM = "nlpm-table1"

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

ROWS = (NOISY, *METHODS, *ORACLES)


@dataclass(frozen=True)
class Report:
    """What was run, and what came out."""

    clips: Sequence[Clip]
    noises: Sequence[Noise]
    results: Sequence[Result]
    seeds: int
    version: str
    command: str

    def of(self, method: str, noise: str, clip: str | None = None) -> list[Result]:
        """Return the results of a method with a noise, on one clip or on all."""
        return [
            result
            for result in self.results
            if result.method == method and result.noise == noise and clip in (None, result.clip)
        ]

    def mean(self, method: str, noise: str, measure: str, clip: str | None = None) -> float:
        """Mean over seeds, then over clips."""
        means = [
            np.mean([getattr(one, measure) for one in result.measures])
            for result in self.of(method, noise, clip)
        ]
        return float(np.mean(means))

    def spread(self, method: str, noise: str, measure: str) -> float:
        """Deviation over the seeds of the mean over the clips."""
        values = [[getattr(one, measure) for one in result.measures] for result in self.of(method, noise)]
        return float(np.std(np.mean(values, axis=0)))


def as_dict(report: Report) -> dict[str, Any]:
    """Return everything as plain values; what could not be measured is None."""

    def summary(result: Result) -> dict[str, Any]:
        values = {name: [getattr(one, name) for one in result.measures] for _, name, _ in COLUMNS}
        return {
            "clip": result.clip,
            "noise": result.noise,
            "method": result.method,
            "bandwidth_radians": result.bandwidth,
            "mean": {name: _finite(float(np.mean(each))) for name, each in values.items()},
            "spread": {name: _finite(float(np.std(each))) for name, each in values.items()},
        }

    return {
        "version": report.version,
        "command": report.command,
        "seeds": report.seeds,
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
            for clip in report.clips
        ],
        "methods": {
            **METHODS,
            **{name: {**options, "bandwidth": list(GRID)} for name, options in ORACLES.items()},
        },
        "results": [summary(result) for result in report.results],
    }


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None


__all__ = ["COLUMNS", "ROWS", "STEM", "Report", "as_dict"]
