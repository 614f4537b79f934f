"""Ctrl-C ends a long call, with a KeyboardInterrupt."""

import signal
import subprocess
import sys

import pytest
from patience import PATIENCE

UNHEARD = 30
"""Seconds of processor time after which a call that does not listen is killed; it ends within a fraction of one."""

LONG_CALL = f"""
import os, resource, signal, threading, time
import numpy as np, quatfilt as qf
from quatfilt import _core
q = qf.add_gaussian_noise(np.tile([1.0, 0, 0, 0], ({{frames}}, {{joints}}, 1)), sigma=0.05, rng=0)

def interrupt(begun=time.process_time()):
    while time.process_time() < begun + 1:  # by then it is within the core
        time.sleep(0.01)
    limit = int(time.process_time()) + {UNHEARD}
    resource.setrlimit(resource.RLIMIT_CPU, (limit, limit))
    os.kill(os.getpid(), signal.SIGINT)

threading.Thread(target=interrupt, daemon=True).start()
{{call}}
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
    "spikes of wide radius": (20_000, 20, "qf.despike(q, radius=1000, threshold=1.0, smallest=0.0)"),
    "axes of a body": (120_000, 100, "_core.smooth_body(q, q, None, np.full(100, 0.05))"),
}
"""Frames, joints, and several seconds of work at least."""


@pytest.mark.skipif(
    sys.platform == "win32", reason="not on this platform: there is no SIGINT for one process"
)
@pytest.mark.usefixtures("ctrl_c")
@pytest.mark.parametrize("name", CALLS)
def test_a_long_call_ends_at_ctrl_c(name):
    frames, joints, call = CALLS[name]
    program = LONG_CALL.format(frames=frames, joints=joints, call=call)
    child = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, timeout=PATIENCE, check=False
    )
    assert child.returncode == -signal.SIGINT, f"a call that does not listen is killed after {UNHEARD} s"
    assert child.stdout == ""
    assert child.stderr.rstrip().endswith("KeyboardInterrupt")
