"""Output of the commands: tables for people, JSON for programs, progress on a terminal."""

import contextlib
import io
import json
import math
import sys
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, TextIO

import numpy as np
from rich.console import Console
from rich.table import Table
from rich.text import Text

from quatfilt.motion.report import Report, text


def refuse_to_wrap(*streams: TextIO) -> None:
    """Let streams that cannot say ``°`` say ``?`` instead of failing."""
    for stream in streams:
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")


def one_line(message: str) -> str:
    """Join the lines of a message."""
    return " ".join(message.split())


def say(text: str) -> None:
    """Print a line."""
    sys.stdout.write(text + "\n")


def print_json(result: Mapping[str, Any]) -> None:
    """Print a result for programs; what is not a number is null."""
    say(json.dumps(plain(result), indent=2, ensure_ascii=False))


def plain(value: Any) -> Any:
    """Return a value that JSON has: NumPy's become Python's, and what is not finite None."""
    if isinstance(value, Mapping):
        return {str(key): plain(item) for key, item in value.items()}
    if isinstance(value, np.ndarray):
        return plain(value.tolist())
    if isinstance(value, (list, tuple)):
        return [plain(item) for item in value]
    if isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value


def print_table(columns: Sequence[str], rows: Sequence[Sequence[str]], *, title: str = "") -> None:
    """Print a table; the first column is text, the others are numbers."""
    table = Table(
        title=title or None,
        title_justify="left",
        title_style="bold",
        header_style="",
        box=None,
        pad_edge=False,
    )
    for number, column in enumerate(columns):
        table.add_column(Text(column), justify="right" if number else "left", no_wrap=True)
    for row in rows:
        table.add_row(*map(Text, row))
    # A pipe has no width: nothing is to be cut off there.
    width = None if sys.stdout.isatty() else 10_000
    Console(file=sys.stdout, highlight=False, width=width).print(table, soft_wrap=width is not None)


def print_report(report: Report) -> None:
    """Print a report."""
    say("")
    say(text.summary(report))
    for table in text.tables(report):
        say("")
        print_table(table.columns, table.rows, title=table.title)
    for note in text.notes(report):
        say("")
        say(note)
    say("")


def number(value: float | None, digits: int = 2) -> str:
    """Return a number for a table; a dash where there is none."""
    if value is None or math.isnan(value):
        return "-"
    if math.isinf(value):
        return "∞" if value > 0 else "−∞"
    return f"{round(value, digits) + 0.0:.{digits}f}"  # no −0.00


def counted(count: int, what: str) -> str:
    """Return a count with its noun."""
    return f"{count} {what}{'' if count == 1 else 's'}"


@contextlib.contextmanager
def busy(what: str) -> Iterator[None]:
    """Show on a terminal that something is going on."""
    with Console(stderr=True).status(what) if sys.stderr.isatty() else contextlib.nullcontext():
        yield
