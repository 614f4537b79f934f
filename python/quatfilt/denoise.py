"""The way from a noisy clip or motion to a clean one that the command line runs."""

from typing import Any, cast, overload

import numpy as np
from numpy.typing import ArrayLike

from quatfilt import _validation
from quatfilt._typing import Array, Mask
from quatfilt.filters import bilateral, nonlocal_pose_means
from quatfilt.motion.motion import Motion

METHODS = ("auto", "nonlocal_pose_means", "bilateral")
"""What `denoise` can run; "auto" is the best that this version has."""


_FILTERS: dict[str, tuple[Any, Any]] = {
    "nonlocal_pose_means": (nonlocal_pose_means.nonlocal_pose_means, nonlocal_pose_means.with_translation),
    "bilateral": (bilateral.bilateral, bilateral.with_translation),
}
"""Each method's filter of rotations, and of rotations with the translation of the root."""


@overload
def denoise(
    motion_or_rotations: Motion, *, method: str = "auto", translation: bool = True, **options: Any
) -> Motion: ...
@overload
def denoise(
    motion_or_rotations: ArrayLike, *, method: str = "auto", translation: bool = True, **options: Any
) -> Array: ...
def denoise(
    motion_or_rotations: Motion | ArrayLike,
    *,
    method: str = "auto",
    translation: bool = True,
    **options: Any,
) -> Motion | Array:
    """Denoise a motion, or a clip of rotations.

    Parameters
    ----------
    motion_or_rotations : Motion or array_like, shape (frames, joints, 4) or (frames, 4)
        What to clean. Missing samples are filled in, unless ``gaps=`` says otherwise.
    method : {"auto", "nonlocal_pose_means", "bilateral"}, default "auto"
        The filter. "auto" is `nonlocal_pose_means` with a bandwidth from the estimated noise.
    translation : bool, default True
        Whether a motion's root translation is filtered too, with the weights of its poses; gaps in it are then filled
        along straight lines. With ``search_radius=None`` it is left alone: a pose that comes back comes back elsewhere.
    **options
        Options of the filter. A motion knows its frame rate: ``fps`` need not be given.

    Returns
    -------
    Motion or ndarray
        Like the input, which is not changed.

    Raises
    ------
    ValueError, TypeError
        If the method or one of its options is not what was stated; the message names it.

    See Also
    --------
    nonlocal_pose_means, bilateral : The filters, their options and their cost.

    Examples
    --------
    >>> import numpy as np, quatfilt as qf
    >>> t = np.arange(240) / 120
    >>> swing = qf.exp(0.4 * np.sin(2 * np.pi * t)[:, None] * [0.0, 0.0, 1.0])
    >>> noisy = qf.add_gaussian_noise(swing, sigma=0.03, rng=0)
    >>> qf.denoise(noisy).shape
    (240, 4)
    """
    name = _validation.choice(method, "method", METHODS)
    name = "nonlocal_pose_means" if name == "auto" else name
    run, with_translation = _FILTERS[name]
    if not isinstance(translation, (bool, np.bool_)):
        raise TypeError(f"translation: expected True or False, got {type(translation).__name__}")
    defaults = cast("dict[str, Any]", run.__kwdefaults__)
    unknown = [option for option in options if option not in defaults]
    if unknown:
        raise TypeError(f"{unknown[0]}: expected an option of {name} ({', '.join(defaults)}), got this name")
    if not isinstance(motion_or_rotations, Motion):
        return cast("Array", run(motion_or_rotations, **options))
    motion = motion_or_rotations
    chosen = {**defaults, "fps": motion.fps, **options}
    missing: Mask = np.asarray(np.isnan(motion.translation).any(axis=1))
    # The bilateral filter has no `search_radius`: its window is always near in time.
    along = translation and chosen.get("search_radius", 0) is not None
    moved = _straightened(motion.translation, missing) if along else None
    rotations, moved = with_translation(motion.rotations, moved, **chosen)
    if moved is None:
        return motion.replace(rotations=rotations)
    if chosen["gaps"] == "keep":
        moved[missing] = np.nan
    return motion.replace(rotations=rotations, translation=moved)


def _straightened(translation: Array, missing: Mask) -> Array | None:
    """Return a translation with its gaps filled along straight lines; None where all of it is missing."""
    if missing.all():
        return None
    if not missing.any():
        return translation
    frames = np.arange(len(translation))
    columns = [np.interp(frames, frames[~missing], column[~missing]) for column in translation.T]
    return np.stack(columns, axis=1).astype(translation.dtype)


__all__ = ["METHODS", "denoise"]
