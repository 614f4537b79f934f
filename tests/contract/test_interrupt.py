"""Ctrl-C ends a long call, with a KeyboardInterrupt."""

import signal
import subprocess
import sys
import time

import pytest

LONG_CALL = """
import numpy as np, quatfilt as qf
q = qf.add_gaussian_noise(np.tile([1.0, 0, 0, 0], (200_000, 20, 1)), sigma=0.05, rng=0)
print("ready", flush=True)
qf.nonlocal_pose_means(q, search_radius=None, bandwidth=0.05, chart={chart!r}, neighbors={neighbors})
print("ended", flush=True)
"""
"""Minutes of work."""

HANGING = 30
"""Seconds after which a process counts as one that does not listen; it ends within a fraction of one."""


@pytest.mark.skipif(
    sys.platform == "win32", reason="not on this platform: there is no SIGINT for one process"
)
@pytest.mark.parametrize(("chart", "neighbors"), [("mean", None), ("local", 8)])
def test_a_long_call_ends_at_ctrl_c(chart, neighbors):
    program = LONG_CALL.format(chart=chart, neighbors=neighbors)
    with subprocess.Popen(
        [sys.executable, "-c", program], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as child:
        try:
            assert child.stdout.readline() == "ready\n"
            time.sleep(0.5)  # until it is within the core
            child.send_signal(signal.SIGINT)
            out, errors = child.communicate(timeout=HANGING)
        finally:
            child.kill()
    assert out == ""
    assert errors.rstrip().endswith("KeyboardInterrupt")
    assert child.returncode != 0
