"""Many files, cleaned in several processes."""

import contextlib
import signal
import threading
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from multiprocessing import get_context
from pathlib import Path
from typing import Any, Literal

from quatfilt import _backend
from quatfilt.cli import _cleaning, _errors

_DIED = "the process that cleaned it came to an end, perhaps for want of memory"


@dataclass(frozen=True)
class Task:
    """A file, and where its clean copy goes."""

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
    with ProcessPoolExecutor(
        workers, mp_context=get_context("spawn"), initializer=_backend.set_num_threads, initargs=(threads,)
    ) as pool:
        with _deaf():
            running = {pool.submit(_clean_elsewhere, task, how): task for task in waiting}
        try:
            for future in as_completed(running):
                try:
                    yield future.result()
                except BrokenProcessPool:
                    task = running[future]
                    yield _record(task, "failed", error=f"{task.source}: {_DIED}")
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise


@contextlib.contextmanager
def _deaf() -> Iterator[None]:
    """Start processes that do not hear Ctrl-C: they would say so, each with a traceback."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)


def _clean_elsewhere(task: Task, how: _cleaning.How) -> dict[str, Any]:
    """Clean a file in a process of the pool, which hears Ctrl-C while it is at work: temporary files are then removed."""
    signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        return _clean(task, how)
    finally:
        signal.signal(signal.SIGINT, signal.SIG_IGN)


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
