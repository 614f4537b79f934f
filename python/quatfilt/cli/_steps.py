"""From the options of the command line to the arguments of `denoise`."""

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any, TypeAlias, cast

import numpy as np
import typer

from quatfilt import _validation
from quatfilt._typing import Array
from quatfilt.chain import Step, names, plan
from quatfilt.errors import FileAccessError
from quatfilt.methods import FILTERS, METHODS
from quatfilt.motion.feet import PLACEMENTS, Placement
from quatfilt.presets import PRESETS

Method: TypeAlias = Annotated[
    list[str] | None,
    typer.Option(
        "--method",
        metavar="NAME[,NAME…]",
        help=f"Filters, in this order; may be repeated. [default: {METHODS[0]}]",
        show_default=False,
    ),
]
PresetName: TypeAlias = Annotated[
    str | None, typer.Option("--preset", metavar="|".join(PRESETS), help="A chain for a kind of recording.")
]
Options: TypeAlias = Annotated[
    list[str] | None,
    typer.Option(
        "--option",
        metavar="[METHOD.]NAME=VALUE",
        help="Any option of a filter, such as bilateral.radius=3; lists as 1,2,1; angles in degrees. May be repeated.",
        show_default=False,
    ),
]
Gaps: TypeAlias = Annotated[
    str | None,
    typer.Option(
        "--gaps",
        metavar="fill|keep|raise",
        help="Missing samples: fill them, keep them as NaN, or refuse them.",
    ),
]
MaxGap: TypeAlias = Annotated[
    float | None,
    typer.Option("--max-gap", metavar="SECONDS", help="The longest gap to fill. [default: any]"),
]
Translation: TypeAlias = Annotated[
    bool, typer.Option("--translation/--no-translation", help="Filter the translation of the root too.")
]

Feet: TypeAlias = Annotated[
    str,
    typer.Option(
        "--feet",
        metavar="keep|lock|none",
        help="Feet on the ground: keep their path of the input, lock them at one point, or none: leave them as filtered.",
    ),
]


def placement(word: str) -> Placement | None:
    """Return the value of ``--feet``."""
    chosen = word.strip().lower()
    if chosen == "none":
        return None
    if chosen not in PLACEMENTS:
        raise ValueError(
            f"--feet: expected one of {', '.join(map(repr, (*PLACEMENTS, 'none')))}, got {word!r}"
        )
    return _validation.choice(chosen, "--feet", PLACEMENTS)


_WORDS: Mapping[str, Any] = {"none": None, "all": None, "true": True, "false": False}
"""Words with a meaning of their own; "all" is that of a search without a radius."""


_FROM_FILES = ("confidence", "library")
"""Options whose values are read from files, which are named elsewhere in a record."""


def asked(
    method: Sequence[str] | None, preset: str | None, option: Sequence[str] | None, flags: Mapping[str, Any]
) -> dict[str, Any]:
    """Return the keywords for `denoise`.

    Parameters
    ----------
    method, preset, option : as on the command line
        Names of filters, perhaps with commas; a preset; ``[METHOD.]NAME=VALUE``.
    flags : mapping
        Values of options that have flags of their own; None for those not given. Strings are values of
        ``--option``.

    Returns
    -------
    dict
        `method`, `preset` and options.

    Raises
    ------
    ValueError, TypeError
        If an argument is invalid; the message names it.
    """
    chosen = [_name(word) for words in method or () for word in words.split(",")] or [METHODS[0]]
    wish: dict[str, Any] = {"method": chosen if len(chosen) > 1 else chosen[0], "preset": preset}
    running = names(wish["method"], preset)
    plain: dict[str, Any] = {}
    own: dict[str, dict[str, Any]] = {}
    for name, given in flags.items():
        if isinstance(given, str):
            plain[name] = _value(given, "--" + name.replace("_", "-"), angle=_is_angle(name, running))
        elif given is not None:
            plain[name] = given
    for words in option or ():
        place, equals, text = words.partition("=")
        step, dot, name = map(_name, place.rpartition("."))
        if not equals or not name or bool(dot) != bool(step):
            raise ValueError(f"--option: expected [METHOD.]NAME=VALUE, got {words!r}")
        value = _value(text, f"--option {place.strip()}", angle=_is_angle(name, [step] if step else running))
        if step:
            own.setdefault(step, {})[name] = value
        else:
            plain[name] = value
    for name in own:
        if name in plain:
            raise ValueError(
                f"--option {name}: this is the name of a filter; write {name}.{name}=VALUE for its option"
            )
    return {**wish, **plain, **own}


def planned(wish: Mapping[str, Any]) -> tuple[Step, ...]:
    """Return the steps that `denoise` will run; names and options are checked as there."""
    options = dict(wish)
    return plan(options.pop("method"), options.pop("preset"), options)


def described(steps: Sequence[Step]) -> list[dict[str, Any]]:
    """Return the steps as a record: names and chosen values."""
    return [
        {
            "method": step.name,
            **{name: value for name, value in step.chosen.items() if name not in _FROM_FILES},
        }
        for step in steps
    ]


def read_confidence(path: Path, frames: int, joints: int) -> Array:
    """Return the confidence of samples, ``(frames,)`` or ``(frames, joints)``, from a ``.npy`` or a table of numbers."""
    try:
        if path.suffix.lower() == ".npy":
            values = np.load(path, allow_pickle=False)
        else:
            values = np.loadtxt(path, delimiter="," if path.suffix.lower() == ".csv" else None, ndmin=1)
    except OSError as error:
        raise FileAccessError(str(path), error.strerror or str(error)) from None
    except (ValueError, EOFError) as error:
        raise ValueError(f"{path}: expected a table of numbers ({error})") from None
    return cast("Array", _validation.confidence(values, frames, joints, np.dtype(np.float64)))


def explained() -> str:
    """Return the filters with their options, for the help."""
    own = {name: ", ".join(Step(name, {}).own).replace("_", "-") for name in FILTERS}
    lines = [f"  {name.replace('_', '-')}: {options}" for name, options in own.items()]
    presets = [f"  {name}: {preset.about}" for name, preset in PRESETS.items()]
    return "\b\nFilters and their options:\n" + "\n".join(lines) + "\n\n\b\nPresets:\n" + "\n".join(presets)


def _name(text: str) -> str:
    return text.strip().replace("-", "_")


def _is_angle(option: str, running: Sequence[str]) -> bool:
    return any(option in FILTERS[name].angles for name in running if name in FILTERS)


def _value(text: str, name: str, *, angle: bool) -> Any:
    """Parse a value: a word, a number, a list of numbers, or the text itself; angles in radians."""
    word = text.strip()
    if word.lower() in _WORDS:
        return _WORDS[word.lower()]
    if "," in word:
        values = [_number(part) for part in word.removesuffix(",").split(",")]
        if any(isinstance(value, str) for value in values):
            raise ValueError(f"{name}: expected numbers with commas between them, got {text!r}")
    else:
        values = [_number(word)]
    if angle and not isinstance(values[0], str):
        values = [math.radians(_validation.number(value, name, above=0, infinite=True)) for value in values]
    return values if "," in word else values[0]


def _number(text: str) -> int | float | str:
    for kind in (int, float):
        try:
            return kind(text)
        except ValueError:
            continue
    return text.strip()
