"""``quatfilt pga``: principal geodesics of the joints of a motion."""

from pathlib import Path
from typing import Annotated

import typer

from quatfilt import _validation
from quatfilt.cli import _options, _output
from quatfilt.motion.motion import Motion

_MOST = 64


def pga(
    path: _options.Input,
    *,
    output: Annotated[
        Path | None,
        typer.Option(
            "--output",
            "-o",
            metavar="PICTURE",
            help="Picture to write: .png, .pdf or .svg. [default: none]",
        ),
    ] = None,
    components: Annotated[
        int, typer.Option("--components", "-k", metavar="N", help="Number of geodesics of each joint.")
    ] = 5,
    joints: Annotated[
        str | None, typer.Option(metavar="NAME,…", help="Names of the joints. [default: all that move]")
    ] = None,
    objective: Annotated[
        str,
        typer.Option(metavar="geodesic|squared|chordal", help="Objective that a geodesic minimises."),
    ] = "geodesic",
    fps: _options.Fps = None,
    skeleton: _options.SkeletonFile = None,
    first_frame: _options.FirstFrameChoice = "auto",
    json: _options.Json = False,
) -> None:
    """Show how few angles describe each joint: its principal geodesics, and the mean angle that k of them leave.

    A direction is the axis of rotation of the joint, seen from its mean.
    """
    # SciPy would slow down every verb.
    from quatfilt.evaluation import pga_of_motion, pga_of_motion_picture  # noqa: PLC0415
    from quatfilt.geodesics.pga import OBJECTIVES  # noqa: PLC0415

    count = _validation.integer(components, "--components", at_least=1, at_most=_MOST)
    chosen = _validation.choice(objective, "--objective", OBJECTIVES)
    with _output.busy(f"reading {path.name}"):
        motion = _options.read(path, fps=fps, skeleton=skeleton, first_frame=first_frame)
    with _output.busy("fitting"):
        found = pga_of_motion.analyse(motion, _places(motion, joints), count, chosen)
    if output is not None and any(not joint.trouble for joint in found):
        pga_of_motion_picture.draw(motion, found, output)
    if json:
        _output.print_json({"file": str(path), "objective": chosen, "joints": pga_of_motion.as_dict(found)})
        return
    _output.say(
        f"{path}: {_output.counted(len(motion), 'frame')}, mean angle that k geodesics leave, degrees; "
        "the greatest of a frame at the last k"
    )
    _output.say("")
    rows = pga_of_motion.as_dict([joint for joint in found if not joint.trouble])
    _output.print_table(
        ("joint", "k = 0", *(f"k = {k}" for k in range(1, count + 1)), "greatest", "first direction"),
        [
            (
                row["name"],
                _output.number(row["spread_degrees"], 2),
                *(_output.number(value, 3) for value in row["residuals_degrees"]),
                _output.number(row["worst_degrees"][-1], 3),
                " ".join(f"{value:6.3f}" for value in row["directions"][0]),
            )
            for row in rows
        ],
    )
    for joint in found:
        if joint.trouble:
            _output.say(f"{joint.name}: not analysed: {joint.trouble}")
    if output is not None and rows:
        _output.say(f"{output}: written")


def _places(motion: Motion, joints: str | None) -> list[int]:
    """Return which joints are meant."""
    names = motion.skeleton.names
    if joints is None:
        moves = [
            place
            for place in range(len(names))
            if (motion.rotations[1:, place] != motion.rotations[:1, place]).any()
        ]
        return moves or list(range(len(names)))
    known = f"joints among {', '.join(names)}"
    return [
        names.index(_validation.known(name.strip(), "--joints", names, known)) for name in joints.split(",")
    ]


__all__ = ["pga"]
