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
    written[1].write_text(_lines(numbers), encoding="utf-8")
    try:
        draw(written[2])
    except ImportError as error:
        return written[:2], str(error)
    return written, ""


def _lines(numbers: Mapping[str, Any]) -> str:
    """JSON with a line for each key, and one for each element of a list: differences between runs can be read."""
    keys = []
    for key, value in numbers.items():
        text = json.dumps(value, ensure_ascii=False)
        if isinstance(value, list) and any(isinstance(element, (dict, list)) for element in value):
            text = "[\n" + ",\n".join(json.dumps(element, ensure_ascii=False) for element in value) + "\n]"
        keys.append(f"{json.dumps(key)}: {text}")
    return "{\n" + ",\n".join(keys) + "\n}\n"


__all__ = ["write"]
