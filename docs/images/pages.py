"""Draw the pictures of single pages: missing samples, confidence, streams, feet, segments, noise model, patch search, whole poses.

``make pictures`` runs it. Each function draws one picture from the built-in walk or from a short synthetic motion.
"""

from pathlib import Path
from typing import Any

import numpy as np
import quatfilt as qf
from quatfilt.evaluation._plot import CYCLE, DENOISED, NOISY, TRUTH, figure, quiet
from quatfilt.evaluation.synthetic import walk
from quatfilt.geodesics.segment import segments

FOLDER = Path(__file__).parent
FPS = 120


def main() -> None:
    """Draw all pictures."""
    for draw in (gaps, confidence, streams, feet, segment, noise_model, patch_search, pga_body):
        page = draw()
        path = FOLDER / f"{draw.__name__}.png"
        page.savefig(path)
        print(f"{path}: written")


def angle(rotations: np.ndarray, axis: int = 0) -> np.ndarray:
    """Angle about one axis of rotations ``(frames, 4)``, degrees."""
    w, part = rotations[:, 0], rotations[:, 1 + axis]
    return np.degrees(2 * np.arctan2(part * np.sign(w), np.abs(w)))


def panel(width: float = 8.0, height: float = 3.0) -> tuple[Any, Any]:
    """Return a page with one panel over time."""
    page = figure(width, height)
    axes = page.subplots()
    quiet(axes)
    axes.set_xlabel("time (seconds)")
    return page, axes


def ankle(motion: qf.Motion) -> np.ndarray:
    """Rotations of the left ankle."""
    return motion.rotations[:, motion.skeleton.index("LeftAnkle")]


def gaps() -> Any:
    """Draw a gap of 0.2 s in the left ankle, filled by a geodesic and by a cubic."""
    truth = ankle(walk(seconds=4.0))
    broken = truth.copy()
    gap = slice(262, 286)
    broken[gap] = np.nan
    time = np.arange(len(truth)) / FPS
    page, axes = panel()
    axes.axvspan(time[gap.start], time[gap.stop - 1], color="#E3EEF7", linewidth=0)
    axes.plot(time, angle(truth), color=TRUTH, linewidth=1.8, label="true")
    for number, method in enumerate(("slerp", "squad")):
        filled, _ = qf.fill_gaps(broken, method=method)
        shown = slice(gap.start - 1, gap.stop + 1)
        axes.plot(
            time[shown], angle(filled)[shown], color=CYCLE[number], linewidth=1.6, label=f"method={method!r}"
        )
    axes.set_xlim(1.8, 2.8)
    axes.set_ylabel("left ankle, flexion (degrees)")
    axes.legend(frameon=False)
    return page


def confidence() -> Any:
    """Draw ten bad samples, filtered with and without their confidence."""
    time = np.arange(240) / FPS
    swing = qf.exp(0.4 * np.sin(2 * np.pi * time)[:, None] * [0.0, 0.0, 1.0])
    tracked = qf.add_gaussian_noise(swing, sigma=np.radians(1), rng=0)
    bad = slice(90, 100)
    tracked[bad] = qf.multiply(tracked[bad], qf.exp([0.0, 0.0, 0.3]))
    weights = np.ones(240)
    weights[bad] = 0.1
    page, axes = panel()
    axes.axvspan(time[bad.start], time[bad.stop - 1], color="#E3EEF7", linewidth=0)
    axes.plot(
        time, angle(tracked, 2), color=NOISY, linewidth=1.0, label="input; confidence 0.1 in the band, else 1"
    )
    axes.plot(time, angle(swing, 2), color=TRUTH, linewidth=1.8, label="true")
    axes.plot(
        time,
        angle(qf.gaussian(tracked, sigma=0.03, fps=FPS), 2),
        color=CYCLE[0],
        linewidth=1.4,
        label="gaussian",
    )
    weighted = qf.gaussian(tracked, sigma=0.03, fps=FPS, confidence=weights)
    axes.plot(time, angle(weighted, 2), color=DENOISED, linewidth=1.4, label="gaussian with confidence=")
    axes.set_xlim(0.45, 1.2)
    axes.set_ylabel("angle (degrees)")
    axes.legend(frameon=False)
    return page


def streams() -> Any:
    """Draw the Kalman stream with several look-aheads."""
    truth = ankle(walk(seconds=4.0))
    noisy = qf.add_gaussian_noise(truth, sigma=np.radians(1.5), rng=0)
    time = np.arange(len(truth)) / FPS
    page, axes = panel()
    axes.plot(time, angle(noisy), color=NOISY, linewidth=0.8, label="input")
    axes.plot(time, angle(truth), color=TRUTH, linewidth=1.8, label="true")
    for number, lookahead in enumerate((0, 6)):
        process, measurement = qf.kalman_noises(noisy, fps=FPS, lookahead=lookahead)
        stream = qf.KalmanStream(
            fps=FPS, process_noise=process, measurement_noise=measurement, lookahead=lookahead
        )
        poses = [pose for pose in map(stream.push, noisy) if pose is not None]
        result = np.concatenate([np.array(poses), stream.flush()])
        error = qf.metrics.angle_error(truth, result)
        label = f"KalmanStream(lookahead={lookahead}), mean error {error:.2f}°"
        axes.plot(time, angle(result), color=CYCLE[number], linewidth=1.4, label=label)
    axes.set_xlim(1.75, 2.75)
    axes.set_ylabel("left ankle, flexion (degrees)")
    axes.legend(frameon=False, fontsize=8)
    return page


def feet() -> Any:
    """Draw the path of the left toe on the ground during one contact."""
    truth = walk(seconds=4.0)
    noisy = truth.replace(rotations=qf.add_gaussian_noise(truth.rotations, sigma=0.01, rng=0))
    toe = truth.skeleton.index("LeftToe")
    sliding = qf.denoise(noisy, feet=None)
    results = {
        "true": (truth, TRUTH),
        "filter alone, feet=None": (sliding, CYCLE[0]),
        'feet="keep"': (qf.denoise(noisy), DENOISED),
        'feet="lock"': (qf.denoise(noisy, feet="lock"), CYCLE[2]),
    }
    page, axes = panel()
    time = np.arange(len(truth)) / FPS
    for label, (motion, colour) in results.items():
        slide = qf.metrics.foot_slide(motion, reference=truth)
        forward = motion.positions()[:, toe, 2]
        axes.plot(time, forward, color=colour, linewidth=1.5, label=f"{label}: slide {slide:.1f} cm")
    still = truth.positions()[:, toe, 2]
    start = int(np.argmin(np.abs(np.diff(still[200:320])))) + 200
    axes.set_xlim(time[start] - 0.15, time[start] + 0.45)
    axes.set_ylim(still[start] - 2.0, still[start] + 2.0)
    axes.set_ylabel("left toe, forward (cm)")
    axes.legend(frameon=False, fontsize=8)
    return page


def segment() -> Any:
    """Draw the cuts of a nod, a shake and a nod."""
    phase = np.sin(2 * np.pi * np.arange(1200) / FPS)[:, None]
    nod, shake = qf.exp(phase * [0.4, 0.0, 0.0]), qf.exp(phase * [0.0, 0.3, 0.05])
    motion = np.concatenate([nod, shake, nod])
    found = segments(motion, fps=FPS)
    time = np.arange(len(motion)) / FPS
    page = figure(8.0, 4.0)
    above, below = page.subplots(2, 1, sharex=True)
    for axis, name in enumerate(("nod, about x", "shake, about y")):
        above.plot(time, angle(motion, axis), color=CYCLE[axis], linewidth=0.9, label=name)
    above.set_ylabel("angle (degrees)")
    below.plot(time, found.growth, color=CYCLE[0], linewidth=1.2, label="growth of the error d")
    below.plot(time, found.limit, color=CYCLE[1], linewidth=1.0, label="limit")
    below.set_ylabel("sin² of half angles")
    below.set_xlabel("time (seconds); dashed: cuts")
    for axes in (above, below):
        quiet(axes)
        axes.legend(frameon=False, ncols=2, loc="lower right", bbox_to_anchor=(1.0, 1.0), fontsize=8)
        for cut in found.cuts / FPS:
            axes.axvline(cut, color=TRUTH, linewidth=1.0, linestyle="--")
    return page


def noise_model() -> Any:
    """Draw the level of unsteady noise along time: true and measured."""
    truth = walk(seconds=10.0)
    level = np.where((np.arange(len(truth)) // 240) % 2, 2.0, 0.5)
    rng = np.random.default_rng(0)
    vectors = 0.02 * level[:, None, None] * rng.standard_normal((*truth.rotations.shape[:2], 3))
    noisy = qf.multiply(truth.rotations, qf.exp(vectors / 2))
    model = qf.noise_model(noisy, fps=FPS)
    time = np.arange(len(truth)) / FPS
    scale = np.sqrt(np.mean(model.level**2))
    page, axes = panel()
    axes.plot(time, np.degrees(0.02 * level), color=TRUTH, linewidth=1.8, label="true level of the noise")
    axes.plot(
        time, np.degrees(scale * model.along_time), color=DENOISED, linewidth=1.3, label="level × along_time"
    )
    axes.set_ylim(0, None)
    axes.set_ylabel("degrees per component")
    axes.legend(frameon=False, ncols=2, loc="lower right", bbox_to_anchor=(1.0, 1.0))
    return page


def patch_search() -> Any:
    """Draw a frame of the walk and its four nearest frames."""
    motion = walk(seconds=6.0)
    frame = 390
    indices, _ = qf.patch_neighbors(motion.rotations[:, 1:], k=4, exclusion=30)
    time = np.arange(len(motion)) / FPS
    curve = angle(ankle(motion))
    page, axes = panel()
    axes.plot(time, curve, color=NOISY, linewidth=1.2)
    axes.plot(time[frame], curve[frame], "o", color=TRUTH, markersize=9, label="frame 390")
    nearest = indices[frame]
    axes.plot(
        time[nearest],
        curve[nearest],
        "o",
        color=DENOISED,
        markersize=7,
        label="its four nearest patches, all joints",
    )
    axes.set_ylabel("left ankle, flexion (degrees)")
    axes.legend(frameon=False, ncols=2, loc="lower right", bbox_to_anchor=(1.0, 1.0), fontsize=8)
    return page


def pga_body() -> Any:
    """Draw the mean remaining angle of whole poses by the number of geodesics."""
    motion = walk(seconds=6.0)
    analysis = qf.PrincipalGeodesicAnalysis(8, body=True).fit(motion.rotations)
    joints = motion.rotations.shape[1]
    page = figure(6.0, 3.0)
    axes = page.subplots()
    quiet(axes)
    remaining = np.degrees(np.asarray(analysis.residuals_).ravel()) / np.sqrt(joints)
    axes.bar(np.arange(1, len(remaining) + 1), remaining, color=CYCLE[0])
    axes.set_xlabel("geodesics = numbers per pose")
    axes.set_ylabel("remaining angle per joint\n(degrees, root mean square)")
    return page


if __name__ == "__main__":
    main()
