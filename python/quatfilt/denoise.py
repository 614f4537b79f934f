"""Cleaning of a motion or an array with one filter or a chain."""

from collections.abc import Sequence
from typing import Any, overload

from numpy.typing import ArrayLike

from quatfilt import _validation, chain, sampling
from quatfilt._typing import Array
from quatfilt.methods import AUTO, METHODS
from quatfilt.motion.feet import PLACEMENTS, Placement, with_feet
from quatfilt.motion.motion import Motion
from quatfilt.presets import BEST, PRESETS


@overload
def denoise(
    motion_or_rotations: Motion,
    *,
    method: str | Sequence[str] = "auto",
    translation: bool = True,
    preset: str | None = None,
    feet: Placement | None = "keep",
    **options: Any,
) -> Motion: ...
@overload
def denoise(
    motion_or_rotations: ArrayLike,
    *,
    method: str | Sequence[str] = "auto",
    translation: bool = True,
    preset: str | None = None,
    feet: Placement | None = "keep",
    **options: Any,
) -> Array: ...
def denoise(
    motion_or_rotations: Motion | ArrayLike,
    *,
    method: str | Sequence[str] = "auto",
    translation: bool = True,
    preset: str | None = None,
    feet: Placement | None = "keep",
    **options: Any,
) -> Motion | Array:
    """Denoise a motion, or a clip of rotations, with one filter or several.

    Parameters
    ----------
    motion_or_rotations : Motion or array_like, shape (frames, joints, 4) or (frames, 4)
        The motion or the rotations to clean. Missing samples are filled, unless ``gaps=`` is given.
    method : str or list of str, default "auto"
        The filter, or filters in their order. "auto" is `despike` and then ``smooth(joints="together", noise="measured")`` or, with a
        preset, the preset's chain.
    translation : bool, default True
        Whether the root's translation of a motion is filtered too, by each filter; its gaps are then filled along straight lines.
        A filter with ``search_radius=None`` leaves it unchanged: a pose that repeats, repeats at another place.
    preset : {"optical", "inertial", "video"} or None, default None
        A prior for a kind of recording: steps of the automatic method with values, and how likely jitter is that moves as fast as
        limbs do; what else is given goes before it. Beside methods of the caller's, it gives values to the steps that it has.
    feet : {"keep", "lock"} or None, default "keep"
        Feet of a motion after the last filter. ``"keep"``: while a foot stands on the ground it follows its path in the input, without
        the noise; a filter alone makes feet slide. ``"lock"``: it stays at one point. None: as filtered. Legs are found by the names of
        the joints; without legs, and for arrays, ``"keep"`` does nothing.
    **options
        Options of the filters. A plain keyword is for the one filter that has it; `boundary`, `confidence`, `fps`, `gaps`,
        `max_gap` and `scalar_first` are for all filters. The name of a filter with a dict is for that filter, as in
        ``bilateral={"radius": 2}``. A motion has its frame rate: omit ``fps``.

    Returns
    -------
    Motion or ndarray
        Like the input, which is not changed.

    Raises
    ------
    ValueError, TypeError
        If a method, a preset or an option is invalid; the message names it. All options are checked before anything is
        computed.

    See Also
    --------
    nonlocal_pose_means, bilateral, despike, orientation_filter : Filters, their options and their cost.
    lock_feet : Holds feet on the ground, with options.
    report : Measures the effect of a filter.

    Notes
    -----
    "auto" and presets first look at the source: of held, repeated and interpolated frames only measurements are cleaned, at the
    source's rate, and a spline leads back to all frames; frozen stretches stay. Jitter of estimates from video is filtered by a low pass:
    by default where no person moves like that, with "video" in every stretch whose spectrum shows it, else never.
    ``fps`` tells what that needs.

    In a chain each filter fills the gaps anew, from neighbours that the filters before it have cleaned; filled samples have
    confidence 0.

    Examples
    --------
    >>> import numpy as np, quatfilt as qf
    >>> t = np.arange(240) / 120
    >>> swing = qf.exp(0.4 * np.sin(2 * np.pi * t)[:, None] * [0.0, 0.0, 1.0])
    >>> noisy = qf.add_gaussian_noise(swing, sigma=0.03, rng=0)
    >>> qf.denoise(noisy).shape
    (240, 4)
    >>> twice = qf.denoise(noisy, method=["nonlocal_pose_means", "bilateral"], radius=2)
    >>> error = lambda q: float(np.degrees(qf.geodesic_distance(swing, q)).mean())
    >>> error(qf.denoise(noisy)) < error(twice) < error(noisy)
    True
    """
    _validation.switch(translation, "translation")
    placement = None if feet is None else _validation.choice(feet, "feet", PLACEMENTS)
    if isinstance(motion_or_rotations, Motion):
        motion = motion_or_rotations
        if "scalar_first" in options:
            raise TypeError("scalar_first applies to arrays only; a Motion has its own convention")
        steps = chain.plan(method, preset, {"fps": motion.fps, **options})
        rotations, moved = _run(
            method, preset, steps, motion.rotations, motion.translation if translation else None
        )
        changes = {} if moved is None else {"translation": moved}
        result = motion.replace(rotations=rotations, **changes)
        return result if placement is None else with_feet(motion, result, placement, translation=translation)
    if placement == "lock":
        raise TypeError(
            f"feet='lock' needs a Motion, which has a skeleton, got {type(motion_or_rotations).__name__}"
        )
    steps = chain.plan(method, preset, options)
    if method == AUTO:
        chain.require_rate(steps, preset)
    scalar_first = options.get("scalar_first", True)
    array = _validation.quaternions(motion_or_rotations, "rotations", scalar_first=scalar_first)
    rotations, _ = _run(method, preset, steps, array, None)
    return _validation.scalar_order(rotations, scalar_first=scalar_first)


def _run(
    method: str | Sequence[str],
    preset: str | None,
    steps: Sequence[chain.Step],
    rotations: Array,
    translation: Array | None,
) -> tuple[Array, Array | None]:
    """Run steps; those of the automatic method and of presets at the rate of the source."""
    if method != AUTO:
        return chain.run(steps, rotations, translation)
    prior = (BEST if preset is None else PRESETS[preset]).jitter
    return sampling.run(steps, rotations, translation, prior=prior)


__all__ = ["METHODS", "denoise"]
