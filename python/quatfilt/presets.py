"""Chains for kinds of recordings: which filters, with which values, and why."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Final


@dataclass(frozen=True)
class Preset:
    """A chain of filters with its values.

    Parameters
    ----------
    about : str
        What it is for.
    steps : mapping
        From the names of filters in their order to values of their options.
    shared : mapping
        Values of options of all steps.
    reasons : mapping
        Why: from the name of a step, of an option of a step as in ``step.option``, or of a shared option.
    """

    about: str
    steps: Mapping[str, Mapping[str, Any]]
    shared: Mapping[str, Any] = field(default_factory=dict)
    reasons: Mapping[str, str] = field(default_factory=dict)


BEST: Final = Preset(
    "what method='auto' runs",
    {"despike": {"radius": "auto"}, "smooth": {"joints": "together", "noise": "measured"}},
)
"""The best chain that this version has, for clips of which nothing is known."""

PRESETS: Final[dict[str, Preset]] = {
    "optical": Preset(
        "markers and infrared cameras, 100 frames per second and more: little noise, swapped and hidden markers",
        {"despike": {"radius": "auto"}, "smooth": {"joints": "together"}},
        {"max_gap": 0.5},
        {
            "despike": "markers that change places throw a limb about for a frame or two",
            "despike.radius": "runs of several frames lie close together where markers are confused; 10 frames at 120 per second",
            "smooth.joints": "white noise at a high frame rate is what the automatic smoother is for, and a body repeats itself",
            "max_gap": "a limb hidden for longer may have done anything; longer gaps stay visible as such",
        },
    ),
    "inertial": Preset(
        "suits of gyroscopes and accelerometers: smooth but for a little white noise; drift is left alone",
        {"smooth": {}},
        {"max_gap": 0.1},
        {
            "smooth": "takes no more than the noise it finds: the suit's own Kalman filter has smoothed before",
            "max_gap": "lost packets last some frames; a longer gap is a sensor that failed",
        },
    ),
    "video": Preset(
        "poses estimated from video, 24 to 60 frames per second: strong noise that hangs together in time",
        {"despike": {}, "nonlocal_pose_means": {"weights": "joint"}, "butterworth": {"cutoff": 6.0}},
        {"max_gap": 2 / 3},
        {
            "despike": "detectors mistake left for right for a frame or two",
            "nonlocal_pose_means.weights": "each joint is estimated well or badly for itself",
            "butterworth.cutoff": "hertz, Pose2Sim's default: what hangs together in time looks like motion to smoothers of white noise",
            "max_gap": "20 frames of 30 per second, as in Pose2Sim: trackers lose a limb for so long behind another",
        },
    ),
}
"""By the kind of recording."""

__all__ = ["BEST", "PRESETS", "Preset"]
