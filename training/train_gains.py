"""Trains the network of gains of automatic smoothing, and writes its weights with a checksum: `make train-gains`.

Recordings that tables are measured on are left out. With `--group` the network sees half of the people only, to be measured on the other half.
"""

import argparse
import hashlib
import os
from pathlib import Path

import numpy as np
from examples import draw, recordings
from network import train
from quatfilt.evaluation.clips import CLIPS, MORE
from quatfilt.evaluation.smooth_goal import GOAL_CLIPS

ROBUST_CLIPS = {"02_06", "05_20", "07_03", "13_31", "14_12", "14_21", "16_13", "16_57"}
"""Recordings of the table of robust denoising."""

MEASURED = {*GOAL_CLIPS, *CLIPS, *MORE, *ROBUST_CLIPS}
"""Recordings that tables are measured on: none of them is trained on."""

WEIGHTS = Path(__file__).parents[1] / "python" / "quatfilt" / "filters" / "smooth_gains.npz"


GROUPS = {1: {"07", "09", "13", "16"}, 2: {"02", "03", "05", "08", "14"}}
"""Two groups of people: a network of one is measured on the people of the other."""

ARRAYS = ("gates", "basis", "target", "weight")


def of_group(group: int, data: Path, crops: int, seed: int, kept: Path | None) -> list[np.ndarray]:
    """Return the examples of a group of people, drawn or kept from another run."""
    file = None if kept is None else kept / f"examples-{group}-{crops}-{seed}.npz"
    if file is not None and file.exists():
        found = np.load(file)
        return [found[name] for name in ARRAYS]
    examples = draw(recordings(data, GROUPS[group], MEASURED), crops, seed + group).joined()
    if file is not None:
        np.savez(file, **dict(zip(ARRAYS, examples, strict=True)))
    return list(examples)


def main() -> None:
    """Train, and write."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--data", type=Path, default=Path(os.environ.get("QUATFILT_DATA", "../shared/data")))
    parser.add_argument("--group", type=int, choices=[1, 2], help="train on this group of people only")
    parser.add_argument("--crops", type=int, default=300, help="crops of each group")
    parser.add_argument("--units", type=int, default=64)
    parser.add_argument("--steps", type=int, default=14_000)
    parser.add_argument("--batch", type=int, default=2048)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--examples", type=Path, help="folder that keeps the examples for another run")
    parser.add_argument("-o", "--output", type=Path, default=WEIGHTS)
    options = parser.parse_args()
    groups = [options.group] if options.group else [1, 2]
    parts = [of_group(group, options.data, options.crops, options.seed, options.examples) for group in groups]
    examples = [np.concatenate(arrays) for arrays in zip(*parts, strict=True)]
    layers = train(
        *examples, units=options.units, steps=options.steps, batch=options.batch, seed=options.seed
    )
    with options.output.open("wb") as file:
        np.savez(file, **dict(zip(("first", "second", "last"), layers, strict=True)))
    checksum = hashlib.sha256(options.output.read_bytes()).hexdigest()
    options.output.with_suffix(".npz.sha256").write_text(f"{checksum}  {options.output.name}\n")


if __name__ == "__main__":
    main()
