"""The bits of the results are the same at every SIMD level."""

import os
import subprocess
import sys
from pathlib import Path

import pytest
import quatfilt as qf
from contract.public_calls import CALLS, NOT_KERNELS
from patience import PATIENCE

TESTS = Path(__file__).parents[1]

LEVELS = ["baseline", "avx2", "avx512"]


@pytest.fixture(scope="module")
def digests():
    """Return a function from a level to what a process at that level computes."""
    known = {}

    def at(level):
        if level not in known:
            variables = {key: value for key, value in os.environ.items() if key != "QUATFILT_SIMD"}
            if level is not None:
                variables["QUATFILT_SIMD"] = level
            folders = [str(TESTS), *filter(None, [os.environ.get("PYTHONPATH")])]
            variables["PYTHONPATH"] = os.pathsep.join(folders)
            ended = subprocess.run(
                [sys.executable, "-m", "contract.print_digests"],
                env=variables,
                capture_output=True,
                text=True,
                timeout=PATIENCE,
                check=False,
            )
            assert ended.returncode == 0, ended.stderr
            used, *lines = ended.stdout.splitlines()
            known[level] = used, lines
        return known[level]

    return at


def test_every_public_function_is_called():
    functions = {name for name in qf.__all__ if callable(getattr(qf, name))}
    assert functions == {name.partition(" ")[0] for name in CALLS} | NOT_KERNELS.keys()


@pytest.mark.parametrize("level", LEVELS)
def test_the_same_bits_at_every_level(digests, level):
    _, expected = digests(None)
    _, lines = digests(level)
    assert len(lines) == 2 * len(CALLS)
    assert lines == expected


@pytest.mark.parametrize("level", LEVELS)
def test_the_variable_lowers_the_level_and_never_raises_it(digests, level):
    highest, _ = digests(None)
    used, _ = digests(level)
    assert used == LEVELS[min(LEVELS.index(level), LEVELS.index(highest))]
