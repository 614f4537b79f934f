"""A forked child computes, although the threads of its parent's pool do not exist in it."""

import multiprocessing
import os
import signal
import time
import warnings

import numpy as np
import pytest
import quatfilt as qf
from contract.public_calls import CALLS, samples
from patience import PATIENCE

pytestmark = pytest.mark.skipif(not hasattr(os, "fork"), reason="not on this platform: there is no fork")


@pytest.fixture(autouse=True)
def two_threads():
    qf.set_num_threads(2)
    with warnings.catch_warnings():
        # Python warns of what is tested here: a fork while there are threads.
        warnings.simplefilter("ignore", DeprecationWarning)
        yield
    qf.set_num_threads(None)


def digest(arguments):
    return b"".join(np.asarray(call(*arguments)).tobytes() for call in CALLS.values())


def status_of(child):
    """Wait for `child` and return its exit status; kill it where it hangs."""
    deadline = time.monotonic() + PATIENCE
    while time.monotonic() < deadline:
        ended, status = os.waitpid(child, os.WNOHANG)
        if ended:
            return os.waitstatus_to_exitcode(status)
        time.sleep(0.01)
    os.kill(child, signal.SIGKILL)
    os.waitpid(child, 0)
    pytest.fail(f"the child did not end within {PATIENCE} s")


def forked(work):
    """Run `work` in a forked child and return the exit status: 0 where it returns True."""
    child = os.fork()
    if child == 0:
        status = 2
        try:
            status = 0 if work() else 1
        finally:
            os._exit(status)
    return status_of(child)


def test_a_child_computes_after_its_parent_did():
    arguments = samples(np.float32)
    expected = digest(arguments)
    assert forked(lambda: digest(arguments) == expected) == 0
    assert digest(arguments) == expected


def test_a_grandchild_computes():
    arguments = samples(np.float32)
    expected = digest(arguments)
    assert (
        forked(lambda: digest(arguments) == expected and forked(lambda: digest(arguments) == expected) == 0)
        == 0
    )


def test_the_number_of_threads_can_change_in_a_child():
    arguments = samples(np.float32)
    expected = digest(arguments)

    def work():
        qf.set_num_threads(3)
        return digest(arguments) == expected

    assert forked(work) == 0


def test_a_multiprocessing_pool_computes():
    arguments = samples(np.float32)
    expected = digest(arguments)
    with multiprocessing.get_context("fork").Pool(2) as pool:
        results = pool.map_async(digest, [arguments] * 3).get(timeout=PATIENCE)
    assert results == [expected] * 3
