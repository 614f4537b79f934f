"""Tables of what was measured: printed, as Markdown, as JSON."""

import dataclasses
import json
import statistics
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from rich.console import Console
from rich.table import Table as Grid
from timing import Times


@dataclass(frozen=True)
class Row:
    """A line of a table."""

    name: str
    seconds: list[float]
    rotations: int
    """How many rotations were worked on; 0 where they are not what is counted."""
    scale: float = 1.0

    @property
    def median(self) -> float:
        """Seconds."""
        return statistics.median(self.seconds)


@dataclass(frozen=True)
class Table:
    """Rows that were timed together."""

    title: str
    rows: list[Row]
    beside: list[str]
    """Names of the rows that the others are divided by."""
    notes: list[str] = field(default_factory=list)

    def median(self, name: str) -> float:
        """Return the median of a row, in seconds."""
        return next(row.median for row in self.rows if row.name == name)

    def header(self) -> list[str]:
        """Return what stands above the columns."""
        return ["", "median, ms", "least, ms", "ns per rotation", *(f"÷ {name}" for name in self.beside)]

    def lines(self) -> list[list[str]]:
        """Return the cells."""
        return [
            [
                row.name + (" *" if row.scale != 1 else ""),
                number(row.median * 1e3),
                number(min(row.seconds) * 1e3),
                number(row.median * 1e9 / row.rotations) if row.rotations else "",
                *(number(row.median / self.median(name)) for name in self.beside),
            ]
            for row in self.rows
        ]


@dataclass(frozen=True)
class Figures:
    """A table of other numbers than times."""

    title: str
    columns: list[str]
    values: list[list[str]]
    notes: list[str] = field(default_factory=list)

    def header(self) -> list[str]:
        """Return what stands above the columns."""
        return self.columns

    def lines(self) -> list[list[str]]:
        """Return the cells."""
        return self.values


@dataclass(frozen=True)
class Aim:
    """A figure that is to be reached."""

    what: str
    measured: float
    limit: float
    at_least: bool = False

    @property
    def reached(self) -> bool:
        """Whether it is."""
        return self.measured >= self.limit if self.at_least else self.measured <= self.limit


@dataclass
class Results:
    """What a room has to tell."""

    tables: list[Table | Figures] = field(default_factory=list)
    aims: list[Aim] = field(default_factory=list)

    def table(
        self,
        title: str,
        times: Iterable[Times],
        *,
        rotations: int,
        beside: Sequence[str],
        notes: Sequence[str] = (),
    ) -> Table:
        """Add a table of times, print it and return it."""
        rows = [Row(taken.name, taken.seconds, rotations, taken.scale) for taken in times]
        table = Table(title, rows, list(beside), list(notes))
        self.add(table)
        return table

    def add(self, table: Table | Figures) -> None:
        """Add a table and print it."""
        show(table)
        self.tables.append(table)

    def aim(
        self, what: str, measured: float, *, at_least: float | None = None, at_most: float | None = None
    ) -> None:
        """Add a figure that is to be reached."""
        limit = at_most if at_least is None else at_least
        assert limit is not None  # noqa: S101 - one of them is given
        self.aims.append(Aim(what, measured, limit, at_least is not None))


def number(value: float) -> str:
    """Return three digits."""
    return f"{value:.0f}" if value >= 100 else f"{value:.3g}"


def aims_table(aims: Sequence[Aim]) -> Figures:
    """Return what was to be reached beside what was."""
    return Figures(
        "Aims",
        ["aim", "measured", "limit", "reached"],
        [
            [
                aim.what,
                number(aim.measured),
                ("≥ " if aim.at_least else "≤ ") + f"{aim.limit:g}",
                "yes" if aim.reached else "**no**",
            ]
            for aim in aims
        ],
    )


def show(table: Table | Figures) -> None:
    """Print a table."""
    grid = Grid(
        title=table.title, title_justify="left", caption="\n".join(table.notes), caption_justify="left"
    )
    for index, name in enumerate(table.header()):
        grid.add_column(name, justify="left" if index == 0 else "right")
    for line in table.lines():
        grid.add_row(*line)
    Console(width=None if Console().is_terminal else 140).print(grid)


def markdown(conditions: dict[str, str], results: Results) -> str:
    """Return the page."""
    parts = [
        "# Speed",
        (
            'Written by `make bench BENCH="-o docs/results"`. Whole calls from Python, arrays in and out, beside other '
            "packages in the same run. How to read it, and what is behind the figures: [speed](../speed.md)."
        ),
        "\n".join(f"- {name}: {value}" for name, value in conditions.items()),
    ]
    for table in [*([aims_table(results.aims)] if results.aims else []), *results.tables]:
        header = table.header()
        ruler = [":--", *["--:"] * (len(header) - 1)]
        lines = [header, ruler, *table.lines()]
        parts += [f"## {table.title}", "\n".join(f"| {' | '.join(line)} |" for line in lines), *table.notes]
    return "\n\n".join(parts) + "\n"


def write(folder: Path, conditions: dict[str, str], results: Results) -> None:
    """Write `speed.md` and `speed.json`."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "speed.md").write_text(markdown(conditions, results), encoding="utf-8")
    content = {"conditions": conditions, **dataclasses.asdict(results)}
    text = json.dumps(content, indent=1, ensure_ascii=False)
    (folder / "speed.json").write_text(text + "\n", encoding="utf-8")
