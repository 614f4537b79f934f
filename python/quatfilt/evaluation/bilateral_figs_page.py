"""The bilateral filter's figures as a page and as numbers. Every sentence about results comes from the numbers."""

import math
from dataclasses import dataclass
from typing import Any

from quatfilt.evaluation._markdown import cell, table
from quatfilt.evaluation.bilateral_figs_conditions import (
    DRAWN,
    FIVE,
    FRAMES,
    NOISE,
    PAPERS_JOINTS,
    PAPERS_MILLISECONDS,
    PASSES,
)
from quatfilt.evaluation.bilateral_figs_results import Comparison, Curves, Figures, best_pass, speed

STEM = "bilateral-figs"


@dataclass(frozen=True)
class Run:
    """How the figures were made."""

    seeds: int
    version: str
    command: str


def markdown(figures: Figures, run: Run) -> str:
    """Return the page."""
    return "\n".join(
        [
            *_conditions(figures, run),
            *_findings(figures),
            *_errors(figures),
            *_comparisons(figures),
            *_time(figures),
        ]
    )


def _conditions(figures: Figures, run: Run) -> list[str]:
    drawn = figures.drawn
    return [
        "# The bilateral filter: figures 2 to 4 of Courty",
        "",
        f"Written by `{run.command}`, version {run.version}.",
        "",
        (
            f"Clip {figures.clip} ({figures.what}), {FRAMES} frames from second {figures.start:g} on, {drawn.truth.rotations.shape[1]} "
            f"joints. Every joint gets Gaussian noise of {NOISE} rad ({math.degrees(NOISE):.1f}°) per component of the rotation vector; "
            f"{run.seeds} seeds, means over them. σ_t = 1 frame, window of 9 frames, mirrored ends; `sigma_angle` is 2σ_g; σ_g = ∞ is the "
            "Gaussian filter. MSE is the mean of ‖log(a⁻¹b)‖² on S³. The paper does not say how many frames a second its 150 frames "
            "have, nor is its recording public: three rates are in the table, the lowest is drawn."
        ),
        "",
        f"![The figures]({STEM}.png)",
        "",
        (
            f"Top: MSE by passes, of `{drawn.joint}` (the paper's Fig. 3) and of all joints; error of the filters of section 3.2 by frame, "
            f"after one pass. Middle: angular speed of `{drawn.joint}` (Fig. 2). Bottom: path of `{drawn.hand}` seen from the front, root "
            f"held fast (Fig. 4). Middle and bottom: {FIVE} passes, one seed."
        ),
        "",
    ]


def _findings(figures: Figures) -> list[str]:
    lines = ["## What came out", ""]
    for curves in figures.curves:
        five = {sigma: values[FIVE - 1] for sigma, values in curves.joint.items()}
        least = min(five, key=lambda sigma: five[sigma])
        overall = min(
            (
                (values[best_pass(values) - 1], sigma, best_pass(values))
                for sigma, values in curves.joint.items()
            )
        )
        lines.append(
            f"- {curves.fps:g} frames per second, `{figures.drawn.joint}`: after {FIVE} passes σ_g = {_sigma(least)} has the least MSE, "
            f"{_scaled(five[least])}, σ_g = {DRAWN} {_scaled(five[DRAWN])}, the Gaussian {_scaled(five[math.inf])} (·10⁻³; noisy "
            f"{_scaled(curves.noisy)}). The least of all is {_scaled(overall[0])}, at σ_g = {_sigma(overall[1])} after "
            f"{overall[2]} {'pass' if overall[2] == 1 else 'passes'}."
        )
    curves = figures.curves[0]
    bests = ", ".join(f"σ_g = {_sigma(sigma)}: {best_pass(values)}" for sigma, values in curves.joint.items())
    lines.append(
        f'- The paper: "an average of 5 times the filter yields generally good results". At {curves.fps:g} frames per second the best '
        f"number of passes, of {PASSES}, is {bests}."
    )
    drawn = figures.drawn
    true = speed(drawn.truth, drawn.joint)
    found = {name: speed(motion, drawn.joint) for name, motion in drawn.motions.items()}
    shares = "; ".join(
        f"{name}: {values.mean() / true.mean():.2f} and {values.max() / true.max():.2f}"
        for name, values in found.items()
    )
    lines.append(
        f"- Mean and peak angular speed of `{drawn.joint}` as shares of the truth's, one seed, {FIVE} passes: {shares}."
    )
    return [*lines, *_drift(figures.comparisons), ""]


def _drift(comparisons: tuple[Comparison, ...]) -> list[str]:
    by_name = {one.name: one for one in comparisons}
    fang, chart, lee, flat = (
        by_name[name]
        for name in (
            "displacements integrated",
            "one global chart",
            "Gaussian (Lee and Shin)",
            "R⁴, renormalised",
        )
    )
    return [
        (
            f"- Integrated displacements: MSE {_scaled(fang.first_tenth)} in the first tenth of the clip and {_scaled(fang.last_tenth)} in "
            f"the last, against {_scaled(lee.first_tenth)} and {_scaled(lee.last_tenth)} for Lee and Shin's filter with the same mask."
        ),
        (
            f"- One global chart: the MSE depends on where the clip lies, from {_scaled(chart.turned[0])} to {_scaled(chart.turned[1])} as it is "
            f"turned as a whole; Lee and Shin's filter always has {_scaled(lee.turned[0])}. Renormalised averages in R⁴ do not care either "
            f"({_scaled(flat.turned[0])}), and on motion capture, where frames lie densely, they are level with Lee and Shin's filter: "
            f"{_scaled(flat.five)} and {_scaled(lee.five)} after {FIVE} passes."
        ),
    ]


def _errors(figures: Figures) -> list[str]:
    lines = ["## MSE by passes", ""]
    for title, every in ((f"`{figures.drawn.joint}`", False), ("All joints", True)):
        lines += [f"{title}, ·10⁻³.", ""]
        rows = []
        for curves in figures.curves:
            noisy = curves.noisy_all if every else curves.noisy
            for sigma, values in (curves.every if every else curves.joint).items():
                rows.append(
                    (f"{curves.fps:g} fps, σ_g = {_sigma(sigma)}", _scaled(noisy), *map(_scaled, values))
                )
        lines += table(("", "noisy", *map(str, range(1, PASSES + 1))), rows)
        lines.append("")
    return lines


def _comparisons(figures: Figures) -> list[str]:
    return [
        "## The filters of section 3.2",
        "",
        (
            "The same weights in time for all; MSE over all joints, ·10⁻³, at the lowest frame rate. First and last tenth of "
            "the frames: after five passes. *Turned*: after one pass of one noise, the least and the greatest as the whole clip is turned "
            "by 0°, 30°, … 330°: nothing should change."
        ),
        "",
        *table(
            ("", "one pass", "five passes", "first tenth", "last tenth", "turned"),
            [
                (
                    one.name,
                    *map(_scaled, (one.once, one.five, one.first_tenth, one.last_tenth)),
                    f"{_scaled(one.turned[0])} … {_scaled(one.turned[1])}",
                )
                for one in figures.comparisons
            ],
        ),
        "",
        (
            "Renormalised averages in R⁴ are means of chords. About one fixed axis, at a constant rate, a filter that looks at the next "
            "four frames should give the mean of the angles; it is off by"
        ),
        "",
        *table(
            ("turn from frame to frame", "R⁴, renormalised", "Lee and Shin"),
            [
                (f"{one.step:g}°", f"{cell(one.renormalised, 3)}°", f"{cell(one.lee_shin, 3)}°")
                for one in figures.sparse
            ],
        ),
        "",
    ]


def _time(figures: Figures) -> list[str]:
    return [
        "## Time",
        "",
        (
            f"{PAPERS_JOINTS} joints, {FRAMES} frames, {FIVE} passes; whole calls from Python. The least is what the machine does when "
            "nothing disturbs it."
        ),
        "",
        *table(
            ("", "median, ms", "least, ms", "paper ÷ least"),
            [
                ("the paper, on a standard laptop of 2008", str(PAPERS_MILLISECONDS), "", ""),
                *(
                    (
                        one.what,
                        f"{one.median:.2f}",
                        f"{one.least:.2f}",
                        f"{PAPERS_MILLISECONDS / one.least:.0f}",
                    )
                    for one in figures.timings
                ),
            ],
        ),
        "",
    ]


def _sigma(sigma: float) -> str:
    return "∞" if math.isinf(sigma) else f"{sigma:g}"


def _scaled(value: float) -> str:
    return f"{1e3 * value:.2f}"


def as_dict(figures: Figures, run: Run) -> dict[str, Any]:
    """Return everything as plain values."""

    def curves(one: Curves) -> dict[str, Any]:
        return {
            "fps": one.fps,
            "noisy": {"joint": one.noisy, "all": one.noisy_all},
            "mse_by_pass": {
                _sigma(sigma): {"joint": one.joint[sigma], "all": one.every[sigma]} for sigma in one.joint
            },
        }

    return {
        **vars(run),
        "clip": figures.clip,
        "what": figures.what,
        "start_seconds": figures.start,
        "frames": FRAMES,
        "joint": figures.drawn.joint,
        "hand": figures.drawn.hand,
        "noise_radians": NOISE,
        "curves": [curves(one) for one in figures.curves],
        "comparisons": [vars(one) for one in figures.comparisons],
        "sparse_degrees": [vars(one) for one in figures.sparse],
        "milliseconds": [vars(one) for one in figures.timings],
        "paper_milliseconds": PAPERS_MILLISECONDS,
    }


__all__ = ["STEM", "Run", "as_dict", "markdown"]
