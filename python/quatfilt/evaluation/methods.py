"""The rows of the tables: what is done to noisy clips.

A row offers candidates, each a setting and what it makes of the clips; the best by PSNR counts. A row with a fixed setting
offers one, or one for each view of the rotations as numbers; an oracle offers a grid, and so knows the truth.
"""

import itertools
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from quatfilt._typing import Array
from quatfilt.denoise import denoise
from quatfilt.evaluation.baselines import BASELINES, SETTINGS, Baseline
from quatfilt.evaluation.channels import VIEWS
from quatfilt.evaluation.noises import SIGMA
from quatfilt.filters.bilateral import bilateral
from quatfilt.filters.nonlocal_pose_means import nonlocal_pose_means
from quatfilt.filters.smooth import smooth


@dataclass(frozen=True)
class Clips:
    """Versions of one clip that differ in their noise, side by side."""

    rotations: Array
    """``(frames, versions · joints, 4)``."""
    versions: int
    fps: float

    @classmethod
    def of(cls, versions: Sequence[Array], fps: float) -> "Clips":
        """Put versions ``(frames, joints, 4)`` side by side."""
        return cls(np.concatenate(versions, axis=1), len(versions), fps)

    def apart(self, rotations: Array) -> list[Array]:
        """Return the versions of a result, each ``(frames, joints, 4)``."""
        return [np.ascontiguousarray(part) for part in np.split(rotations, self.versions, axis=1)]

    def each(self, run: Callable[[Array], Array]) -> Array:
        """Filter the versions one by one: for filters that look at whole poses."""
        return np.concatenate([run(version) for version in self.apart(self.rotations)], axis=1)


Candidates = Iterator[tuple[str, Array]]
"""Settings in words, and the clips filtered with them."""


@dataclass(frozen=True)
class Row:
    """One row of a table."""

    name: str
    candidates: Callable[[Clips], Candidates]
    oracle: bool
    says: str
    """The settings, for the page."""


NOISY = "noisy"


def _as_it_is(clips: Clips) -> Candidates:
    yield "", clips.rotations


def _classical(baseline: Baseline) -> tuple[Row, Row]:
    """Return the two rows of a filter for numbers."""

    def swept(clips: Clips, settings: Sequence[float]) -> Candidates:
        for name, view in VIEWS.items():
            channels = view(clips.rotations)
            results = baseline.sweep(channels.values, settings, clips.fps)
            for setting, values in zip(settings, results, strict=True):
                yield f"{setting:.3g} {baseline.unit}, {name}", channels.rotations(values)

    grid = baseline.grid(120.0)
    says = f"{SETTINGS} settings, {min(grid):.3g} to {max(grid):.3g} {baseline.unit} at 120 frames per second"
    return (
        Row(baseline.name, lambda clips: swept(clips, [baseline.default]), False, baseline.source),
        Row(f"{baseline.name}, oracle", lambda clips: swept(clips, baseline.grid(clips.fps)), True, says),
    )


def _fixed(name: str, says: str, run: Callable[[Clips], Array]) -> Row:
    def only(clips: Clips) -> Candidates:
        yield "", run(clips)

    return Row(name, only, False, says)


PAPER = {"search_radius": 10, "patch_radius": 5, "bandwidth": SIGMA}
"""Dean and Lewis: window of 21 poses, patch of 11, σ = 0.008 of log-quaternions."""

BANDWIDTHS = tuple(SIGMA * 2 ** (half / 2) for half in range(-2, 15))
"""Radians: 0.008 to 2.05 in steps of √2."""


def _pose_means(name: str, says: str, **options: Any) -> Row:
    return _fixed(name, says, lambda clips: clips.each(partial(nonlocal_pose_means, **options)))


def _pose_means_oracle(name: str, **options: Any) -> Row:
    def swept(clips: Clips) -> Candidates:
        for bandwidth in BANDWIDTHS:
            run = partial(nonlocal_pose_means, bandwidth=bandwidth, **options)
            yield f"{bandwidth:.3f} rad", clips.each(run)

    return Row(name, swept, True, f"{SETTINGS} bandwidths, {BANDWIDTHS[0]:.3f} to {BANDWIDTHS[-1]:.3f} rad")


PASSES = tuple(
    (angle, iterations)
    for angle in (0.05, 0.1, 0.2, 0.4, 0.8, np.inf)
    for iterations in (1, 5, 25)
    if (angle, iterations) != (0.05, 25)
)
"""`sigma_angle` in radians and `iterations` of the bilateral filter: 17 settings."""


def _bilateral_oracle(clips: Clips) -> Candidates:
    for angle, iterations in PASSES:
        yield (
            f"{angle:g} rad, {iterations} passes",
            bilateral(clips.rotations, sigma_angle=angle, iterations=iterations),
        )


ROWS: dict[str, Row] = {
    row.name: row
    for row in (
        _fixed(NOISY, "as it is", lambda clips: clips.rotations),
        *itertools.chain.from_iterable(map(_classical, BASELINES)),
        _fixed("bilateral", "the defaults", lambda clips: bilateral(clips.rotations)),
        Row(
            "bilateral, oracle",
            _bilateral_oracle,
            True,
            f"{SETTINGS} pairs of `sigma_angle` (0.05 to infinite) and passes (1, 5, 25)",
        ),
        _pose_means(
            "NLPM, paper, mean", "Dean and Lewis's setting, mean over the patch", **PAPER, distance="mean"
        ),
        _pose_means("NLPM, paper, sum", "the same, printed sum", **PAPER, distance="sum"),
        _pose_means("NLPM", "the defaults: bandwidth from the estimated noise"),
        _pose_means("NLPM, per joint", "the same, weights for each joint", weights="joint"),
        _pose_means_oracle("NLPM, oracle"),
        _pose_means_oracle("NLPM, per joint, oracle", weights="joint"),
        _fixed("automatic smoother", "`smooth`, the defaults", lambda clips: smooth(clips.rotations)),
        _fixed(
            "automatic smoother, together",
            '`smooth(joints="together")`',
            lambda clips: clips.each(partial(smooth, joints="together")),
        ),
        _fixed(
            "auto",
            "`denoise`, which is told the frame rate: despike, then the smoother before",
            lambda clips: clips.each(lambda q: denoise(q, fps=clips.fps)),
        ),
    )
}
"""In the order of the tables."""

CLASSICAL = tuple(f"{baseline.name}, oracle" for baseline in BASELINES)
"""The rows that an automatic method has to beat."""

__all__ = ["CLASSICAL", "NOISY", "ROWS", "Clips", "Row"]
