"""Chains of filters: from names and options to steps, and from a noisy clip to a clean one."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from quatfilt import _validation
from quatfilt._typing import Array, Mask
from quatfilt.filters._paths import straightened
from quatfilt.filters._spans import GAPS
from quatfilt.methods import AUTO, FILTERS, METHODS, REQUIRED, Method
from quatfilt.presets import BEST, PRESETS, Preset

OF_THE_CLIP = ("confidence", "fps", "gaps", "max_gap", "scalar_first")
"""Options of the clip: given once for all steps."""

SHARED = ("boundary", *OF_THE_CLIP)
"""Options with the same meaning in all filters: a plain keyword goes to every step that has them."""


@dataclass(frozen=True)
class Step:
    """A filter and the options chosen for it."""

    name: str
    chosen: dict[str, Any]
    """Without defaults."""

    @property
    def method(self) -> Method:
        """The filter."""
        return FILTERS[self.name]

    @property
    def settings(self) -> dict[str, Any]:
        """All keyword arguments of the filter."""
        return {**self.method.defaults, **self.chosen}

    @property
    def own(self) -> tuple[str, ...]:
        """Options that can be set for this step alone."""
        return tuple(option for option in self.method.options if option not in OF_THE_CLIP)


def plan(method: str | Sequence[str], preset: str | None, options: Mapping[str, Any]) -> tuple[Step, ...]:
    """Return the steps that names, a preset and options ask for.

    Parameters
    ----------
    method : str or sequence of str
        Names of filters in their order. "auto" stands for the chain of the preset, or for the best one.
    preset : str or None
        Gives values to the steps that it has.
    options : mapping
        Values that override the preset's: of an option, or of a step as a mapping of its options.

    Returns
    -------
    tuple of Step
        At least one.

    Raises
    ------
    ValueError, TypeError
        If there is no such method, preset or option, if it is not clear which step an option is for, or if one without
        a default is lacking.
    """
    steps = _steps(method, preset)
    # Options of one step override those of all.
    for option, value in sorted(options.items(), key=lambda item: isinstance(item[1], Mapping)):
        for step, chosen in _assigned(steps, option, value):
            step.chosen.update(chosen)
    for step in steps:
        for option, value in step.settings.items():
            if value is REQUIRED:
                raise TypeError(f"{step.name} needs a value of {option}: pass {option}=…")
    return tuple(steps)


def require_rate(steps: Sequence[Step], preset: str | None) -> None:
    """Refuse the chain of a preset that measures a cut-off in hertz where the frame rate is not given.

    Raises
    ------
    ValueError
        If the preset expects jitter, and `fps` is not among the options.
    """
    if preset is None or PRESETS[preset].jitter != "expected":
        return
    if any("fps" not in step.chosen for step in steps):
        raise ValueError(
            f"preset {preset!r} needs the frame rate: pass fps=30 (frames per second); its cut-off is in hertz"
        )


def names(method: str | Sequence[str], preset: str | None) -> list[str]:
    """Return the names of the filters that `plan` would run."""
    return [step.name for step in _steps(method, preset)]


def _steps(method: str | Sequence[str], preset: str | None) -> list[Step]:
    """Return the steps with the values of the preset alone."""
    base = BEST if preset is None else PRESETS[_validation.choice(preset, "preset", tuple(PRESETS))]
    steps: list[Step] = []
    for name in _names(method):
        if name == AUTO:
            steps += [_from(base, own) for own in base.steps]
        else:
            steps.append(Step(name, {}) if preset is None else _from(base, name))
    return steps


def _names(method: str | Sequence[str]) -> list[str]:
    if not isinstance(method, (list, tuple)):
        return [_validation.choice(method, "method", METHODS)]
    if not method:
        raise ValueError("method: expected at least one filter, got an empty list")
    return [_validation.choice(name, f"method[{place}]", METHODS) for place, name in enumerate(method)]


def _from(preset: Preset, name: str) -> Step:
    """Return a step with the values of a preset."""
    shared = {option: value for option, value in preset.shared.items() if option in FILTERS[name].options}
    return Step(name, {**shared, **preset.steps.get(name, {})})


def _assigned(steps: Sequence[Step], option: str, value: Any) -> list[tuple[Step, Mapping[str, Any]]]:
    """Return the steps that an option is for, and what each gets."""
    if option in FILTERS:
        if not isinstance(value, Mapping):
            raise TypeError(_no_options(steps, option, value))
        own = [step for step in steps if step.name == option]
        if not own:
            raise TypeError(
                f"{option}: the chain has no such filter, only {_listed(steps)}; add it to method"
            )
        for name in value:
            if name not in own[0].own:
                raise TypeError(f"{option} has no option {name}; it has {', '.join(own[0].own)}")
        return [(step, value) for step in own]
    owners = [step for step in steps if option in step.method.options]
    if not owners:
        known = {step.name: f"{step.name} ({', '.join(step.method.options)})" for step in steps}
        raise TypeError(
            f"{option}: no filter of the chain has this option; it has {'; '.join(known.values())}"
        )
    if option not in SHARED and len({step.name for step in owners}) > 1:
        raise TypeError(
            f"{option}: {_listed(owners)} have this option; name the filter, as in {owners[0].name}={{{option!r}: …}}"
        )
    return [(step, {option: value}) for step in owners]


def _no_options(steps: Sequence[Step], name: str, value: Any) -> str:
    """Say that the name of a filter has a value that is no dict; a filter may have an option of that name."""
    for step in steps:
        if name in step.own:
            return f"{name}: this is the name of a filter; for the option of {step.name} pass {step.name}={{{name!r}: {value!r}}}"
    return f"{name}: expected a dict of options of the filter {name}, got {type(value).__name__}"


def _listed(steps: Sequence[Step]) -> str:
    return ", ".join(dict.fromkeys(step.name for step in steps))


def run(
    steps: Sequence[Step], rotations: Array, translation: Array | None = None
) -> tuple[Array, Array | None]:
    """Run filters one after the other.

    Between steps, missing samples are missing again: each step fills them from what the steps before it made of their
    neighbours, and gives them the same confidence as in a clip of its own.

    Parameters
    ----------
    steps : sequence of Step
        From `plan`.
    rotations : ndarray, shape (frames, joints, 4) or (frames, 4)
        Scalar first.
    translation : ndarray, shape (frames, 3), or None
        Of the root.

    Returns
    -------
    rotations, translation
        Filtered; a translation that no step filters comes back as it is.

    Raises
    ------
    ValueError, TypeError
        If a value is not what a filter takes. Those of later steps are refused before the first one runs.
    """
    *before, last = steps
    if before:
        refuse_early(steps, rotations)
    for step in before:
        # With gaps="raise" the first step refuses missing samples.
        between = "raise" if step.settings["gaps"] == "raise" else "keep"
        rotations, translation = _filtered(step, between, rotations, translation)
    return _filtered(last, last.settings["gaps"], rotations, translation)


def refuse_early(steps: Sequence[Step], rotations: Array) -> None:
    """Check the options of every step with a clip of no frames."""
    clip, _ = _validation.clip(rotations)
    frames, joints = clip.shape[:2]
    for step in steps:
        settings = _settings(step)
        _validation.choice(settings["gaps"], "gaps", GAPS)
        if "confidence" in settings:
            _validation.confidence(settings["confidence"], frames, joints, clip.dtype)
            settings["confidence"] = None
        step.method.with_translation(clip[:0], None, **settings)


def _settings(step: Step) -> dict[str, Any]:
    """Return all keyword arguments of the filter, for rotations that are now scalar first."""
    settings = {**step.settings, "scalar_first": True}
    if settings.get("library") is not None and not step.settings["scalar_first"]:
        several = isinstance(settings["library"], (list, tuple))
        clips = settings["library"] if several else [settings["library"]]
        clips = [_validation.quaternions(clip, "library", scalar_first=False) for clip in clips]
        settings["library"] = clips if several else clips[0]
    return settings


def _filtered(
    step: Step, gaps: str, rotations: Array, translation: Array | None
) -> tuple[Array, Array | None]:
    settings = {**_settings(step), "gaps": gaps}
    # A pose that comes back after a while comes back elsewhere.
    anywhere = "search_radius" in settings and settings["search_radius"] is None
    if translation is None or anywhere:
        return step.method.with_translation(rotations, None, **settings)[0], translation
    missing: Mask = np.asarray(np.isnan(translation).any(axis=1))
    path = None if missing.all() else straightened(translation, ~missing)
    result, moved = step.method.with_translation(rotations, path, **settings)
    if moved is None:
        return result, translation
    if gaps == "keep":
        moved[missing] = np.nan
    return result, moved


__all__ = ["OF_THE_CLIP", "SHARED", "Step", "names", "plan", "refuse_early", "require_rate", "run"]
