"""Peak memory of non-local pose means, each in a process of its own.

`python memory.py FILE CALL` prints by how many bytes the peak of the resident memory rose from before the input was
loaded. The kernel's own account (VmHWM) is read instead of `ru_maxrss`, which begins at the peak of the parent.
"""

import os
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
import quatfilt as qf
from clips import JOINTS, NOISE, rotations
from report import Figures, Results

_STATUS = Path("/proc/self/status")

_CALLS = {
    "NLPM, bandwidth fixed": lambda q: qf.nonlocal_pose_means(q, bandwidth=NOISE),
    'NLPM, bandwidth="auto"': qf.nonlocal_pose_means,
    'NLPM, chart="local"': lambda q: qf.nonlocal_pose_means(q, bandwidth=NOISE, chart="local"),
    "numpy.copy": np.copy,
}


def peak_memory(results: Results, frames: int) -> None:
    """Measure, where the system tells."""
    title = f"Peak memory, {JOINTS} joints × {frames:,} frames, all threads"
    columns = ["", "input, MB", "input, result and working memory, MB", "÷ input"]
    values = []
    if not _STATUS.exists():
        results.add(Figures(title, columns, [], ["Not measured: this system has no /proc."]))
        return
    with tempfile.TemporaryDirectory() as folder:
        for dtype in (np.float32, np.float64):
            path = Path(folder) / f"{np.dtype(dtype)}.npy"
            q = rotations(frames, dtype=dtype)
            np.save(path, q)
            for name in _CALLS:
                told = subprocess.run(
                    [sys.executable, __file__, path, name],
                    capture_output=True,
                    text=True,
                    check=True,
                    env=os.environ,
                )
                peak = int(told.stdout)
                values.append(
                    [
                        f"{name}, {q.dtype}",
                        f"{q.nbytes / 1e6:.1f}",
                        f"{peak / 1e6:.1f}",
                        f"{peak / q.nbytes:.2f}",
                    ]
                )
                if name != "numpy.copy" and dtype is np.float32:
                    results.aim(f"peak memory ÷ input: {name}, float32", peak / q.nbytes, at_most=4)
    results.add(Figures(title, columns, values))


def _peak() -> int:
    lines = _STATUS.read_text(encoding="utf-8").splitlines()
    return next(int(line.split()[1]) * 1024 for line in lines if line.startswith("VmHWM"))


def _measure(path: str, name: str) -> None:
    warm = rotations(2_000)
    _CALLS[name](warm)
    before = _peak()
    q = np.load(path)
    result = _CALLS[name](q)
    print(_peak() - before)
    del result


if __name__ == "__main__":
    _measure(*sys.argv[1:])
