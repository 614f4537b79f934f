"""The command line as a process of its own."""

import os
import subprocess
import sys

from patience import PATIENCE

COMMAND = [sys.executable, "-m", "quatfilt"]


def run(*arguments, cwd=None, status=0, **environment):
    """Run the command and return what it wrote; a status that was not expected fails with what it said."""
    done = subprocess.run(
        [*COMMAND, *map(str, arguments)],
        capture_output=True,
        text=True,
        encoding="utf-8",
        cwd=cwd,
        env={**os.environ, "PYTHONIOENCODING": "utf-8", **environment},
        check=False,
        timeout=PATIENCE,
    )
    assert done.returncode == status, done.stderr
    if status == 0:
        assert done.stderr == ""
    return done


def refused(*arguments, cwd=None):
    """Run the command on bad input and return the line it says."""
    done = run(*arguments, cwd=cwd, status=2)
    assert done.stdout == ""
    lines = done.stderr.splitlines()
    assert len(lines) == 1, done.stderr
    assert lines[0].startswith("quatfilt: ")
    return lines[0].removeprefix("quatfilt: ")
