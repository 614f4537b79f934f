"""Draw ``docs/images/filters.png``: every filter of the package on the same clip.

``make pictures`` runs it. The clip is the built-in walk with white noise and one spike; no parameter is tuned on it.
"""

from pathlib import Path

import numpy as np
import quatfilt as qf
from quatfilt.evaluation._plot import DENOISED, NOISY, TRUTH, figure, quiet
from quatfilt.evaluation.synthetic import walk
from quatfilt.motion.motion import Motion

NOISE = np.radians(1.5)
"""Standard deviation per component of the rotation vector, radians."""

JOINT = "LeftAnkle"
SHOWN = (1.75, 2.75)
"""Seconds of the walk that the panels show: one strike of the heel, and the swing that follows."""

SPIKE_AT = 2.45
"""Seconds."""

SPIKE = np.radians(25)

PANELS: dict[str, dict[str, object]] = {
    'denoise(): method="auto"': {},
    "smooth": {"method": "smooth"},
    "nonlocal_pose_means": {"method": "nonlocal_pose_means"},
    "bilateral, iterations=5": {"method": "bilateral", "iterations": 5},
    "kalman (smoother)": {"method": "kalman"},
    "gaussian, sigma=0.03 s": {"method": "gaussian", "sigma": 0.03},
    "butterworth, cutoff=6 Hz": {"method": "butterworth", "cutoff": 6},
    "savgol, window_length=21": {"method": "savgol", "window_length": 21},
    "weighted_moving_mean, iterations=4": {"method": "weighted_moving_mean", "iterations": 4},
    "wavelet": {"method": "wavelet"},
    "orientation_filter, mask 1 4 6 4 1": {"method": "orientation_filter", "mask": [1, 4, 6, 4, 1]},
    "despike (spikes only)": {"method": "despike"},
    "kalman(smooth=False): no look-ahead": {"method": "kalman", "kalman": {"smooth": False}},
    "one_euro, min_cutoff=2, beta=3: no look-ahead": {
        "method": "one_euro",
        "min_cutoff": 2.0,
        "beta": 3.0,
    },
}
"""Titles and the arguments of `denoise`."""


def main() -> None:
    """Clean the walk with each filter and write the picture."""
    truth = walk(seconds=6.0)
    joint = truth.skeleton.index(JOINT)
    noisy = spoilt(truth, joint)
    page = figure(10.5, 11.0)
    panels = page.subplots(5, 3, sharex=True, sharey=True).ravel()
    time = np.arange(len(truth)) / truth.fps
    results = {"input: noise of 1.5° and one spike": noisy}
    results |= {title: qf.denoise(noisy, feet=None, **arguments) for title, arguments in PANELS.items()}
    for axes, (title, result) in zip(panels, results.items(), strict=True):
        quiet(axes)
        axes.plot(time, flexion(noisy, joint), color=NOISY, linewidth=0.8, label="input")
        axes.plot(time, flexion(truth, joint), color=TRUTH, linewidth=1.5, label="true")
        if result is not noisy:
            axes.plot(time, flexion(result, joint), color=DENOISED, linewidth=1.3, label="result")
        error = float(qf.metrics.angle_error(truth.rotations, result.rotations))
        axes.set_title(f"{title}\nmean error {error:.2f}°", loc="left", fontsize=8)
        axes.tick_params(labelsize=7)
    panels[0].set_xlim(*SHOWN)
    panels[0].set_ylim(-32, 22)
    handles, labels = panels[1].get_legend_handles_labels()
    page.legend(handles, labels, loc="outside upper center", ncols=3, frameon=False)
    page.supxlabel("time (seconds)", fontsize=9)
    page.supylabel("flexion of the left ankle (degrees)", fontsize=9)
    path = Path(__file__).with_suffix(".png")
    page.savefig(path)
    print(f"{path}: written")


def spoilt(truth: Motion, joint: int) -> Motion:
    """Return the walk with noise on every sample and a spike on one."""
    rotations = qf.add_gaussian_noise(truth.rotations, sigma=NOISE, rng=0)
    frame = round(SPIKE_AT * truth.fps)
    spike = qf.exp(np.array([SPIKE / 2, 0.0, 0.0]))
    rotations[frame, joint] = qf.multiply(rotations[frame, joint], spike)
    return truth.replace(rotations=rotations)


def flexion(motion: Motion, joint: int) -> np.ndarray:
    """Angle about the x axis, degrees."""
    w, x, _, _ = motion.rotations[:, joint].T
    return np.degrees(2 * np.arctan2(x * np.sign(w), np.abs(w)))


if __name__ == "__main__":
    main()
