"""Curves of a joint around an impact of its foot: true, noisy and cleaned.

``python -m quatfilt.evaluation.picture FILE.png`` draws the picture of the README.
"""

import os
import sys
from pathlib import Path

import numpy as np

from quatfilt._typing import Array
from quatfilt.evaluation._gait import CYCLE as GAIT_CYCLE
from quatfilt.evaluation._plot import DENOISED, NOISY, TRUTH, figure, quiet
from quatfilt.evaluation.demonstration import Demonstration, demonstrate
from quatfilt.motion.motion import Motion
from quatfilt.rotations.quaternion import geodesic_distance

JOINT = "LeftAnkle"

_START, _CYCLES = 1.2, 2.0
"""Seconds into the walk, and how many strides are shown."""

_AROUND = 0.12
"""Seconds before and after the impact in the close view."""


def draw(demonstration: Demonstration, path: str | os.PathLike[str]) -> None:
    """Draw the flexion of the left ankle and its angular speed into a file.

    Parameters
    ----------
    demonstration : Demonstration
        The three motions.
    path : str or path
        A ``.png``, ``.pdf`` or ``.svg``.

    Raises
    ------
    ImportError
        Without matplotlib.
    """
    page = figure(9.0, 5.2)
    truth = demonstration.truth
    time = np.arange(len(truth)) / truth.fps
    curves = [
        ("noisy", demonstration.noisy, NOISY, 0.9, 1),
        ("true", truth, TRUTH, 1.8, 2),
        ("cleaned by quatfilt", demonstration.denoised, DENOISED, 1.3, 3),
    ]
    impact = _impact(truth)
    wide, close = page.subplots(2, 2, width_ratios=(2.2, 1), sharey="row").T
    for axes in (*wide, *close):
        quiet(axes)
    for name, motion, colour, width, order in curves:
        values = _flexion(motion), _speed(motion)
        for row in range(2):
            for axes in (wide[row], close[row]):
                axes.plot(time, values[row], color=colour, linewidth=width, zorder=order, label=name)
    for axes in wide:
        axes.set_xlim(_START, _START + _CYCLES * GAIT_CYCLE)
        axes.axvspan(impact - _AROUND, impact + _AROUND, color="#0072B2", alpha=0.10, linewidth=0)
    for axes in close:
        axes.set_xlim(impact - _AROUND, impact + _AROUND)
        axes.tick_params(labelleft=False)
    wide[0].set_title("Left ankle of a synthetic walk at 120 frames per second", loc="left", fontsize=10)
    close[0].set_title("The sole strikes the ground", loc="left", fontsize=10)
    wide[0].set_ylabel("flexion (degrees)")
    wide[1].set_ylabel("angular speed\n(degrees per second)")
    top = 1.25 * float(_speed(truth).max())
    wide[1].set_ylim(0, top)
    for axes in (wide[1], close[1]):
        axes.set_xlabel("time (seconds)")
    handles, labels = wide[0].get_legend_handles_labels()
    page.legend(handles, labels, loc="outside upper center", ncols=3, frameon=False)
    page.savefig(os.fspath(path))


def _impact(truth: Motion) -> float:
    """Time of the first slap of the sole after a while: where the ankle's turn changes most from frame to frame."""
    speed = _speed(truth)
    change = np.abs(np.diff(speed))
    window = slice(round((_START + 0.3) * truth.fps), round((_START + 0.3 + GAIT_CYCLE) * truth.fps))
    return float((window.start + int(np.argmax(change[window]))) / truth.fps)


def _joint(motion: Motion) -> Array:
    return motion.rotations[:, motion.skeleton.index(JOINT)]


def _flexion(motion: Motion) -> Array:
    """Angle of the turn about the x axis, in degrees."""
    w, x, _, _ = _joint(motion).T
    return np.asarray(np.degrees(2 * np.arctan2(x * np.sign(w), np.abs(w))))


def _speed(motion: Motion) -> Array:
    """Angular speed from frame to frame, in degrees per second; the last one twice."""
    q = _joint(motion)
    speed = np.degrees(geodesic_distance(q[:-1], q[1:])) * motion.fps
    return np.append(speed, speed[-1:])


def main() -> None:
    """Draw the picture of the README into the file that is named."""
    if len(sys.argv) != 2:
        sys.exit("usage: python -m quatfilt.evaluation.picture FILE.png")
    path = Path(sys.argv[1])
    path.parent.mkdir(parents=True, exist_ok=True)
    draw(demonstrate(), path)


if __name__ == "__main__":
    main()

__all__ = ["draw"]
