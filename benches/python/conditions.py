"""What a run was made on."""

import importlib.metadata
import platform
import subprocess
from pathlib import Path

import quatfilt as qf
from timing import all_threads

_PACKAGES = (
    "quatfilt",
    "numpy",
    "scipy",
    "numba",
    "numpy-quaternion",
    "quaternionic",
    "pybvh",
    "filterpy",
    "faiss-cpu",
)


def conditions(repetitions: int) -> dict[str, str]:
    """Return the conditions by name."""
    versions = [f"{name} {importlib.metadata.version(name)}" for name in _PACKAGES]
    return {
        "machine": f"{all_threads()} cores, {platform.machine()}, {_processor()}",
        "SIMD level": qf.simd_level(),
        "system": f"{platform.system()}, Python {platform.python_version()}",
        "packages": ", ".join(versions),
        "commit": _commit(),
        "times": f"median and least of {repetitions} repetitions, in turns; the first round is not counted",
    }


def _processor() -> str:
    information = Path("/proc/cpuinfo")
    if information.exists():
        for line in information.read_text(encoding="utf-8").splitlines():
            if line.startswith("model name"):
                return line.partition(":")[2].strip()
    return platform.processor() or "unknown processor"


def _commit() -> str:
    try:
        told = subprocess.run(
            ["git", "describe", "--always", "--dirty"],  # noqa: S607 - whichever git there is
            cwd=Path(__file__).parent,
            capture_output=True,
            text=True,
            check=True,
        )
    except (OSError, subprocess.CalledProcessError):
        return "unknown"
    return told.stdout.strip()
