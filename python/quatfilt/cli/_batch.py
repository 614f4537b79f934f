"""Many files, cleaned in several processes."""

import contextlib
import os
import signal
import sys
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from multiprocessing import active_children, get_context
from multiprocessing.process import BaseProcess
from pathlib import Path
from typing import Any, Literal

from quatfilt import _backend
from quatfilt.cli import _cleaning, _errors

_DIED = "the process that cleaned it was killed; the memory may be too small: try fewer --workers"


@dataclass(frozen=True)
class Task:
    """A file and the path of its clean copy."""

    source: Path
    target: Path


def done(
    tasks: Sequence[Task], how: _cleaning.How, *, force: bool, workers: int, threads: int
) -> Iterator[dict[str, Any]]:
    """Clean files, and give the record of each as soon as there is one.

    Parameters
    ----------
    tasks : sequence of Task
        The files.
    how : How
        What is done to each.
    force : bool
        Whether files are cleaned whose output is there.
    workers, threads : int
        Processes, and threads of each; one process is this one.

    Yields
    ------
    dict
        `status` ("written", "kept" or "failed"), `input`, `output`; `error` where it failed, else what there is to say.
    """
    waiting = []
    for task in tasks:
        # A file that would be cleaned in place is not one that was cleaned before: it fails, as with `force`.
        if task.target.exists() and not force and not task.target.samefile(task.source):
            yield _record(task, "kept")
        else:
            waiting.append(task)
    if workers == 1 or len(waiting) < 2:
        for task in waiting:
            yield _clean(task, how)
        return
    # Spawned, because the threads of this process would not survive a fork.
    others = set(active_children())
    with ProcessPoolExecutor(
        workers, mp_context=get_context("spawn"), initializer=_begin, initargs=(threads,)
    ) as pool:
        try:
            with _held_back():
                running = {pool.submit(_clean_elsewhere, task, how): task for task in waiting}
            for future in as_completed(running):
                try:
                    yield future.result()
                except BrokenProcessPool:
                    task = running[future]
                    yield _record(task, "failed", error=f"{task.source}: {_DIED}")
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            _interrupt(set(active_children()) - others)
            raise


@contextlib.contextmanager
def _held_back() -> Iterator[None]:
    """Start processes to which Ctrl-C comes when they ask for it: before, they would end with a traceback."""
    if sys.platform == "win32":
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _interrupt(processes: set[BaseProcess]) -> None:
    """Pass Ctrl-C on, in case it came to this process alone."""
    for process in processes:
        if sys.platform != "win32" and process.pid is not None and process.is_alive():
            os.kill(process.pid, signal.SIGINT)


class _Listener:
    """Hears Ctrl-C in a process of the pool.

    The pool gives processes more files than they are at work on, and does not take them back: after Ctrl-C, each of them
    ends at once.
    """

    at_work = False
    interrupted = False

    def __call__(self, *_: object) -> None:
        """End the work. A second Ctrl-C does not disturb the removal of temporary files."""
        again, self.interrupted = self.interrupted, True
        if self.at_work and not again:
            raise KeyboardInterrupt

    def __enter__(self) -> None:
        self.at_work = True
        if self.interrupted:
            raise KeyboardInterrupt

    def __exit__(self, *_: object) -> None:
        self.at_work = False


_listener = _Listener()


def _begin(threads: int) -> None:
    """Prepare a process of the pool."""
    if signal.getsignal(signal.SIGINT) != signal.SIG_IGN:  # it is in what a shell starts in the background
        signal.signal(signal.SIGINT, _listener)
    if sys.platform != "win32":
        signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})
    _backend.set_num_threads(threads)


def _clean_elsewhere(task: Task, how: _cleaning.How) -> dict[str, Any]:
    """Clean a file in a process of the pool, which hears Ctrl-C while it is at work: temporary files are then removed."""
    with _listener:
        return _clean(task, how)


def _clean(task: Task, how: _cleaning.How) -> dict[str, Any]:
    try:
        motion = _cleaning.read(task.source, task.target, how)
        record = _cleaning.clean(task.source, task.target, motion, how).record
    except Exception as error:  # noqa: BLE001 - one file must not stop the others
        message, _ = _errors.explained(error)
        if str(task.source) not in message:
            message = f"{task.source}: {message}"
        return _record(task, "failed", error=message)
    return {**_record(task, "written"), **record}


def _record(task: Task, status: Literal["written", "kept", "failed"], **more: Any) -> dict[str, Any]:
    return {"status": status, "input": str(task.source), "output": str(task.target), **more}
