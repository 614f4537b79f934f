"""The figures of exact principal geodesic analysis as a page. Every sentence about results comes from the numbers."""

from dataclasses import dataclass

import numpy as np

from quatfilt.evaluation._markdown import cell, table
from quatfilt.evaluation.pga_figs import COMPONENTS, MOST
from quatfilt.evaluation.pga_figs_results import Descents, Figures, Joints
from quatfilt.evaluation.pga_figs_samples import CONCENTRATIONS, SAMPLES, SPREAD

STEM = "pga-figs"

_STEPS = tuple(range(1, COMPONENTS + 1))


@dataclass(frozen=True)
class Run:
    """How the figures were made."""

    version: str
    command: str


def markdown(figures: Figures, run: Run) -> str:
    """Return the page."""
    return "\n".join(
        [
            "# Exact principal geodesic analysis: figures 1 to 4 of Said, Courty, Le Bihan and Sangwine",
            "",
            f"Written by `{run.command}`, version {run.version}.",
            "",
            "Angles are rotation angles in degrees, twice those on S³. `R_k` is the mean angle that k geodesics leave.",
            "",
            f"![The figures]({STEM}.png)",
            "",
            *_low(figures.low),
            *_gaussian(figures),
            *_root(figures),
            *_joints(figures.joints),
        ]
    )


def _low(low: tuple[Descents, ...]) -> list[str]:
    rows = [
        (
            one.what,
            _degrees(one.started, 4),
            _degrees(float(one.printed[0][-1]), 4),
            _degrees(float(one.exact[0][-1]), 4),
            *(_degrees(value, 4) for value in one.residuals[:3]),
        )
        for one in low
    ]
    above = {one.what: float(one.printed[0][-1] - one.residuals[0]) for one in low}
    stalled = {one.what: float(one.exact[0][-1] - one.residuals[0]) for one in low}
    return [
        "## Data of low dimension (Figs. 1 and 2)",
        "",
        (
            f"{SAMPLES} samples, parameters spread evenly and symmetrically up to {SPREAD} on S³ along the first geodesic and half of that "
            "along the second. The descents follow eq. (12) from one random direction."
        ),
        "",
        *table(
            ("samples on", "at eq. (14)", "descent, eq. (13)", "descent, eq. (9)", "R₁", "R₂", "R₃"),
            rows,
        ),
        "",
        (
            f"- One geodesic: eq. (14) is the answer without a step ({_degrees(low[0].started, 6)}°), as the paper says, and "
            f"R₁ = {_degrees(float(low[0].residuals[0]), 6)}°."
        ),
        (
            f"- Products of two geodesics: R₂ = {_degrees(float(low[1].residuals[1]), 6)}°. A plane of half rotation vectors is a surface "
            f"too, and two geodesics leave {_degrees(float(low[2].residuals[1]), 4)}° of it: the product of projections describes "
            "products."
        ),
        (
            f"- Eq. (13) is the gradient of the mean of 1 − cos d; its descent ends above R₁{_sets(above)}. The gradient of eq. (9) jumps "
            f"where a sample lies on the geodesic: steps are halved until the distance falls, and the descent stalls above R₁{_sets(stalled)}. "
            "`PrincipalGeodesicAnalysis` does not depend on a start."
        ),
        "",
    ]


def _sets(above: dict[str, float]) -> str:
    """Say on which sets a descent ends above the lowest distance, and by how much."""
    found = [f"{what} (by {_degrees(by, 4)}°)" for what, by in above.items() if by > 1e-6]
    return f" on {', '.join(found)}" if found else " on none of the sets"


def _gaussian(figures: Figures) -> list[str]:
    gaussian = figures.gaussian
    off = np.median(gaussian.off, axis=0)
    falls = bool((np.diff(gaussian.residuals, axis=1) < 0).all())
    return [
        "## Gaussian on S³ (Fig. 3)",
        "",
        (
            f"Density (18) with Γ of eigenvalues {', '.join(f'{value:g}' for value in CONCENTRATIONS)}, {SAMPLES} samples, "
            f"{gaussian.seeds} seeds."
        ),
        "",
        *table(
            ("", *(f"k = {k}" for k in _STEPS)),
            [
                ("R_k, mean", *(_degrees(value, 4) for value in gaussian.residuals.mean(axis=0))),
                ("least", *(_degrees(value, 4) for value in gaussian.residuals.min(axis=0))),
                (
                    "from the eigenvector of Γ, median",
                    *(cell(float(value), 2) for value in off),
                    *["-"] * (COMPONENTS - len(off)),
                ),
            ],
        ),
        "",
        (
            f"R_k {'falls' if falls else 'does not fall'} through k = {COMPONENTS} with every seed, and R₅ > 0, as in the paper. The first "
            f"three directions are the eigenvectors of Γ within what {SAMPLES} samples tell: "
            f"{', '.join(cell(float(value), 1) for value in off)}° away in the median."
        ),
        "",
    ]


def _root(figures: Figures) -> list[str]:
    root = figures.root
    return [
        "## The root of a recording (Fig. 4)",
        "",
        (
            f"{root.clip} ({root.what}): {root.errors.shape[1]} frames at {root.motion.fps:g} per second. The worst frames beside the mean: "
            "complicated moments need more geodesics, as the paper says."
        ),
        "",
        *table(
            ("", *(f"k = {k}" for k in _STEPS)),
            [
                ("R_k", *(_degrees(value, 4) for value in root.residuals)),
                ("greatest error", *(_degrees(value, 3) for value in root.errors.max(axis=1))),
                ("k tangent principal axes", *(_degrees(value, 4) for value in root.tangent)),
            ],
        ),
        "",
    ]


def _joints(clips: tuple[Joints, ...]) -> list[str]:
    rows = [
        (
            f"{one.clip} ({one.what})",
            name,
            *(_degrees(float(value), 4) for value in np.median(values, axis=1)),
        )
        for one in clips
        for name, values in (("geodesics", one.residuals), ("tangent axes", one.tangent))
    ]
    better = [np.count_nonzero(one.residuals[0] <= one.tangent[0] + 1e-12) for one in clips]
    second = [np.count_nonzero(one.residuals[1] <= one.tangent[1] + 1e-12) for one in clips]
    joints = sum(len(one.names) for one in clips)
    needed = [
        (
            one.clip,
            str(len(one.names)),
            *(f"{int(np.median(counts))}, {_most(int(counts.max()))}" for counts in one.needed.values()),
        )
        for one in clips
    ]
    tolerances = next(iter(clips)).needed
    apart = [f"{one.clip}: {', '.join(one.left_out)}" for one in clips if one.left_out]
    return [
        "## Joints of recordings",
        "",
        "Median over the steady joints of the mean angle that is left, beside principal axes in the tangent space of the mean (tangent PCA).",
        "",
        *table(("clip", "", *(f"k = {k}" for k in _STEPS)), rows, left=(0, 1)),
        "",
        (
            f"- One geodesic leaves at most what the first tangent axis leaves on {sum(better)} of {joints} joints; two leave at most what "
            f"two tangent axes do on {sum(second)}."
        ),
        (
            "- Three tangent axes hold every rotation, so tangent PCA leaves nothing from k = 3 on. A product of projections is no chart: each "
            "factor takes the nearest point of its geodesic, and what three of them leave is small and not zero. Who only wants three "
            "numbers for a rotation takes its logarithm; geodesics are for what one or two of them say."
        ),
        *(
            [f"- Left out, for they turn half a turn away from their mean: {'; '.join(apart)}."]
            if apart
            else []
        ),
        "",
        "Geodesics that a mean angle needs, median and most over the joints:",
        "",
        *table(
            ("clip", "joints", *(f"{tolerance:g}°" for tolerance in tolerances)),
            needed,
        ),
        "",
    ]


def _most(count: int) -> str:
    return str(count) if count <= MOST else f"> {MOST}"


def _degrees(value: float, digits: int) -> str:
    return cell(float(np.degrees(value)), digits)


__all__ = ["STEM", "Run", "markdown"]
