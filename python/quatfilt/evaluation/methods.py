"""The rows of Table I: methods with fixed settings, and oracles that choose by the result."""

from typing import Any

from quatfilt.evaluation.noises import SIGMA

PAPER = {"search_radius": 10, "patch_radius": 5, "bandwidth": SIGMA}
"""Window of 21 poses, patch of 11, σ = 0.008."""

METHODS: dict[str, dict[str, Any]] = {
    "paper, mean": {**PAPER, "distance": "mean"},
    "paper, sum": {**PAPER, "distance": "sum"},
    "auto": {},
    "auto, per joint": {"weights": "joint"},
}
"""Rows with fixed settings; all else is the default of `nonlocal_pose_means`."""

GRID = tuple(SIGMA * 2 ** (half / 2) for half in range(-2, 15))
"""Bandwidths of the oracle rows, radians: 0.008 to 2.05 in steps of √2."""

ORACLES: dict[str, dict[str, Any]] = {
    "oracle": {},
    "oracle, per joint": {"weights": "joint"},
}
"""For each clip and noise the best bandwidth of the grid, by the mean PSNR over the seeds."""

NOISY = "noisy"


__all__ = ["GRID", "METHODS", "NOISY", "ORACLES"]
