"""Instructions per rotation of the kernels, counted by valgrind: `make bench-instructions`.

Counts do not depend on what else the machine does, so that they tell a change of a hundredth.
"""

import argparse
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

from report import Figures, show

ROTATIONS = 2_000 * 31
"""Frames times joints of the clip in instructions.rs."""

KERNELS = (
    *(
        f"{kernel}-{dtype}"
        for kernel in (
            "log",
            "exp",
            "multiply",
            "geodesic_distance",
            "mean",
            "noise_level",
            "nlpm",
            "nlpm_local",
            "nlpm_joint",
            "patch_neighbors",
        )
        for dtype in ("f32", "f64")
    ),
    "bvh-read",
    "bvh-write",
)


def count(program: Path, kernel: str, repetitions: int) -> int:
    """Return the instructions of a whole run."""
    command = [
        "valgrind",
        "--tool=callgrind",
        f"--callgrind-out-file={os.devnull}",
        program,
        kernel,
        str(repetitions),
    ]
    told = subprocess.run(command, capture_output=True, text=True, check=False)
    found = re.search(r"Collected : (\d+)", told.stderr)
    if told.returncode != 0 or found is None:
        raise SystemExit(f"{kernel}: valgrind failed\n{told.stderr}")
    return int(found[1])


def main() -> None:
    """Count, and print a table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("program", type=Path, help="the binary `instructions`")
    parser.add_argument("kernels", nargs="*", default=KERNELS, help="all by default")
    options = parser.parse_args()
    if shutil.which("valgrind") is None:
        sys.exit(
            "valgrind is not installed: it counts the instructions (Debian, Ubuntu, Fedora: package valgrind)"
        )
    # valgrind does not know AVX-512.
    os.environ.setdefault("QUATFILT_SIMD", "avx2")
    values = []
    for kernel in options.kernels:
        once, thrice = (count(options.program, kernel, repetitions) for repetitions in (1, 3))
        values.append([kernel, f"{(thrice - once) / 2 / ROTATIONS:.1f}"])
    title = f"Instructions per rotation, 1 thread, {os.environ['QUATFILT_SIMD']}"
    show(Figures(title, ["kernel", "instructions"], values))


if __name__ == "__main__":
    main()
