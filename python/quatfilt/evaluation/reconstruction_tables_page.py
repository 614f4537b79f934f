"""The reconstruction tables as a page. Every sentence about results comes from the numbers."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from quatfilt.evaluation._markdown import cell, table
from quatfilt.evaluation.reconstruction_tables import Tables
from quatfilt.evaluation.reconstruction_tables_conditions import (
    ACTIONS,
    CONTROL_POINTS,
    FPS,
    LONGEST,
    MODELS,
    PAPER,
    SHARES,
)

STEM = "reconstruction-tables"

PROPOSED = "local_regression"

AIMS = {"local_pcr": 0.6, "local_pca": 0.5}
"""The error that the proposed model was hoped to have, as a part of another's, with four control points."""


@dataclass(frozen=True)
class Run:
    """How the tables were made."""

    version: str
    command: str


def models(tables: Tables) -> list[str]:
    """Return the models that were tried, in the order of the tables."""
    tried = {one.model for one in tables.results}
    return [model for model in MODELS if model in tried]


def markdown(tables: Tables, run: Run) -> str:
    """Return the page."""
    return "\n".join(
        [
            "# Reconstruction from a few trajectories: tables of Mousas, Newbury and Anagnostopoulos",
            "",
            f"Written by `{run.command}`, version {run.version}.",
            "",
            *_conditions(tables),
            f"![Errors by control points and action]({STEM}.png)",
            "",
            *_points(tables),
            *_findings(tables),
            *_actions(tables),
            *_sizes(tables),
            *_known(tables),
            *_limits(tables),
            *_times(tables),
        ]
    )


def _conditions(tables: Tables) -> list[str]:
    clips = "; ".join(f"{name} ({what})" for name, what in tables.clips.items())
    sets = "; ".join(f"{count}: {', '.join(names)}" for count, names in CONTROL_POINTS.items())
    return [
        (
            f"Recordings of {tables.people} people at {FPS:g} frames per second. Test clips, their first {LONGEST} frames: {clips}. The "
            "database holds all clips of all other people; of golf there is one recording, so that every other frame of it is in "
            "the database as well, and its numbers are no test. The performer's bone lengths are given; defaults throughout. They "
            "were chosen on three people who are not tested."
        ),
        "",
        f"Control points: {sets}. They come from the recording, without noise.",
        "",
        (
            "Errors are means over frames and clips, without golf: angle between true and reconstructed rotations of the joints that do not "
            "flip in the recording itself, in degrees, and distance of all joints, in centimetres. `mean pose` takes the weighted mean of the "
            "same examples, `nearest neighbour` the next pose of the most similar one, `GPLVM` learns 500 poses of the database; all rows are "
            "solved for the control points alike."
        ),
        "",
    ]


def _rows(
    tables: Tables, columns: Sequence[tuple[str, Mapping[str, Any]]], shown: Sequence[str]
) -> list[tuple[str, ...]]:
    return [
        (
            MODELS[model],
            *(
                f"{cell(tables.mean('angle', model=model, **where), 1)} / {cell(tables.mean('position', model=model, **where), 1)}"
                for _, where in columns
            ),
        )
        for model in shown
    ]


def _tested(tables: Tables) -> Tables:
    """Return the results that are a test."""
    kept = [one for one in tables.results if not one.known]
    return Tables(kept, tables.limits, tables.clips, tables.people, tables.left_out)


def _points(tables: Tables) -> list[str]:
    tested = _tested(tables)
    columns = [(f"{count} points", {"points": count, "share": 1}) for count in CONTROL_POINTS]
    paper = [
        (f"paper: {MODELS[model]}", *("-" if value is None else f"{value:.2f}" for value in values))
        for model, values in PAPER.items()
    ]
    lines = [
        "## By number of control points (Table 1)",
        "",
        "Degrees / centimetres.",
        "",
        *table(("", *(title for title, _ in columns)), [*_rows(tested, columns, models(tables)), *paper]),
        "",
        "The paper does not say what its numbers are, and some of them are lost in print.",
        "",
    ]
    if tables.left_out:
        lines += [f"- Not tried: {'; '.join(tables.left_out)}.", ""]
    return lines


def _findings(tables: Tables) -> list[str]:
    tested = _tested(tables)
    lines = []
    for measure, unit in (("angle", "angle"), ("position", "position")):
        own = tested.mean(measure, model=PROPOSED, points=4, share=1)
        for other, aim in AIMS.items():
            theirs = tested.mean(measure, model=other, points=4, share=1)
            if math.isnan(theirs):
                continue
            lines.append(
                f"- With four points the {unit} error of the proposed model is {own / theirs:.2f} of that of {MODELS[other]}; the aim was "
                f"{aim:g}: {'reached' if own <= aim * theirs else 'missed'}."
            )
        falling = [tested.mean(measure, model=PROPOSED, points=count, share=1) for count in CONTROL_POINTS]
        lines.append(
            f"- The {unit} error of the proposed model {'falls' if all(np.diff(falling) < 0) else 'does not always fall'} with the number of points."
        )
    best = {count: _best(tested, count) for count in CONTROL_POINTS}
    winners = ", ".join(f"{count} points: {MODELS[model]}" for count, model in best.items())
    lines.append(f"- Least position error: {winners}.")
    return [*lines, ""]


def _best(tables: Tables, count: int) -> str:
    """Return the model with the least position error."""
    errors = {model: tables.mean("position", model=model, points=count, share=1) for model in models(tables)}
    return min(errors, key=lambda model: errors[model])


def _actions(tables: Tables) -> list[str]:
    columns = [(action, {"action": action, "share": 1}) for action in ACTIONS if tables.of(action=action)]
    lines = ["## By action (Fig. 3)", "", "Degrees / centimetres; golf is within one recording.", ""]
    for count in (6, 4):
        rows = [
            (
                MODELS[model],
                *(
                    _both(
                        [
                            one
                            for one in tables.of(model=model, points=count, **where)
                            if one.known == (one.action == "golf")
                        ]
                    )
                    for _, where in columns
                ),
            )
            for model in models(tables)
        ]
        lines += [
            *table((f"{count} points", *(title for title, _ in columns)), rows),
            "",
        ]
    return lines


def _both(results: Sequence[object]) -> str:
    values = [
        float(np.mean([getattr(one, name) for one in results])) if results else math.nan
        for name in ("angle", "position")
    ]
    return " / ".join(cell(value, 1) for value in values)


def _sizes(tables: Tables) -> list[str]:
    tested = _tested(tables)
    columns = [
        (f"{_poses(tested, share)} poses", {"points": 4, "share": share})
        for share in SHARES
        if tested.of(share=share)
    ]
    errors = [
        tested.mean("position", model=PROPOSED, points=4, share=share)
        for share in SHARES
        if tested.of(share=share)
    ]
    return [
        "## By size of the database (Table 2)",
        "",
        "Four control points; one clip in sixteen, in four, and all; mean number of poses. Degrees / centimetres.",
        "",
        *table(("", *(title for title, _ in columns)), _rows(tested, columns, models(tables))),
        "",
        (
            f"The position error of the proposed model {'falls' if all(np.diff(errors) < 0) else 'does not always fall'} with the size."
        ),
        "",
    ]


def _poses(tables: Tables, share: int) -> str:
    return f"{np.mean([one.poses for one in tables.of(share=share)]):,.0f}".replace(",", " ")


def _known(tables: Tables) -> list[str]:
    others = [one.clip for one in tables.results if one.known and one.action != "golf"]
    if not others:
        return []
    clips = set(others)
    rows = [
        (
            MODELS[model],
            *(
                _both(
                    [
                        one
                        for one in tables.of(model=model, points=4, share=1, known=known)
                        if one.clip in clips
                    ]
                )
                for known in (False, True)
            ),
        )
        for model in models(tables)
    ]
    return [
        "## People who are in the database",
        "",
        "Four control points, the clip alone left out. Degrees / centimetres.",
        "",
        *table(("", "other people", "and other clips of the same person"), rows),
        "",
    ]


def _limits(tables: Tables) -> list[str]:
    if not tables.limits:
        return []
    rows = [
        (
            one.clip,
            one.what,
            cell(one.angle, 1),
            cell(one.position, 1),
            cell(one.likelihood, 1),
            cell(one.prior, 1),
            cell(one.fastest, 2),
        )
        for one in tables.limits
    ]
    return [
        "## Limits",
        "",
        (
            "What the paper names: an action that is missing from the database, and control points that conflict. Energies are medians over "
            "the frames: half the squared errors of the control points, and half the squared distance from the prediction, in standard "
            "deviations. Speed is the 99th percentile over the joints, as a part of the truth's."
        ),
        "",
        *table(("clip", "", "degrees", "cm", "energy of points", "of the prior", "speed"), rows, left=(0, 1)),
        "",
    ]


def _times(tables: Tables) -> list[str]:
    rows = [
        (
            MODELS[model],
            *(
                cell(float(np.median([one.milliseconds for one in tables.of(model=model, share=share)])), 2)
                if tables.of(model=model, share=share)
                else "-"
                for share in SHARES
            ),
        )
        for model in models(tables)
    ]
    return [
        "## Time",
        "",
        (
            "Milliseconds per frame, one thread, exact search, median over clips and control points; a frame of 60 per second has 16.7. "
            "Measured beside whatever else the machine did."
        ),
        "",
        *table(("", *(f"{_poses(tables, share)} poses" for share in SHARES)), rows),
        "",
    ]


__all__ = ["AIMS", "PROPOSED", "STEM", "Run", "markdown", "models"]
