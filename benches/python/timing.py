"""Times of whole calls, taken in turns: A B C A B C …, so that a drift of the machine meets all alike."""

import gc
import statistics
import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass

import quatfilt as qf

Call = Callable[[], object]


@dataclass(frozen=True)
class Contender:
    """Something that is timed."""

    name: str
    call: Call
    before: Call | None = None
    """Run before each call, untimed: sets the number of threads."""
    scale: float = 1.0
    """What part of the work stands for the whole: its times are multiplied by this."""


@dataclass(frozen=True)
class Times:
    """What a contender took."""

    name: str
    seconds: list[float]
    """For the whole work, one number per repetition."""
    scale: float

    @property
    def median(self) -> float:
        """Seconds."""
        return statistics.median(self.seconds)

    @property
    def least(self) -> float:
        """Seconds."""
        return min(self.seconds)


def all_threads() -> int:
    """Return how many threads the core uses unless told otherwise."""
    qf.set_num_threads(None)
    return qf.get_num_threads()


def ours(call: Call, name: str = "quatfilt") -> list[Contender]:
    """Return a call of the package with one thread and, where there are more, with all."""
    contenders = [Contender(f"{name}, 1 thread", call, lambda: qf.set_num_threads(1))]
    if (threads := all_threads()) > 1:
        contenders.append(Contender(f"{name}, {threads} threads", call, lambda: qf.set_num_threads(None)))
    return contenders


def reference(call: Call, *, scale: float = 1.0) -> Contender:
    """Return a call of the package with its NumPy backend."""

    def run() -> object:
        with qf.use_backend("numpy"):
            return call()

    return Contender("NumPy reference", run, scale=scale)


def race(contenders: Iterable[Contender], repetitions: int) -> list[Times]:
    """Time contenders in turns, after a round that warms up caches, thread pools and compilers."""
    contenders = list(contenders)
    seconds: list[list[float]] = [[] for _ in contenders]
    gc.collect()
    gc.disable()
    try:
        for repetition in range(repetitions + 1):
            for contender, taken in zip(contenders, seconds, strict=True):
                if contender.before is not None:
                    contender.before()
                start = time.perf_counter()
                result = contender.call()
                end = time.perf_counter()
                del result  # to give memory back is not part of the call
                if repetition > 0:
                    taken.append((end - start) * contender.scale)
    finally:
        gc.enable()
        qf.set_num_threads(None)
    return [
        Times(contender.name, taken, contender.scale)
        for contender, taken in zip(contenders, seconds, strict=True)
    ]
