"""Pieces of work in several processes, one thread each."""

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from multiprocessing import get_context
from typing import Any, TypeVar

from quatfilt._backend import set_num_threads

T = TypeVar("T")


def computed(
    work: Callable[..., T], pieces: Sequence[tuple[Any, ...]], *, workers: int, sizes: Sequence[float]
) -> Iterator[tuple[int, T]]:
    """Call a function with each of the tuples; yield numbers and results as they come.

    Parameters
    ----------
    work : callable
        A function of a module, so that processes find it.
    pieces : sequence of tuple
        Its arguments.
    workers : int
        Processes; 1 computes here.
    sizes : sequence of float
        How long each piece takes, in any unit: the longest are started first.

    Yields
    ------
    int
        Which piece.
    object
        What the function returned.
    """
    if workers == 1:
        for number, piece in enumerate(pieces):
            yield number, work(*piece)
        return
    # Spawned, because the threads of this process would not survive a fork.
    with ProcessPoolExecutor(
        workers, mp_context=get_context("spawn"), initializer=set_num_threads, initargs=(1,)
    ) as pool:
        order = sorted(range(len(pieces)), key=lambda number: -sizes[number])
        numbers = {pool.submit(work, *pieces[number]): number for number in order}
        try:
            for future in as_completed(numbers):
                yield numbers[future], future.result()
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise


__all__ = ["computed"]
