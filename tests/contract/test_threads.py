"""The core leaves the interpreter to others while it computes, and the number of threads does not change results."""

import sys
import threading
import time

import numpy as np
import pytest
import quatfilt as qf
from contract.public_calls import CALLS, samples
from patience import PATIENCE
from quatfilt import _core


@pytest.fixture(autouse=True)
def default_threads():
    yield
    qf.set_num_threads(None)


def test_other_python_threads_run_meanwhile():
    # Nothing takes the interpreter from this thread but a kernel that lets go of it.
    rotations = np.ones((400_000, 4))
    ticks = 0
    running, stop = threading.Event(), threading.Event()

    def tick():
        nonlocal ticks
        while not stop.is_set():
            ticks += 1
            running.set()
            time.sleep(0)

    interval = sys.getswitchinterval()
    sys.setswitchinterval(2 * PATIENCE)
    other = threading.Thread(target=tick)
    try:
        other.start()
        running.wait()
        deadline, before = time.monotonic() + PATIENCE, ticks
        while ticks == before and time.monotonic() < deadline:
            _core.log(rotations)
        assert ticks > before, "no other thread ran meanwhile"
    finally:
        sys.setswitchinterval(interval)
        stop.set()
        other.join()


def test_calls_from_many_threads_do_not_disturb_each_other():
    arguments = samples(np.float64)
    expected = {name: call(*arguments) for name, call in CALLS.items()}
    different = []

    def work():
        for name, call in CALLS.items():
            if not np.array_equal(call(*arguments), expected[name], equal_nan=True):
                different.append(name)

    threads = [threading.Thread(target=work) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert different == []


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("name", CALLS)
def test_the_number_of_threads_does_not_change_results(name, dtype):
    arguments = samples(dtype)
    results = []
    for threads in (1, 2, 5):
        qf.set_num_threads(threads)
        results.append(np.asarray(CALLS[name](*arguments)).tobytes())
    assert results[0] == results[1] == results[2]


def test_number_of_threads():
    default = qf.get_num_threads()
    assert default >= 1
    qf.set_num_threads(3)
    assert qf.get_num_threads() == 3
    qf.set_num_threads(None)
    assert qf.get_num_threads() == default


@pytest.mark.parametrize(
    ("n", "error", "message"),
    [
        (0, ValueError, "n: expected at least 1, got 0"),
        (-2, ValueError, "n: expected at least 1, got -2"),
        (1.0, TypeError, "n: expected an integer or None, got float"),
        ("2", TypeError, "n: expected an integer or None, got str"),
        (True, TypeError, "n: expected an integer or None, got bool"),
    ],
)
def test_wrong_numbers_of_threads(n, error, message):
    before = qf.get_num_threads()
    with pytest.raises(error) as caught:
        qf.set_num_threads(n)
    assert str(caught.value) == message
    assert qf.get_num_threads() == before
