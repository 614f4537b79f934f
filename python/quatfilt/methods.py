"""The filters of `denoise`, one entry each."""

import functools
import inspect
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Final

from quatfilt._typing import Array
from quatfilt.filters import (
    bilateral,
    butterworth,
    despike,
    gaussian,
    kalman,
    nonlocal_pose_means,
    one_euro,
    orientation_filter,
    savgol,
    smooth,
    wavelet,
    weighted_moving_mean,
)

AUTO: Final = "auto"
"""The best chain of this version, or the chain of a preset."""

REQUIRED: Final = inspect.Parameter.empty
"""The default of an option that has none."""


@dataclass(frozen=True)
class Method:
    """A filter as a step of `denoise`.

    Parameters
    ----------
    filter : callable
        The public function, from rotations to rotations. Its signature says which options there are.
    with_translation : callable
        The same for rotations and the translation of the root, or None; takes every option by name.
    angles : tuple of str
        Options in radians of rotation; the command line takes them in degrees.
    hidden : tuple of str
        Options with which the result is not rotations.
    """

    filter: Callable[..., Any]
    with_translation: Callable[..., tuple[Array, Array | None]]
    angles: tuple[str, ...] = ()
    hidden: tuple[str, ...] = ()

    @functools.cached_property
    def defaults(self) -> Mapping[str, Any]:
        """All keyword arguments of `with_translation`, with the default of the filter or `REQUIRED`."""
        _, *parameters = inspect.signature(self.filter).parameters.values()
        return {parameter.name: parameter.default for parameter in parameters}

    @functools.cached_property
    def options(self) -> tuple[str, ...]:
        """Options that a user can set."""
        return tuple(name for name in self.defaults if name not in self.hidden)


FILTERS: Final[dict[str, Method]] = {
    "bilateral": Method(bilateral.bilateral, bilateral.with_translation, angles=("sigma_angle",)),
    "butterworth": Method(butterworth.butterworth, butterworth.with_translation),
    "despike": Method(despike.despike, despike.with_translation, angles=("smallest",)),
    "gaussian": Method(gaussian.gaussian, gaussian.with_translation),
    "kalman": Method(kalman.kalman, kalman.with_translation, angles=("process_noise", "measurement_noise")),
    "nonlocal_pose_means": Method(
        nonlocal_pose_means.nonlocal_pose_means, nonlocal_pose_means.with_translation, angles=("bandwidth",)
    ),
    "one_euro": Method(one_euro.one_euro, one_euro.with_translation),
    "orientation_filter": Method(orientation_filter.orientation_filter, orientation_filter.with_translation),
    "savgol": Method(savgol.savgol, savgol.with_translation, hidden=("deriv",)),
    "smooth": Method(smooth.smooth, smooth.with_translation),
    "wavelet": Method(wavelet.wavelet, wavelet.with_translation, angles=("threshold",)),
    "weighted_moving_mean": Method(
        weighted_moving_mean.weighted_moving_mean, weighted_moving_mean.with_translation
    ),
}
"""The filters by name."""

METHODS: Final = (AUTO, *FILTERS)
"""Values of `method=`, or of the items of its list."""

__all__ = ["AUTO", "FILTERS", "METHODS", "REQUIRED", "Method"]
