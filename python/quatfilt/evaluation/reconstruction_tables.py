"""Reconstruction from a few trajectories: errors by control points, action and size of the database, and the limits."""

import contextlib
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from quatfilt._backend import get_num_threads, set_num_threads
from quatfilt.evaluation.channels import Values
from quatfilt.evaluation.clips import find
from quatfilt.evaluation.reconstruction_tables_conditions import (
    APART,
    CONTROL_POINTS,
    FPS,
    LEARNED,
    LONGEST,
    MODELS,
    SHARES,
    TESTS,
    HeldOut,
)
from quatfilt.evaluation.reconstruction_tables_databases import Databases, Recordings
from quatfilt.motion import metrics
from quatfilt.motion.defects import find_defects
from quatfilt.motion.motion import Motion
from quatfilt.reconstruction.database import MotionDatabase
from quatfilt.reconstruction.reconstructor import MotionReconstructor


@dataclass(frozen=True)
class Result:
    """A clip, reconstructed."""

    clip: str
    action: str
    model: str
    points: int
    share: int
    """One clip in so many of the database."""
    poses: int
    angle: float
    """Mean over frames and steady joints, degrees."""
    position: float
    """Mean over frames and joints, centimetres."""
    milliseconds: float
    """Per frame of the database's rate, one thread."""
    frames: int
    known: bool
    """Whether other clips of the same person are in the database."""


@dataclass(frozen=True)
class Limit:
    """What becomes of a clip where it cannot be reconstructed well."""

    what: str
    clip: str
    angle: float
    position: float
    likelihood: float
    """Median over the frames of the first energy: how badly the control points are met."""
    prior: float
    """Of the second: how far the pose is from what was predicted."""
    fastest: float
    """The 99th percentile of the joints' speeds, as a part of the truth's."""


@dataclass(frozen=True)
class Tables:
    """All that was measured."""

    results: list[Result]
    limits: list[Limit]
    clips: dict[str, str]
    """From the test clips to what happens in them."""
    people: int
    left_out: list[str] = field(default_factory=list)
    """Models that could not be tried, and why."""

    def of(self, **wanted: Any) -> list[Result]:
        """Return the results with some values."""
        return [
            one for one in self.results if all(getattr(one, name) == value for name, value in wanted.items())
        ]

    def mean(self, measure: str, **wanted: Any) -> float:
        """Return the mean of a measure over clips; NaN where there are none."""
        values = [getattr(one, measure) for one in self.of(**wanted)]
        return float(np.mean(values)) if values else float("nan")


def run(
    data: Path,
    *,
    tests: Sequence[HeldOut] = TESTS,
    models: Sequence[str] = tuple(MODELS),
    progress: Callable[[int, int], None] | None = None,
) -> Tables:
    """Reconstruct the test clips.

    Parameters
    ----------
    data : Path
        Folder of CMU's recordings, a folder for each person.
    tests : sequence of HeldOut
        The clips.
    models : sequence of str
        The local models.
    progress : callable or None, default None
        Is told how many of how many clips are done.

    Returns
    -------
    Tables
        What came out.

    Raises
    ------
    QuatfiltError
        If a clip is not there or does not open.
    """
    for test in tests:
        find(data, test.name)
    recordings = Recordings(data)
    tables = Tables(
        [],
        [],
        {test.name: recordings.descriptions.get(test.name, test.action) for test in tests},
        len(recordings.people),
    )
    tell = progress or (lambda _done, _total: None)
    total = len(tests) * len(SHARES) + 1
    done = 0
    databases = Databases(recordings)
    with one_thread():
        for test in tests:
            truth = cut(recordings[test.name])
            for share in SHARES:
                # Table 1 and Fig. 3 are of the whole database, Table 2 of four control points.
                for points in CONTROL_POINTS if share == 1 else (4,):
                    database = databases.without(test, share)
                    for model in models:
                        if share != 1 and model in LEARNED:
                            continue
                        tables.results.append(
                            _measured(
                                database,
                                truth,
                                test,
                                model=model,
                                points=points,
                                share=share,
                                known=test.inside,
                            )
                        )
                if share == 1 and not test.inside:
                    database = databases.without(test, known=True)
                    for model in models:
                        tables.results.append(
                            _measured(database, truth, test, model=model, points=4, share=share, known=True)
                        )
                done += 1
                tell(done, total)
        tables.limits.extend(limits(databases, recordings, tests))
    tell(total, total)
    return tables


@contextlib.contextmanager
def one_thread() -> Iterator[None]:
    """Compute in one thread, so that times are those of one core."""
    before = get_num_threads()
    set_num_threads(1)
    try:
        yield
    finally:
        set_num_threads(before)


def _measured(
    database: MotionDatabase,
    truth: Motion,
    test: HeldOut,
    *,
    model: str,
    points: int,
    share: int,
    known: bool,
) -> Result:
    reconstructor = MotionReconstructor(
        database,
        control_points=CONTROL_POINTS[points],
        skeleton=truth.skeleton,
        model=model,  # type: ignore[arg-type]
    )
    positions = _positions(truth, CONTROL_POINTS[points])
    reconstructor.reconstruct(positions[:2], fps=truth.fps)  # what is computed once is not the frames'
    begun = time.perf_counter()
    estimate = reconstructor.reconstruct(positions, fps=truth.fps)
    seconds = time.perf_counter() - begun
    angle, position = errors(truth, estimate)
    return Result(
        test.name,
        test.action,
        model,
        points,
        share,
        len(database),
        angle,
        position,
        1e3 * seconds / len(truth),
        len(truth),
        known,
    )


def limits(databases: Databases, recordings: Recordings, tests: Sequence[HeldOut]) -> list[Limit]:
    """Try what the paper names: an action that is missing, and control points that conflict."""
    found = []
    for test in tests:
        if test.action != "punch":
            continue
        truth = cut(recordings[test.name])
        names = CONTROL_POINTS[4]
        positions = _positions(truth, names)
        moved = positions.copy()
        moved[:, names.index("lwrist"), 0] += APART / truth.skeleton.centimetres_per_unit
        for what, absent, seen in (
            ("as it is", False, positions),
            ("no boxing, punching or kicking in the database", True, positions),
            (f"left wrist moved {APART:g} cm away", False, moved),
        ):
            database = databases.without(test, absent=absent)
            reconstructor = MotionReconstructor(database, control_points=names, skeleton=truth.skeleton)
            estimate = reconstructor.reconstruct(seen, fps=truth.fps)
            energies = reconstructor.energies_
            likelihood, prior = np.full(2, np.nan) if energies is None else np.median(energies, axis=0)
            angle, position = errors(truth, estimate)
            speed = _fast(estimate) / _fast(truth)
            found.append(Limit(what, test.name, angle, position, float(likelihood), float(prior), speed))
    return found


def cut(motion: Motion) -> Motion:
    """Return the frames that are reconstructed."""
    return motion.replace(rotations=motion.rotations[:LONGEST], translation=motion.translation[:LONGEST])


def errors(truth: Motion, estimate: Motion) -> tuple[float, float]:
    """Return the mean angle over steady joints, degrees, and the mean distance over all, centimetres."""
    names = truth.skeleton.names
    place = [estimate.skeleton.names.index(name) for name in names]
    steady = np.flatnonzero(find_defects(truth.rotations, fps=truth.fps).steady)
    angle = metrics.angle_error(
        np.ascontiguousarray(truth.rotations[:, steady]),
        np.ascontiguousarray(estimate.rotations[:, [place[joint] for joint in steady]]),
    )
    ours = np.asarray(truth.positions(), np.float64) * truth.skeleton.centimetres_per_unit
    theirs = np.asarray(estimate.positions(), np.float64) * estimate.skeleton.centimetres_per_unit
    return float(angle), float(np.linalg.norm(ours - theirs[:, place], axis=-1).mean())


def _positions(motion: Motion, names: Sequence[str]) -> Values:
    joints = [motion.skeleton.names.index(name) for name in names]
    return np.asarray(motion.positions()[:, joints], np.float64)


def _fast(motion: Motion) -> float:
    steps = np.linalg.norm(np.diff(np.asarray(motion.positions(), np.float64), axis=0), axis=-1)
    return float(np.percentile(steps, 99) * motion.fps)


def as_dict(tables: Tables, run: Mapping[str, Any]) -> dict[str, Any]:
    """Return everything as plain values."""
    return {
        **run,
        "fps": FPS,
        "frames": LONGEST,
        "control_points": {str(count): list(names) for count, names in CONTROL_POINTS.items()},
        "clips": tables.clips,
        "left_out": tables.left_out,
        "results": [vars(one) for one in tables.results],
        "limits": [vars(one) for one in tables.limits],
    }


__all__ = [
    "Limit",
    "Recordings",
    "Result",
    "Tables",
    "as_dict",
    "cut",
    "errors",
    "limits",
    "one_thread",
    "run",
]
