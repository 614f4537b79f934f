"""A motion before and after a filter, joint by joint."""

import json
import os
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from quatfilt import _validation, sampling
from quatfilt.evaluation._plot import figure
from quatfilt.formats._bytes import write_bytes
from quatfilt.motion.motion import Motion
from quatfilt.motion.report import measured, picture, text
from quatfilt.motion.report.measured import Foot, Joint, Placed
from quatfilt.motion.report.sides import Side, sides

_PICTURES = (".png", ".pdf", ".svg")


@dataclass(frozen=True, repr=False, eq=False)
class Report:
    """What a filter did. `report` makes one; printed, it is a text.

    Parameters
    ----------
    frames : int
        Length of the clip.
    fps : float, hertz
        Frame rate; 1 where none is known, and jerk is then in degrees per frame cubed.
    overall : Joint
        All joints together.
    joints : tuple of Joint
        Each joint, in the order of the skeleton.
    feet : tuple of Foot
        How far the feet slide on the ground; none without a skeleton that has feet.
    clips : tuple of Side
        What was compared, for the curves of the picture.
    source : str
        What is known about the clip's source: held, repeated, frozen or interpolated frames; empty if every frame was measured.
    noise : str
        What was measured of the noise before, see `noise_model`: level, colour, along time, repeats and spikes.
    foot_scale : float
        Factor by which lengths were multiplied for the slide of the feet, see `metrics.foot_scale`; 1 where the unit is known.
    placed : Placed or None
        By how much joints were turned to hold the feet on the ground; None without the filtered motion before that.

    Examples
    --------
    >>> import quatfilt as qf
    >>> from quatfilt.evaluation.synthetic import walk
    >>> truth = walk(seconds=2)
    >>> noisy = truth.replace(rotations=qf.add_gaussian_noise(truth.rotations, sigma=0.02, rng=0))
    >>> result = qf.report(noisy, qf.denoise(noisy), reference=truth)
    >>> isinstance(result, qf.Report)
    True
    >>> result.overall.error_after < 0.6 * result.overall.error_before
    True
    """

    frames: int
    fps: float
    overall: Joint
    joints: tuple[Joint, ...]
    feet: tuple[Foot, ...]
    clips: tuple[Side, ...] = ()
    source: str = ""
    noise: str = ""
    foot_scale: float = 1.0
    placed: Placed | None = None

    def __repr__(self) -> str:
        return f"Report({self.frames} frames of {len(self.joints)} joints, changed by {self.overall.change_mean:.2g}°)"

    def __str__(self) -> str:
        return text.plain(self)

    def as_dict(self) -> dict[str, Any]:
        """Return all numbers by name, as JSON has them: what cannot be measured is None.

        Returns
        -------
        dict
            ``frames``, ``fps``, ``source``, ``noise``, ``overall``, ``joints``, ``feet``, ``foot_scale`` and ``placed``.
        """
        return {
            "frames": self.frames,
            "fps": self.fps,
            "source": self.source,
            "noise": self.noise,
            "overall": _finite(asdict(self.overall)),
            "joints": [_finite(asdict(joint)) for joint in self.joints],
            "feet": [_finite(asdict(foot)) for foot in self.feet],
            "foot_scale": self.foot_scale,
            "placed": None if self.placed is None else asdict(self.placed),
        }

    def write(self, path: str | os.PathLike[str]) -> None:
        """Write the report into a file.

        Parameters
        ----------
        path : str or path
            ``.png``, ``.pdf`` or ``.svg``: a picture with the curves of the joints that changed most, the jerk of all joints
            and the slide of the feet. ``.json``: what `as_dict` returns. ``.txt``: the text.

        Raises
        ------
        ValueError
            For another extension.
        ImportError
            For a picture, without matplotlib.
        FileAccessError
            If the file cannot be written.
        """
        name = _validation.path(path, "path")
        extension = check_path(name)
        if extension in _PICTURES:
            content = picture.draw(self, self.clips, extension.removeprefix("."))
        elif extension == ".json":
            content = (json.dumps(self.as_dict(), indent=2, ensure_ascii=False) + "\n").encode()
        else:
            content = (str(self) + "\n").encode()
        write_bytes(name, lambda: content)


def report(
    before: Motion | ArrayLike,
    after: Motion | ArrayLike,
    *,
    reference: Motion | ArrayLike | None = None,
    filtered: Motion | None = None,
    fps: float | None = None,
    scalar_first: bool = True,
) -> Report:
    """Tell what a filter did to a motion, joint by joint.

    By how much it turned the samples, how much noise, jerk and sliding of the feet it took away, how much of the fast
    motion it kept, and which missing samples and spikes it replaced. A reference tells how far both are from the truth.

    Parameters
    ----------
    before, after : Motion or array_like, shape (frames, joints, 4) or (frames, 4)
        The same clip without and with the filter.
    reference : like `before`, or None, default None
        What is true.
    filtered : Motion or None, default None
        The filtered motion before its feet were placed, from ``denoise(..., feet=None)``: the report then tells by how much joints were
        turned to hold them.
    fps : float or None, hertz, default None
        Frame rate; None for the motion's own. Arrays without one are judged by frames: jerk is in degrees per frame cubed,
        and spikes are those of 120 frames per second.
    scalar_first : bool, default True
        Whether quaternions of arrays are ``(w, x, y, z)``; False for SciPy's ``(x, y, z, w)``.

    Returns
    -------
    Report
        Prints as a text; ``write("report.png")`` draws it, `as_dict` is for programs.

    Raises
    ------
    ValueError, TypeError
        If the clips differ in kind, joints, frames or frame rate; the message says how.

    See Also
    --------
    denoise, metrics

    Notes
    -----
    Noise is what `noise_level` estimates, per component of the rotation vector; jerk is `metrics.jerk`, and the peak kept is
    `metrics.peak_velocity_kept` of `after` against `before`: noise has fast turns of its own, so that 1 is not to be
    expected where there was much. Feet slide while those of the reference touch the ground; without one, those of `after`.

    Examples
    --------
    >>> import quatfilt as qf
    >>> from quatfilt.evaluation.synthetic import walk
    >>> truth = walk(seconds=2)
    >>> noisy = truth.replace(rotations=qf.add_gaussian_noise(truth.rotations, sigma=0.02, rng=0))
    >>> result = qf.report(noisy, qf.denoise(noisy))
    >>> result.overall.jerk_after < 0.1 * result.overall.jerk_before
    True
    """
    clips = sides(before, after, reference, fps=fps, scalar_first=scalar_first)
    rate = clips[0].fps
    joints, overall = measured.joints(*clips)
    return Report(
        frames=len(clips[0].rotations),
        fps=1.0 if rate is None else rate,
        overall=overall,
        joints=joints,
        feet=measured.feet(*clips),
        clips=clips,
        source=sampling.recognised(clips[0].rotations, 1.0 if rate is None else rate).says(rate),
        noise=measured.model(clips[0]),
        foot_scale=measured.foot_scale(clips[0]),
        placed=_placed(filtered, after),
    )


def _placed(filtered: Motion | None, after: Motion | ArrayLike) -> Placed | None:
    """Return what holding the feet changed, if the motion before that is known."""
    if filtered is None:
        return None
    if not isinstance(after, Motion):
        raise TypeError("filtered: expected None with rotations, got a Motion")
    if filtered.rotations.shape != after.rotations.shape:
        raise ValueError(
            f"filtered: expected the shape of after, {after.rotations.shape}, got {filtered.rotations.shape}"
        )
    return measured.placed(filtered, after)


def check_path(path: str | os.PathLike[str]) -> str:
    """Return the extension of a path that a report can be written to."""
    extension = Path(path).suffix.lower()
    if extension in _PICTURES:
        figure(1, 1)  # refuses without matplotlib
    elif extension not in (".json", ".txt"):
        expected = ", ".join([*_PICTURES, ".json"])
        raise ValueError(f"path: expected {expected} or .txt, got {extension or 'no extension'}")
    return extension


def _finite(values: dict[str, Any]) -> dict[str, Any]:
    return {
        name: None if isinstance(value, float) and not np.isfinite(value) else value
        for name, value in values.items()
    }


__all__ = ["Foot", "Joint", "Placed", "Report", "check_path", "report"]
