"""Measures the learned last step on recordings: decibels of the automatic chain with it over the chain without, by clip.

python training/measure_gains.py --clips 07_05,86_09 --kinds white,ar5 --multiples 1,5,15 --every 1,4
"""

import argparse
import os
from collections import defaultdict
from pathlib import Path

import numpy as np
import quatfilt as qf
from numpy.typing import NDArray
from quatfilt.evaluation.clips import load
from quatfilt.evaluation.noises import SIGMA
from quatfilt.evaluation.smooth_goal import GOAL_CLIPS
from quatfilt.filters import _gains
from train_gains import WEIGHTS


def added(
    truth: NDArray[np.floating], sigma: float, kind: str, rng: np.random.Generator
) -> NDArray[np.floating]:
    """Return a clip with noise: "white", "ar3" for AR(1) with 0.3, "student", "unsteady", "bursts", "axis"; "clean" adds none."""
    if kind == "clean":
        return truth
    noise = rng.standard_normal((*truth.shape[:2], 3))
    level = np.ones(len(truth))
    if kind.startswith("ar"):
        correlation = float(kind[2:]) / 10
        for t in range(1, len(noise)):
            noise[t] = correlation * noise[t - 1] + np.sqrt(1 - correlation**2) * noise[t]
    elif kind == "student":
        noise = rng.standard_t(3, noise.shape) / np.sqrt(3)
    elif kind == "unsteady":
        level = np.repeat(rng.choice([2, 0.25], -(-len(truth) // 100)), 100)[: len(truth)]
    elif kind == "bursts":
        level *= 0.3
        for begin in np.flatnonzero(rng.random(len(truth)) < 0.01):
            level[begin : begin + 20] = 1.8
    elif kind == "axis":
        noise *= [0.3, 0.3, 3]
    moved = qf.multiply(truth, qf.exp(sigma * level[:, None, None] * noise / 2))
    return np.ascontiguousarray(moved, dtype=truth.dtype)


def main() -> None:
    """Measure, and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--data", type=Path, default=Path(os.environ.get("QUATFILT_DATA", "../shared/data")))
    parser.add_argument("--weights", type=Path, default=WEIGHTS)
    parser.add_argument("--clips", default=",".join(GOAL_CLIPS))
    parser.add_argument("--kinds", default="white")
    parser.add_argument("--multiples", default="1,5,15,30")
    parser.add_argument("--every", default="1", help="one frame of so many")
    parser.add_argument("--longest", type=int, default=800, help="frames")
    parser.add_argument("--noise", choices=["measured", "white"], default="measured")
    options = parser.parse_args()
    _gains.FILE = options.weights
    found = defaultdict(list)
    for name in options.clips.split(","):
        (clip,) = load(options.data, {name: ""})
        for every in map(int, options.every.split(",")):
            truth = np.ascontiguousarray(clip.steady_rotations[::every][: options.longest])
            for kind in options.kinds.split(","):
                for multiple in map(float, options.multiples.split(",")):
                    rng = np.random.default_rng([*name.encode(), *kind.encode(), round(10 * multiple)])
                    q = qf.despike(added(truth, multiple * SIGMA, kind, rng), fps=120 / every)
                    before, after = (
                        float(
                            qf.metrics.psnr(
                                truth,
                                qf.smooth(
                                    q,
                                    joints="together",
                                    noise=options.noise,
                                    learned=learned,
                                    fps=120 / every,
                                ),
                            )
                        )
                        for learned in (False, True)
                    )
                    found[kind, multiple, every].append(after - before)
                    print(
                        f"{name} {120 // every} fps {kind} {multiple:g}: {before:.2f} {after - before:+.2f}",
                        flush=True,
                    )
    for (kind, multiple, every), gains in found.items():
        mean, least, losses = np.mean(gains), np.min(gains), np.sum(np.array(gains) < 0)
        print(
            f"{120 // every} fps {kind} {multiple:g}: mean {mean:+.3f}, least {least:+.2f}, {losses} losses of {len(gains)}"
        )


if __name__ == "__main__":
    main()
