"""Measures the learned last step on recordings: decibels over the pilot for kinds and levels of noise, by clip.

python training/measure_gains.py --clips 07_05,86_09 --kinds white,ar5 --multiples 1,5,15 --every 1,4
"""

import argparse
import os
from collections import defaultdict
from pathlib import Path

import numpy as np
import quatfilt as qf
from quatfilt import _core
from quatfilt.evaluation.clips import load
from quatfilt.evaluation.noises import SIGMA
from quatfilt.evaluation.smooth_goal import GOAL_CLIPS
from train_gains import WEIGHTS


def added(truth: np.ndarray, sigma: float, kind: str, rng: np.random.Generator) -> np.ndarray:
    """Return a clip with noise: "white", "ar3" for AR(1) with 0.3, "student", "unsteady", "bursts" or "axis"."""
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
    parser.add_argument("--multiples", default="1,5,15")
    parser.add_argument("--every", default="1", help="one frame of so many")
    parser.add_argument("--longest", type=int, default=800, help="frames")
    options = parser.parse_args()
    with np.load(options.weights) as file:
        layers = [file[name] for name in ("first", "second", "last")]
    found = defaultdict(list)
    for name in options.clips.split(","):
        (clip,) = load(options.data, {name: ""})
        for every in map(int, options.every.split(",")):
            truth = np.ascontiguousarray(clip.steady_rotations[::every][: options.longest])
            for kind in options.kinds.split(","):
                for multiple in map(float, options.multiples.split(",")):
                    rng = np.random.default_rng([*name.encode(), *kind.encode(), round(10 * multiple)])
                    q = added(truth, multiple * SIGMA, kind, rng)
                    noise = _core.noise_level(q).astype(np.float64)
                    smoothed = _core.smooth(q, None, None, noise, 0.0)[0]
                    body = _core.smooth_body(q, smoothed, None, noise)
                    patches = _core.smooth_patches(q, body, None, noise, 1)
                    pilot = _core.smooth_rank(q, patches, None, noise)
                    result = _core.smooth_gains(q, patches, pilot, None, noise, 1.0, *layers)
                    before, after = (float(qf.metrics.psnr(truth, x)) for x in (pilot, result))
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
