"""Tables of the pages."""

import math
from collections.abc import Collection, Sequence


def table(titles: Sequence[str], rows: Sequence[Sequence[str]], *, left: Collection[int] = (0,)) -> list[str]:
    """Return the lines of a table; columns stand to the right but for those in `left`."""
    sides = "".join("---|" if column in left else "--:|" for column in range(len(titles)))
    return [f"| {' | '.join(titles)} |", f"|{sides}", *(f"| {' | '.join(row)} |" for row in rows)]


def cell(value: float, digits: int) -> str:
    """Return a number for a table; a dash where there is none."""
    return f"{round(value, digits) + 0.0:.{digits}f}" if math.isfinite(value) else "-"  # no −0.00


__all__ = ["cell", "table"]
