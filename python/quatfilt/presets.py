"""Priors for kinds of recordings: which steps of the automatic method, with which values, and why."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Final, Literal, TypeAlias

Jitter: TypeAlias = Literal["never", "doubted", "expected"]
"""How likely jitter is that moves as fast as limbs do, and that a low pass takes away."""


@dataclass(frozen=True)
class Preset:
    """A chain of filters with its values, and how likely jitter is.

    Parameters
    ----------
    about : str
        What it is for.
    steps : mapping
        From the names of filters in their order to values of their options.
    shared : mapping
        Values of options of all steps.
    jitter : {"never", "doubted", "expected"}
        Whether a low pass follows: never; where no person moves like that; or where it is likely.
    reasons : mapping
        Why: from the name of a step, of an option of a step as in ``step.option``, of a shared option, or ``jitter``.
    """

    about: str
    steps: Mapping[str, Mapping[str, Any]]
    shared: Mapping[str, Any] = field(default_factory=dict)
    jitter: Jitter = "doubted"
    reasons: Mapping[str, str] = field(default_factory=dict)


BEST: Final = Preset(
    "what method='auto' runs",
    {"despike": {"radius": "auto"}, "smooth": {"joints": "together", "noise": "measured"}},
)
"""The best chain that this version has, for clips of which nothing is known."""

PRESETS: Final[dict[str, Preset]] = {
    "optical": Preset(
        "markers and infrared cameras, 100 frames per second and more: little noise, swapped and hidden markers",
        {"despike": {"radius": "auto"}, "smooth": {"joints": "together", "noise": "measured"}},
        {"max_gap": 0.5},
        "never",
        {
            "despike": "markers that change places throw a limb about for a frame or two",
            "despike.radius": "runs of several frames lie close together where markers are confused; 10 frames at 120 per second",
            "smooth.joints": "white noise at a high frame rate is what the automatic smoother is for, and a body repeats itself",
            "smooth.noise": "markers at the edge of the cameras' view are noisier for a while",
            "max_gap": "a limb hidden for longer may have done anything; longer gaps stay visible as such",
            "jitter": "cameras see a quick limb as well as a slow one: quick motion is motion",
        },
    ),
    "inertial": Preset(
        "suits of gyroscopes and accelerometers: smooth but for a little white noise; drift is left alone",
        {"smooth": {"joints": "together", "noise": "measured"}},
        {"max_gap": 0.1},
        "never",
        {
            "smooth": "takes no more than the noise it finds: the suit's own Kalman filter has smoothed before",
            "smooth.joints": "a body repeats itself",
            "smooth.noise": "sensors slip and are struck: noise is found where it is",
            "max_gap": "lost packets last some frames; a longer gap is a sensor that failed",
            "jitter": "gyroscopes measure speed itself: quick motion is motion",
        },
    ),
    "video": Preset(
        "poses estimated from video, 24 to 60 frames per second: strong, temporally correlated noise",
        {"despike": {"radius": "auto"}, "smooth": {"joints": "together", "noise": "measured"}},
        {"max_gap": 2 / 3},
        "expected",
        {
            "despike": "detectors mistake left for right, or lose a limb, for up to 0.375 s",
            "despike.radius": "runs of 90 ms at any frame rate",
            "smooth.joints": "a body repeats itself",
            "smooth.noise": "noise of detectors is temporally correlated, and its level changes",
            "max_gap": "20 frames of 30 per second, as in Pose2Sim: trackers lose a limb for so long behind another",
            "jitter": "noise about as fast as limbs passes for motion: where the spectrum shows it, a low pass with the measured cut-off follows",
        },
    ),
}
"""By the kind of recording."""

__all__ = ["BEST", "PRESETS", "Jitter", "Preset"]
