"""Ctrl-C ends a long call, with a KeyboardInterrupt."""

import signal
import subprocess
import sys
import time

import pytest

LONG_CALL = """
import numpy as np, quatfilt as qf
from quatfilt import _core
q = qf.add_gaussian_noise(np.tile([1.0, 0, 0, 0], ({frames}, {joints}, 1)), sigma=0.05, rng=0)
print("ready", flush=True)
{call}
print("ended", flush=True)
"""

CALLS = {
    "pose means": (200_000, 20, "qf.nonlocal_pose_means(q, search_radius=None, bandwidth=0.05)"),
    "pose means, local chart": (
        200_000,
        20,
        'qf.nonlocal_pose_means(q, search_radius=None, bandwidth=0.05, chart="local", neighbors=8)',
    ),
    "patches": (400_000, 20, "qf.patch_neighbors(q)"),
    "graph of poses": (200_000, 20, "qf.neighbor_graph(q.reshape(len(q), -1), [0, len(q)])"),
    "spikes of wide radius": (20_000, 20, "qf.despike(q, radius=1000, smallest=0.0)"),
    "axes of a wide body": (4_000, 400, "_core.smooth_body(q, q, None, np.full(400, 0.05))"),
}
"""Frames, joints, and minutes of work."""

HANGING = 30
"""Seconds after which a process counts as one that does not listen; it ends within a fraction of one."""


@pytest.mark.skipif(
    sys.platform == "win32", reason="not on this platform: there is no SIGINT for one process"
)
@pytest.mark.parametrize("name", CALLS)
def test_a_long_call_ends_at_ctrl_c(name):
    frames, joints, call = CALLS[name]
    program = LONG_CALL.format(frames=frames, joints=joints, call=call)
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
