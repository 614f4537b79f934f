"""Examples for the network of gains: what it reads, the vectors that it scales, and what their sum should be.

Each crop of a recording gets noise of a drawn kind and level and runs through the steps before the learned one, as `quatfilt.smooth` runs them.
"""

import math
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import quatfilt as qf
from numpy.typing import NDArray
from quatfilt import _core
from quatfilt._reference.filters.development import developed_about
from quatfilt._reference.filters.smooth import gains
from quatfilt._reference.rotations.quaternion import between, exp, log_short, multiply, normalize
from quatfilt.evaluation.noises import SIGMA
from quatfilt.filters._measured import assumed_level, whitened
from quatfilt.filters._spans import Span
from quatfilt.motion.defects import find_defects
from quatfilt.noise._measure import measure

Array = NDArray[np.floating]

LONGEST, SHORTEST = 500, 130
"""Frames of a crop."""

EVERY, EVERY_SHARES = (1, 2, 4), (0.5, 0.2, 0.3)
"""One frame of so many is taken: 120, 60 and 30 frames per second."""

WEAKEST, STRONGEST = 0.6, 30.0
"""Levels of the noise in units of `SIGMA`; their logarithm is uniform."""

KINDS = {"white": 0.62, "ar": 0.16, "student": 0.06, "unsteady": 0.10, "bursts": 0.03, "axis": 0.03}
"""Kinds of noise, and their shares."""

CORRELATION = (0.15, 0.8)
"""Range of the coefficient of AR(1) noise."""

MODELLED = 0.75
"""Share of crops whose noise is measured and whitened, as with `noise="measured"`; the noise of the others is taken for white."""

FEW_JOINTS = 0.15
"""Share of crops with a few joints only, drawn without order."""

NO_BODY = 0.05
"""Share of crops without the projection on the axes of the body, which wide skeletons do not have."""

POSITIONS = 2500
"""Examples of a crop: cells, joints and axes, drawn without replacement."""


@dataclass
class Examples:
    """What the network is trained on."""

    gates: list[Array] = field(default_factory=list)
    """`(n, GATES)`."""
    basis: list[Array] = field(default_factory=list)
    """`(n, BASES, CELL)`: vectors at all frames of a cell."""
    target: list[Array] = field(default_factory=list)
    """`(n, CELL)`: from the pilot to the truth."""
    weight: list[Array] = field(default_factory=list)
    """`(n,)`: over the mean squared error of the pilot in the crop."""

    def joined(self) -> tuple[Array, Array, Array, Array]:
        """Return all crops together."""
        return (
            np.concatenate(self.gates),
            np.concatenate(self.basis),
            np.concatenate(self.target),
            np.concatenate(self.weight),
        )


def recordings(data: Path, people: set[str], without: set[str]) -> dict[str, list[Path]]:
    """Return the recordings of each of some people in a folder, without those of given names."""
    found: dict[str, list[Path]] = {}
    for path in sorted(data.rglob("*.amc")):
        person, _, number = path.stem.partition("_")
        if number.isdigit() and person in people and path.stem not in without:
            found.setdefault(person, []).append(path)
    return found


def draw(people: dict[str, list[Path]], crops: int, seed: int) -> Examples:
    """Draw crops: first a person, by the root of the number of recordings, then one of their recordings."""
    rng = np.random.default_rng(seed)
    names = sorted(people)
    shares = np.sqrt([len(people[name]) for name in names])
    clips: dict[Path, Array] = {}
    examples = Examples()
    while len(examples.gates) < crops:
        person = names[rng.choice(len(names), p=shares / shares.sum())]
        path = people[person][rng.integers(len(people[person]))]
        if path not in clips:
            motion = qf.read_motion(path)
            clips[path] = motion.rotations[:, find_defects(motion.rotations, fps=motion.fps).steady]
        truth = _crop(clips[path], rng)
        if truth is not None:
            _add(examples, truth, rng)
    return examples


def _crop(clip: Array, rng: np.random.Generator) -> Array | None:
    every = int(rng.choice(EVERY, p=EVERY_SHARES))
    part = clip[int(rng.integers(every)) :: every]
    if len(part) < SHORTEST:
        return None
    start = int(rng.integers(max(len(part) - LONGEST, 0) + 1))
    part = part[start : start + LONGEST]
    if rng.random() < FEW_JOINTS:
        count = min(int(rng.choice([1, 2, 4, 8, 16])), part.shape[1])
        part = part[:, rng.permutation(part.shape[1])[:count]]
    return np.ascontiguousarray(part)


def _add(examples: Examples, truth: Array, rng: np.random.Generator) -> None:
    multiple = math.exp(rng.uniform(math.log(WEAKEST), math.log(STRONGEST)))
    kind = str(rng.choice(list(KINDS), p=list(KINDS.values())))
    q = noisy(truth, multiple * SIGMA, kind, rng)
    confidence = None
    if rng.random() < MODELLED:
        q, truth, confidence, noise = modelled(q, truth)
    else:
        noise = _core.noise_level(q).astype(np.float64)
    if noise.min() < gains.LEAST_NOISE:
        return
    smoothed = _core.smooth(q, None, confidence, noise, 0.0)[0]
    body = _core.smooth_body(q, smoothed, confidence, noise)
    patches = _core.smooth_patches(q, body, confidence, noise, 1)
    pilot = _core.smooth_rank(q, patches, confidence, noise)
    found, target = vectors(truth, q, patches, pilot, confidence, noise, body=rng.random() >= NO_BODY)
    read = gains.gates(found)
    cells, joints = len(truth) // gains.CELL, truth.shape[1]
    picked = rng.choice(cells * joints * 3, min(POSITIONS, cells * joints * 3), replace=False)
    cell, joint, axis = np.unravel_index(picked, (cells, joints, 3))
    frames = gains.CELL * cell[:, None] + np.arange(gains.CELL)
    here = (frames, joint[:, None], axis[:, None])
    examples.gates.append(read[cell, joint, axis].astype(np.float16))
    examples.basis.append(np.swapaxes(found[here], 1, 2).astype(np.float16))
    examples.target.append(target[here].astype(np.float32))
    examples.weight.append(np.full(len(picked), 1 / np.mean(target**2), np.float32))


def vectors(
    truth: Array,
    q: Array,
    patches: Array,
    pilot: Array,
    confidence: Array | None,
    noise: Array,
    *,
    body: bool,
) -> tuple[Array, Array]:
    """Return basis vectors `(frames, joints, 3, BASES)` and what their sum should be, `(frames, joints, 3)`."""
    about = normalize(pilot.astype(np.float64))
    scale = noise[:, None]
    clean = developed_about(about, about)[1] / scale

    def beside(estimate: Array) -> Array:
        return 2 * log_short(between(about, normalize(estimate.astype(np.float64)))) / scale

    rest = beside(q) if confidence is None else confidence[..., None] * beside(q)
    axes = gains.joint_axes(clean)
    along = gains.along_body(clean, rest) if body else np.zeros_like(rest)
    sources = [gains.turned(x, axes) for x in (clean, rest, beside(patches), along)]
    return gains.basis(sources[0], sources[1], sources[2:]), gains.turned(beside(truth), axes)


def noisy(truth: Array, sigma: float, kind: str, rng: np.random.Generator) -> Array:
    """Return a clip with noise of a kind."""
    shape = (*truth.shape[:2], 3)
    level = np.ones(len(truth))
    noise = rng.standard_normal(shape)
    if kind == "ar":
        correlation = rng.uniform(*CORRELATION)
        for t in range(1, len(noise)):
            noise[t] = correlation * noise[t - 1] + math.sqrt(1 - correlation**2) * noise[t]
    elif kind == "student":
        noise = rng.standard_t(3, shape) / math.sqrt(3)
    elif kind == "unsteady":
        stretches = rng.choice([2, 0.25], -(-len(truth) // 100))
        level = np.repeat(stretches, 100)[: len(truth)]
    elif kind == "bursts":
        level *= 0.3
        for begin in np.flatnonzero(rng.random(len(truth)) < 0.01):
            level[begin : begin + 20] = 1.8
    elif kind == "axis":
        noise *= rng.permutation([0.3, 0.3, 3])
    moved = qf.multiply(truth, qf.exp(sigma * level[:, None, None] * noise / 2))
    return np.ascontiguousarray(moved, dtype=truth.dtype)


def modelled(q: Array, truth: Array) -> tuple[Array, Array, Array | None, Array]:
    """Return a clip as smoothing sees it after its noise is measured, the truth of that, its confidence and its level."""
    model = measure(q)
    span = Span(slice(0, len(q)), np.arange(q.shape[1]))
    white = whitened(q, None, assumed_level(model), span, model)
    if white.developed is not None:
        reference, _, path, flat = white.developed
        vectors = developed_about(reference, normalize(truth.astype(np.float64)))[2]
        beside = _core.whiten(*developed_about(reference, reference)[:2], vectors, *white.shape)[2]
        truth = multiply(path, exp((beside - flat) / 2)).astype(truth.dtype)
    return white.rotations, truth, white.confidence, white.noise
