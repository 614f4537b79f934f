"""``quatfilt reconstruct``: trajectories of a few joints in, the motion of the whole body out."""

import time
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer
from numpy.typing import NDArray

from quatfilt import _validation
from quatfilt.cli import _options, _output, _points
from quatfilt.formats.files import write_motion
from quatfilt.motion import metrics
from quatfilt.motion.motion import Motion
from quatfilt.reconstruction.database import MotionDatabase
from quatfilt.reconstruction.reconstructor import MotionReconstructor


@dataclass(frozen=True)
class _Given:
    """Trajectories to follow."""

    joints: tuple[str, ...]
    positions: NDArray[Any]
    fps: float
    truth: Motion | None = None


def reconstruct(
    *,
    database: Annotated[
        Path,
        typer.Option(
            "--database",
            "-d",
            metavar="DB",
            help="Database file, from quatfilt database build.",
            show_default=False,
        ),
    ],
    points: Annotated[
        Path | None,
        typer.Option(
            "--points",
            metavar="CSV",
            help="Trajectories: a table with columns joint.x, joint.y, joint.z, and time (seconds) or frame; empty cells are not seen.",
        ),
    ] = None,
    motion: Annotated[
        Path | None,
        typer.Option(
            "--motion",
            metavar="FILE",
            help="Take the trajectories from a motion file instead, for a trial, and measure the error against it.",
        ),
    ] = None,
    joints: Annotated[
        str | None,
        typer.Option("--joints", metavar="NAME,NAME…", help="The control points, with --motion."),
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", metavar="OUT", help="File to write: .bvh or .npz."),
    ] = None,
    body: Annotated[
        Path | None,
        typer.Option(
            "--body",
            metavar="FILE",
            help="Motion file with the performer's skeleton. [default: that of --motion, else the database's mean]",
        ),
    ] = None,
    model: Annotated[
        str,
        typer.Option(
            metavar="NAME", help="local_regression, local_pca, local_pcr, nearest, mean_pose or gplvm."
        ),
    ] = "local_regression",
    neighbors: Annotated[int, typer.Option(metavar="K", help="Number of examples for each pose.")] = 64,
    control_noise: Annotated[
        float | None,
        typer.Option(
            metavar="UNITS",
            help="Deviation of the trajectories, in units of the database. [default: about 1 cm]",
        ),
    ] = None,
    fps: _options.Fps = None,
    skeleton: _options.SkeletonFile = None,
    threads: _options.Threads = None,
    json: _options.Json = False,
) -> None:
    """Reconstruct the motion of a whole body from trajectories of a few joints.

    Positions are in the unit of the database, and its ground is at the same height.
    """
    _options.use_threads(threads)
    if (points is None) == (motion is None):
        raise ValueError("pass either --points or --motion")
    with _output.busy("reading"):
        db = MotionDatabase.open(database)
        given = (
            _of_motion(motion, joints, fps, skeleton, db)
            if motion is not None
            else _of_table(points, joints, fps)
        )
        shown = (
            given.truth
            if body is None
            else _options.read(body, fps=None, skeleton=skeleton, first_frame="auto")
        )
    reconstructor = MotionReconstructor(
        db,
        control_points=given.joints,
        skeleton=None if shown is None else shown.skeleton,
        model=model,  # type: ignore[arg-type]
        neighbors=neighbors,
        control_noise=control_noise,
    )
    start = time.perf_counter()
    with _output.busy(f"{len(given.positions)} frames, among {len(db)} poses"):
        result = reconstructor.reconstruct(given.positions, fps=given.fps)
    seconds = time.perf_counter() - start
    if output is not None:
        write_motion(output, result)
    record = _record(given, reconstructor, result, seconds)
    if json:
        _output.print_json({**record, "output": None if output is None else str(output)})
        return
    _say(record, output)


def _of_table(path: Path | None, joints: str | None, fps: float | None) -> _Given:
    if path is None:  # one of the two is given
        raise ValueError("--points: the table is missing")
    if joints is not None:
        raise ValueError("--joints is for --motion only; the header of --points names the joints")
    table = _points.read(path)
    rate = table.fps if fps is None else fps
    if rate is None:
        raise ValueError(f"{path}: the frame rate is missing; add a column time in seconds, or pass --fps")
    return _Given(table.joints, table.positions, rate)


def _of_motion(
    path: Path, joints: str | None, fps: float | None, skeleton: Path | None, db: MotionDatabase
) -> _Given:
    """Take the trajectories of a motion file, in the unit of the database."""
    if not joints:
        raise ValueError("--motion needs the control points: pass --joints NAME,NAME…")
    truth = _options.read(path, fps=fps, skeleton=skeleton, first_frame="auto")
    names = tuple(name.strip() for name in joints.split(","))
    _validation.joint_names(names, "--joints", db.names)
    found = [name for name in names if name in truth.skeleton.names]
    scale = truth.skeleton.centimetres_per_unit / db.skeleton.centimetres_per_unit
    places = truth.positions()[:, [truth.skeleton.index(name) for name in found]] * scale
    full = np.full((len(truth), len(names), 3), np.nan)
    full[:, [names.index(name) for name in found]] = places
    return _Given(names, full, truth.fps, truth)


def _record(
    given: _Given, reconstructor: MotionReconstructor, result: Motion, seconds: float
) -> dict[str, Any]:
    energies = reconstructor.energies_
    record: dict[str, Any] = {
        "control_points": list(given.joints),
        "frames": len(result),
        "fps": result.fps,
        "seconds": seconds,
        "energy_of_control_points": None if energies is None else float(np.median(energies[:, 0])),
        "energy_of_prediction": None if energies is None else float(np.median(energies[:, 1])),
    }
    if given.truth is not None:
        order = [result.skeleton.names.index(name) for name in given.truth.skeleton.names]
        scale = result.skeleton.centimetres_per_unit
        theirs = given.truth.positions() * given.truth.skeleton.centimetres_per_unit
        distances = np.linalg.norm(theirs - result.positions()[:, order] * scale, axis=2)
        record["angle_error_degrees"] = metrics.angle_error(given.truth.rotations, result.rotations[:, order])
        record["position_error_cm"] = float(np.nanmean(distances))
    return record


def _say(record: dict[str, Any], output: Path | None) -> None:
    _output.say(
        f"{_output.counted(record['frames'], 'frame')} from {_output.counted(len(record['control_points']), 'control point')}, "
        f"{record['seconds']:.2g} s; energy per frame, median: control points {record['energy_of_control_points']:.2g}, "
        f"prediction {record['energy_of_prediction']:.2g}"
    )
    if "angle_error_degrees" in record:
        _output.say(
            f"error: {record['angle_error_degrees']:.2f}° per joint, {record['position_error_cm']:.2f} cm"
        )
    if output is not None:
        _output.say(f"{output}: written")


__all__ = ["reconstruct"]
