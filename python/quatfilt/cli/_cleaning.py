"""From a noisy file to a clean one, with a record."""

import contextlib
import time
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from quatfilt._typing import Array
from quatfilt.cli import _options, _steps
from quatfilt.cli.compare import refuse_other_joints
from quatfilt.denoise import denoise
from quatfilt.errors import FileAccessError
from quatfilt.formats.files import write_motion
from quatfilt.motion.defects import find_defects
from quatfilt.motion.feet import Placement, with_feet
from quatfilt.motion.legs import find_legs
from quatfilt.motion.metrics import angle_error, foot_scale, foot_slide
from quatfilt.motion.motion import Motion
from quatfilt.motion.report import placed
from quatfilt.noise.noise import noise_level
from quatfilt.rotations.resample import resample

Busy = Callable[[str], contextlib.AbstractContextManager[None]]
"""Shows the current step."""


@dataclass(frozen=True)
class How:
    """Options of the cleaning of each file."""

    wish: Mapping[str, Any]
    """Keywords for `denoise`."""
    translation: bool = True
    fps: float | None = None
    skeleton: Path | None = None
    first_frame: str = "auto"
    confidence: Path | None = None
    library: tuple[Path, ...] = ()
    """Clean motions of the same joints, which the filters may borrow from."""
    feet: Placement | None = "keep"
    """Placement of feet on the ground after the filters."""


@dataclass(frozen=True)
class Cleaned:
    """A file that was cleaned and written."""

    motion: Motion
    filtered: Motion
    """Before its feet were placed."""
    result: Motion
    record: dict[str, Any]


def silent(_: str) -> contextlib.AbstractContextManager[None]:
    """Show nothing."""
    return contextlib.nullcontext()


def read(source: Path, target: Path, how: How) -> Motion:
    """Read a file that is to be cleaned into another one."""
    if target.exists() and source.exists() and target.samefile(source):
        raise FileAccessError(target, "this is the input: write to another file")
    return _options.read(source, fps=how.fps, skeleton=how.skeleton, first_frame=how.first_frame)


def clean(source: Path, target: Path, motion: Motion, how: How, *, busy: Busy = silent) -> Cleaned:
    """Clean the motion of a file, and write the result.

    Parameters
    ----------
    source, target : Path
        Path of the input, and path of the result.
    motion : Motion
        The motion of the input.
    how : How
        Options.
    busy : callable
        Context manager that shows the current step.

    Returns
    -------
    Cleaned
        Both motions and the record.

    Raises
    ------
    QuatfiltError, ValueError, TypeError
        If a file or an option is invalid.
    """
    options = dict(how.wish)
    if how.confidence is not None:
        options["confidence"] = _steps.read_confidence(how.confidence, *motion.rotations.shape[:2])
    if how.library:
        with busy("reading the library"):
            options["library"] = [_borrowed(path, source, motion, how) for path in how.library]
    started = time.perf_counter()
    with busy(f"cleaning {source.name}"):
        filtered = denoise(motion, translation=how.translation, feet=None, **options)
        result = filtered
        if how.feet is not None:
            result = with_feet(motion, filtered, how.feet, translation=how.translation)
    seconds = time.perf_counter() - started
    with busy(f"writing {target.name}"):
        write_motion(target, result)
    record = {
        "input": str(source),
        "output": str(target),
        "steps": _steps.described(_steps.planned(how.wish)),
    }
    if how.library:
        record["library"] = [str(path) for path in how.library]
    measured = {**_measured(motion, result), **_feet(motion, filtered, result, how), "seconds": seconds}
    return Cleaned(motion, filtered, result, {**record, **measured})


def _borrowed(path: Path, source: Path, motion: Motion, how: How) -> Array:
    """Return the rotations of a clean motion of the same joints, at the frame rate of the one that is cleaned."""
    clean = _options.read(path, fps=None, skeleton=how.skeleton, first_frame=how.first_frame)
    refuse_other_joints(path, clean, source, motion)
    if clean.fps == motion.fps or len(clean) == 0:
        return clean.rotations
    return resample(clean.rotations, fps=clean.fps, new_fps=motion.fps)


def _measured(motion: Motion, result: Motion) -> dict[str, Any]:
    noise, change = 0.0, 0.0
    if motion.rotations.size:
        noise = float(np.degrees(np.sqrt(np.mean(np.square(noise_level(motion.rotations))))))
        change = float(angle_error(motion.rotations, result.rotations))
    return {
        "frames": len(motion),
        "joints": len(motion.skeleton),
        "fps": motion.fps,
        "notes": list(motion.notes),
        "missing_samples": _missing(motion),
        "missing_samples_left": _missing(result),
        "noise_degrees": noise,
        "change_degrees": change,
    }


def _feet(motion: Motion, filtered: Motion, result: Motion, how: How) -> dict[str, Any]:
    """Return how far feet slide and joints were turned to hold them; None without legs, or where feet were left to the filter."""
    if how.feet is None or not find_legs(motion.skeleton) or not len(motion):
        return {"feet": None}
    told = placed(filtered, result)
    slides = (foot_slide(one, reference=result) for one in (motion, filtered, result))
    names = ("slide_before", "slide_filtered", "slide_after")
    return {
        "feet": {
            "placement": how.feet,
            **{name: float(slide) for name, slide in zip(names, slides, strict=True)},
            "scale": foot_scale(motion),
            **asdict(told),
        }
    }


def _missing(motion: Motion) -> int:
    return int(find_defects(motion.rotations, fps=motion.fps).missing.sum())
