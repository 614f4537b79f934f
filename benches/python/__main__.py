"""Times of whole calls beside other packages: `make bench`, or `python benches/python [ROOM …] [-o FOLDER]`."""

import argparse
import importlib
from pathlib import Path

from conditions import conditions
from report import Results, aims_table, show, write

ROOMS = ("rotations", "filters", "classical", "noise", "geodesics", "poses", "search", "formats")


def main() -> None:
    """Measure the rooms, print tables, and write them where told."""
    parser = argparse.ArgumentParser(prog="benches/python", description=__doc__)
    parser.add_argument("rooms", nargs="*", metavar="ROOM", help=f"all of {', '.join(ROOMS)} by default")
    parser.add_argument(
        "-o", "--output", type=Path, metavar="FOLDER", help="write speed.md and speed.json there"
    )
    parser.add_argument("-n", "--repetitions", type=int, default=5, help="5 by default")
    options = parser.parse_args()
    if unknown := set(options.rooms) - set(ROOMS):
        parser.error(f"ROOM: expected {', '.join(ROOMS)}, got {', '.join(sorted(unknown))}")

    circumstances = conditions(options.repetitions)
    for name, value in circumstances.items():
        print(f"{name}: {value}")
    results = Results()
    for room in options.rooms or ROOMS:
        found: Results = importlib.import_module(room).run(options.repetitions)
        results.tables += found.tables
        results.aims += found.aims
    if results.aims:
        show(aims_table(results.aims))
    if options.output:
        write(options.output, circumstances, results)


if __name__ == "__main__":
    main()
