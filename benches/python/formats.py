"""Formats: BVH files in and out."""

import tempfile
from pathlib import Path

import agreement
import numpy as np
import pybvh
import quatfilt as qf
from clips import JOINTS, rotation_vectors
from report import Results
from timing import Contender, ours, race

READ_BYTES = 100_000_000
SHORT_BYTES = 20_000_000

_BLOCK = 2_000
"""Frames that are made; the file repeats them."""


def run(repetitions: int) -> Results:
    """Measure."""
    results = Results()
    with tempfile.TemporaryDirectory() as folder:
        _reading(results, Path(folder), repetitions)
        _writing(results, Path(folder) / "write.bvh", repetitions)
    return results


def _hierarchy(joint: int = 0, indent: str = "") -> str:
    """Return a root with limbs of six joints."""
    children = (
        range(1, JOINTS, 6)
        if joint == 0
        else range(joint + 1, joint + 1 + (joint % 6 != 0 and joint + 1 < JOINTS))
    )
    positions = "Xposition Yposition Zposition " if joint == 0 else ""
    inner = indent + "\t"
    lines = [
        f"{indent}{'JOINT' if joint else 'ROOT'} joint{joint}",
        f"{indent}{{",
        f"{inner}OFFSET 0.000000 10.000000 0.000000",
        f"{inner}CHANNELS {3 if joint else 6} {positions}Zrotation Yrotation Xrotation",
        *(_hierarchy(child, inner) for child in children),
    ]
    if not children:
        lines += [
            f"{inner}End Site",
            f"{inner}{{",
            f"{inner}\tOFFSET 0.000000 1.000000 0.000000",
            f"{inner}}}",
        ]
    return "\n".join([*lines, f"{indent}}}"])


def _make(path: Path, size: int) -> int:
    """Write a BVH file of about `size` bytes; return its number of frames."""
    values = np.degrees(rotation_vectors(_BLOCK, JOINTS + 1).reshape(_BLOCK, -1).astype(np.float64))
    block = "".join(" ".join(f"{x:.6f}" for x in row) + "\n" for row in values)
    repeats = round(size / len(block))
    frames = repeats * _BLOCK
    head = f"HIERARCHY\n{_hierarchy()}\nMOTION\nFrames: {frames}\nFrame Time: 0.008333333\n"
    path.write_text(head + block * repeats, encoding="ascii")
    return frames


def _reading(results: Results, folder: Path, repetitions: int) -> None:
    path, short = folder / "read.bvh", folder / "short.bvh"
    frames, short_frames = _make(path, READ_BYTES), _make(short, SHORT_BYTES)
    with path.open(encoding="ascii") as file:
        head = next(number for number, line in enumerate(file, 1) if line.startswith("Frame Time"))

    def pybvh_quaternions() -> object:
        return pybvh.read_bvh_file(short, world_up="+y").to_quat()

    motion = qf.read_motion(short, first_frame="keep")
    translation, rotations = pybvh_quaternions()
    agreement.angles("read_motion: pybvh", motion.rotations, rotations)
    agreement.numbers("read_motion: pybvh, root", motion.translation, translation)
    del motion, translation, rotations

    own = ours(lambda: qf.read_motion(path, first_frame="keep"))
    contenders = [
        *own,
        Contender("pybvh, to Euler angles", lambda: pybvh.read_bvh_file(path, world_up="+y")),
        Contender("pybvh, to quaternions", pybvh_quaternions, scale=frames / short_frames),
        Contender("numpy.loadtxt of the values", lambda: np.loadtxt(path, skiprows=head)),
    ]
    table = results.table(
        f"Reading BVH, {path.stat().st_size / 1e6:.0f} MB, {JOINTS} joints × {frames:,} frames",
        race(contenders, repetitions),
        rotations=frames * JOINTS,
        beside=[contender.name for contender in own],
        notes=[
            (
                "quatfilt reads to quaternions. pybvh stops at Euler angles unless asked for quaternions. "
                f"* on {short_frames:,} frames, multiplied."
            )
        ],
    )
    for contender in own:
        gain = table.median("pybvh, to Euler angles") / table.median(contender.name)
        results.aim(f"reading BVH: pybvh, to Euler angles ÷ {contender.name}", gain, at_least=2)


def _writing(results: Results, path: Path, repetitions: int) -> None:
    frames = _make(path, SHORT_BYTES)
    motion = qf.read_motion(path, first_frame="keep")
    moved = motion.replace(rotations=qf.add_gaussian_noise(motion.rotations, sigma=0.01, rng=0))
    theirs = pybvh.read_bvh_file(path, world_up="+y")
    theirs.from_quat(moved.translation, moved.rotations, inplace=True)
    euler = theirs.copy()
    our_path, their_path = path.with_name("ours.bvh"), path.with_name("theirs.bvh")

    def pybvh_quaternions() -> None:
        theirs.from_quat(moved.translation, moved.rotations, inplace=True)
        pybvh.write_bvh_file(theirs, their_path)

    qf.write_motion(our_path, moved)
    pybvh_quaternions()
    back = [qf.read_motion(written, first_frame="keep").rotations for written in (our_path, their_path)]
    agreement.angles("write_motion", moved.rotations, back[0])
    # Six decimals of a degree.
    agreement.angles("write_motion: pybvh", *(rotations.astype(np.float32) for rotations in back))

    own = ours(lambda: qf.write_motion(our_path, moved))
    contenders = [
        *own,
        *ours(lambda: qf.write_motion(our_path, motion), "quatfilt, unchanged"),
        Contender("pybvh, from Euler angles", lambda: pybvh.write_bvh_file(euler, their_path)),
        Contender("pybvh, from quaternions", pybvh_quaternions),
    ]
    results.table(
        f"Writing BVH, {JOINTS} joints × {frames:,} frames",
        race(contenders, repetitions),
        rotations=frames * JOINTS,
        beside=[contender.name for contender in own],
        notes=[
            (
                f"Unchanged: as it was read. Otherwise all rotations changed. quatfilt writes {our_path.stat().st_size / 1e6:.0f} MB, "
                f"pybvh {their_path.stat().st_size / 1e6:.0f} MB."
            )
        ],
    )
