"""Waits are safety nets: how long something takes decides about no test."""

import errno
import os
import time

PATIENCE = 1200
"""Seconds after which something counts as hanging. It takes a few, and minutes on a machine that has much else to do."""


def until(condition, process):
    """Wait until something holds that a process does, and return it."""
    deadline = time.monotonic() + PATIENCE
    while not (found := condition()):
        assert process.poll() is None, f"it ended before, with status {process.returncode}"
        assert time.monotonic() < deadline, f"it did not happen within {PATIENCE} s"
        time.sleep(0.01)
    return found


def opened(pipe, process):
    """Wait until a process reads from a named pipe, and return what one writes to: the process waits until that is closed."""

    def writer():
        try:
            return os.open(pipe, os.O_WRONLY | os.O_NONBLOCK)
        except OSError as error:
            if error.errno != errno.ENXIO:  # nobody reads yet
                raise
            return None

    return until(writer, process)
