"""Filters: non-local pose means beside other ways to compute them."""

import agreement
import numba
import numpy as np
import quatfilt as qf
from clips import JOINTS, NOISE, rotations
from memory import peak_memory
from numba_loop import direct_means, rotations_from_chart, vectors_in_chart
from report import Results
from scaling import scaling
from timing import Contender, all_threads, ours, race, reference

FRAMES = 100_000
SEARCH, PATCH = 10, 5

REFERENCE_FRAMES = 4_000
NUMBA_FRAMES = 20_000

_SCALED = "* on {frames:,} frames, multiplied: its time is linear in frames."


def run(repetitions: int) -> Results:
    """Measure."""
    results = Results()
    for dtype in (np.float32, np.float64):
        _beside_peers(results, dtype, repetitions)
    _options(results, repetitions)
    scaling(results, repetitions)
    peak_memory(results, FRAMES)
    return results


def _beside_peers(results: Results, dtype: type[np.floating], repetitions: int) -> None:
    q = rotations(FRAMES, dtype=dtype)
    part = q[:REFERENCE_FRAMES].copy()
    means, padded = vectors_in_chart(q, SEARCH + PATCH)
    short = padded[: NUMBA_FRAMES + 2 * (SEARCH + PATCH)].copy()

    def call() -> object:
        return qf.nonlocal_pose_means(q, search_radius=SEARCH, patch_radius=PATCH, bandwidth=NOISE)

    def call_part() -> object:
        return qf.nonlocal_pose_means(part, search_radius=SEARCH, patch_radius=PATCH, bandwidth=NOISE)

    loop = reference(call_part, scale=FRAMES / REFERENCE_FRAMES)
    agreement.angles(
        "NLPM: Numba", call(), rotations_from_chart(means, direct_means(padded, SEARCH, PATCH, NOISE))
    )
    agreement.angles("NLPM: reference", call_part(), loop.call())

    threads = all_threads()
    whole = Contender(
        f"Numba, {threads} threads",
        lambda: direct_means(padded, SEARCH, PATCH, NOISE),
        lambda: numba.set_num_threads(threads),
    )
    alone = Contender(
        "Numba, 1 thread",
        lambda: direct_means(short, SEARCH, PATCH, NOISE),
        lambda: numba.set_num_threads(1),
        scale=FRAMES / NUMBA_FRAMES,
    )
    own = ours(call)
    table = results.table(
        f"Non-local pose means, {JOINTS} joints × {FRAMES:,} frames, window 21, patch 11, {np.dtype(dtype)}",
        race([*own, alone, whole, loop], repetitions),
        rotations=FRAMES * JOINTS,
        beside=[contender.name for contender in own],
        notes=[
            (
                f'`chart="mean"`, `bandwidth={NOISE}`. Numba: a direct loop (parallel, fastmath) on ready-made '
                f"{np.dtype(dtype)} rotation vectors. "
                f"* on {REFERENCE_FRAMES:,} (reference) and {NUMBA_FRAMES:,} frames (Numba, 1 thread), multiplied: "
                "their times are linear in frames."
            )
        ],
    )
    # Apart: after a call of seconds that frees much memory, whoever comes next finds other pages and clocks.
    floor = results.table(
        f"Non-local pose means beside numpy.copy, the same clip, {np.dtype(dtype)}",
        race([*own, Contender("numpy.copy", q.copy)], 4 * repetitions),
        rotations=FRAMES * JOINTS,
        beside=[contender.name for contender in own] + ["numpy.copy"],
        notes=[f"{4 * repetitions} repetitions."],
    )
    if dtype is not np.float32:
        return
    best = own[-1].name
    time = table.median(best)
    results.aim(f"NLPM, float32: {whole.name} ÷ {best}", table.median(whole.name) / time, at_least=15)
    results.aim(f"NLPM, float32: NumPy reference ÷ {best}", table.median(loop.name) / time, at_least=60)
    time = floor.median(best)
    results.aim(f"NLPM, float32: {best} ÷ numpy.copy", time / floor.median("numpy.copy"), at_most=6)
    if threads > 1:
        gain = floor.median(own[0].name) / time
        results.aim(f"NLPM, float32: 1 thread ÷ {threads} threads", gain, at_least=1.8)


def _options(results: Results, repetitions: int) -> None:
    """Measure what options cost, with all threads, beside the defaults with a fixed bandwidth."""
    q = rotations(FRAMES)
    part = q[:REFERENCE_FRAMES].copy()
    fixed = "bandwidth fixed"
    options = {
        fixed: {"bandwidth": NOISE},
        'bandwidth="auto"': {},
        'chart="local"': {"bandwidth": NOISE, "chart": "local"},
        'weights="joint"': {"bandwidth": NOISE, "weights": "joint"},
        "neighbors=8": {"bandwidth": NOISE, "neighbors": 8},
    }
    contenders, references = [], []
    for name, chosen in options.items():
        slow = reference(
            lambda chosen=chosen: qf.nonlocal_pose_means(part, **chosen), scale=FRAMES / REFERENCE_FRAMES
        )
        if name != "neighbors=8":  # of patches that are equally near within rounding either may be kept
            agreement.angles(f"NLPM, {name}: reference", qf.nonlocal_pose_means(part, **chosen), slow.call())
        contenders.append(Contender(name, lambda chosen=chosen: qf.nonlocal_pose_means(q, **chosen)))
        if name in {'chart="local"', 'weights="joint"'}:
            references.append(Contender(f"{name}, {slow.name}", slow.call, scale=slow.scale))
    table = results.table(
        f"Non-local pose means by option, {JOINTS} joints × {FRAMES:,} frames, float32, {all_threads()} threads",
        [
            *race([*contenders, Contender("numpy.copy", q.copy)], 2 * repetitions),
            *race(references, repetitions),
        ],
        rotations=FRAMES * JOINTS,
        beside=[fixed, "numpy.copy"],
        notes=[
            f"{2 * repetitions} repetitions; the references apart. {_SCALED.format(frames=REFERENCE_FRAMES)}"
        ],
    )
    cost = table.median('bandwidth="auto"') / table.median(fixed)
    results.aim('NLPM, float32: bandwidth="auto" ÷ fixed', cost, at_most=1.5)
