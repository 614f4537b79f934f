"""``quatfilt database info``: what is in a database."""

from pathlib import Path
from typing import Annotated

import typer

from quatfilt.cli import _options, _output
from quatfilt.cli.database._describe import describe, summary
from quatfilt.reconstruction.database import MotionDatabase

_SHOWN = 10


def info(
    path: Annotated[Path, typer.Argument(metavar="DB", help="Motion database.", show_default=False)],
    *,
    verify: Annotated[
        bool, typer.Option("--verify", help="Read all of the file and compare it with its check sums.")
    ] = False,
    json: _options.Json = False,
) -> None:
    """Show the contents of a motion database."""
    with _output.busy(f"reading {path.name}"):
        db = MotionDatabase.open(path, verify=verify)
    if json:
        _output.print_json(describe(path, db))
        return
    _output.say(summary(path, db))
    up, unit = "xyz"[db.up], db.skeleton.centimetres_per_unit
    _output.say(f"  {up} is up{f', one unit is {unit:.4g} cm' if unit != 1 else ''}")
    neighbors = (
        "none" if db.graph is None else f"{_output.counted(db.graph.shape[1], 'neighbor')} of each pose"
    )
    _output.say(f"  graph: {neighbors}")
    for note in db.notes:
        _output.say(f"  {note}")
    lengths = db.starts[1:] - db.starts[:-1]
    longest = sorted(range(len(lengths)), key=lambda clip: -lengths[clip])[:_SHOWN]
    _output.say("")
    _output.print_table(
        ("clip", "poses", "seconds"),
        [
            (db.clip_names[clip], str(lengths[clip]), _output.number(lengths[clip] / db.fps, 1))
            for clip in longest
        ],
        title="Longest clips" if len(lengths) > _SHOWN else "Clips",
    )


__all__ = ["info"]
