"""Where results go: a page, the numbers behind it, and a picture."""

import json
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any


def write(
    folder: Path, stem: str, *, page: str, numbers: Mapping[str, Any], draw: Callable[[Path], None]
) -> tuple[list[Path], str]:
    """Write ``stem.md``, ``stem.json`` and ``stem.png``.

    Parameters
    ----------
    folder : Path
        Where they go; it is made.
    stem : str
        Their name.
    page : str
        Markdown.
    numbers : mapping
        Plain values.
    draw : callable
        Draws into a file; raises ImportError without matplotlib.

    Returns
    -------
    list of Path
        What was written.
    str
        Why there is no picture, or nothing.
    """
    folder.mkdir(parents=True, exist_ok=True)
    written = [folder / f"{stem}.{extension}" for extension in ("md", "json", "png")]
    written[0].write_text(page, encoding="utf-8")
    written[1].write_text(json.dumps(numbers, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
    try:
        draw(written[2])
    except ImportError as error:
        return written[:2], str(error)
    return written, ""


__all__ = ["write"]
