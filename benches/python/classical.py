"""The classical filters beside SciPy and filterpy, the bilateral filter, and automatic smoothing."""

from collections.abc import Callable
from typing import Any

import agreement
import numpy as np
import peers
import quatfilt as qf
from clips import JOINTS, NOISE, Array, rotations
from report import Results
from timing import Contender, ours, race, reference

FRAMES = 100_000

REFERENCE_FRAMES = 1_000

AXIS = np.array([2.0, -1.0, 2.0]) / 3

PAPER = 75, 150
"""Joints and frames of the bilateral filter's paper, which took 300 ms for them."""

PAPER_SECONDS = 0.3

PASSES = 5

PROCESS_NOISE = 0.02
"""Radians per frame: how much the angular velocity changes by chance."""

CHANNEL_FRAMES = 1_000
"""Frames of the one channel that filterpy is timed on."""

Call = Callable[[Array], Array]

LINEAR: dict[str, Call] = {
    "gaussian": lambda q: qf.gaussian(q, sigma=peers.SIGMA),
    "butterworth": lambda q: qf.butterworth(q, cutoff=peers.CUTOFF, fps=peers.FPS),
    "savgol": lambda q: qf.savgol(q, window_length=peers.WINDOW, polyorder=peers.DEGREE),
}


def run(repetitions: int) -> Results:
    """Measure."""
    results = Results()
    for name, call in LINEAR.items():
        _beside_scipy(results, name, call, repetitions)
    _kalman(results, repetitions)
    _bilateral(results, repetitions)
    _paper(results, repetitions)
    _smooth(results, repetitions)
    return results


def _about_one_axis(frames: int) -> tuple[Array, Array]:
    """Angles `(frames,)` that stay within half a turn, and the rotations about one axis `(frames, 1, 4)`: there all agree."""
    time = np.arange(frames) / peers.FPS
    angle = np.sin(4 * time) + 0.3 * np.sin(23 * time) + np.random.default_rng(1).normal(0, NOISE, frames)
    return angle, qf.exp(0.5 * angle[:, None, None] * AXIS)


def _beside_scipy(results: Results, name: str, call: Call, repetitions: int) -> None:
    filtered = peers.SCIPY[name]
    _, swing = _about_one_axis(2_000)
    agreement.angles(f"{name}: SciPy", call(swing), peers.on_rotation_vectors(swing, filtered))
    q = rotations(FRAMES)
    part = q[:REFERENCE_FRAMES].copy()
    slow = reference(lambda: call(part), scale=FRAMES / REFERENCE_FRAMES)
    agreement.angles(f"{name}: reference", call(part), slow.call())
    vectors = 2 * qf.log(q).astype(np.float64).reshape(FRAMES, -1)
    whole = "SciPy on rotation vectors, there and back"
    own = ours(lambda: call(q))
    table = results.table(
        f"{name}, {JOINTS} joints × {FRAMES:,} frames, float32",
        race(
            [
                *own,
                Contender(whole, lambda: peers.on_rotation_vectors(q, filtered)),
                Contender("SciPy, the filter alone", lambda: filtered(vectors)),
                slow,
                Contender("numpy.copy", q.copy),
            ],
            repetitions,
        ),
        rotations=FRAMES * JOINTS,
        beside=[contender.name for contender in own],
        notes=[
            (
                f"σ = {peers.SIGMA:g} frames; {peers.CUTOFF:g} Hz of {peers.FPS:g}; window {peers.WINDOW}, degree {peers.DEGREE}. "
                "The filter alone: on ready-made float64 columns, with results left as vectors. "
                f"* on {REFERENCE_FRAMES:,} frames, multiplied."
            )
        ],
    )
    best = own[-1].name
    results.aim(f"{name}, float32: SciPy ÷ {best}", table.median(whole) / table.median(best), at_least=3)


def _kalman(results: Results, repetitions: int) -> None:
    """Measure the smoother beside filterpy, which takes one channel at a time; where this version has one."""
    if not hasattr(qf, "kalman"):
        return
    noises: dict[str, Any] = {"process_noise": PROCESS_NOISE, "measurement_noise": NOISE}
    angle, swing = _about_one_axis(CHANNEL_FRAMES)
    smooth = peers.kalman_smoother(angle, PROCESS_NOISE, NOISE)
    agreement.angles(
        "kalman: filterpy", qf.kalman(swing, **noises)[1:], qf.exp(0.5 * smooth[:, None, None] * AXIS)
    )
    q = rotations(FRAMES)
    channels = 3 * JOINTS
    own = ours(lambda: qf.kalman(q, **noises))
    peer = Contender(
        "filterpy, channel by channel",
        lambda: peers.kalman_smoother(angle, PROCESS_NOISE, NOISE),
        scale=channels * FRAMES / CHANNEL_FRAMES,
    )
    table = results.table(
        f"kalman with fixed noises, forth and back, {JOINTS} joints × {FRAMES:,} frames, float32",
        race([*own, peer, Contender("numpy.copy", q.copy)], repetitions),
        rotations=FRAMES * JOINTS,
        beside=[contender.name for contender in own],
        notes=[
            f"* on one channel of {CHANNEL_FRAMES:,} frames, multiplied: {channels} channels, linear in frames."
        ],
    )
    best = own[-1].name
    gain = table.median(peer.name) / table.median(best)
    results.aim(f"kalman, float32: filterpy ÷ {best}", gain, at_least=1000)


def _bilateral(results: Results, repetitions: int) -> None:
    q = rotations(FRAMES)
    part = q[:REFERENCE_FRAMES].copy()

    def call(q: Array = q) -> Array:
        return qf.bilateral(q, iterations=PASSES)

    slow = reference(lambda: call(part), scale=FRAMES / REFERENCE_FRAMES)
    agreement.angles("bilateral: reference", call(part), slow.call())
    own = ours(call)
    table = results.table(
        f"bilateral, {PASSES} passes, {JOINTS} joints × {FRAMES:,} frames, float32",
        race([*own, slow, Contender("numpy.copy", q.copy)], repetitions),
        rotations=FRAMES * JOINTS,
        beside=[contender.name for contender in own],
        notes=[f"* on {REFERENCE_FRAMES:,} frames, multiplied."],
    )
    best = own[-1].name
    gain = table.median(slow.name) / table.median(best)
    results.aim(f"bilateral, float32: NumPy reference ÷ {best}", gain, at_least=50)


def _paper(results: Results, repetitions: int) -> None:
    joints, frames = PAPER
    q = rotations(frames, joints)
    own = ours(lambda: qf.bilateral(q, iterations=PASSES))
    # A call takes less than a millisecond: many of them.
    table = results.table(
        f"bilateral, {PASSES} passes, {joints} joints × {frames} frames, float32",
        race([*own, Contender("numpy.copy", q.copy)], 20 * repetitions),
        rotations=frames * joints,
        beside=[contender.name for contender in own],
        notes=[f"{20 * repetitions} repetitions. The paper: {PAPER_SECONDS * 1e3:g} ms."],
    )
    best = own[-1].name
    results.aim(
        f"bilateral, {joints} × {frames}, {PASSES} passes, float32: {best}, ms",
        table.median(best) * 1e3,
        at_most=1,
    )


def _smooth(results: Results, repetitions: int) -> None:
    """Measure beside the reference, which solves its equations frame by frame in Python: on four joints."""
    q = rotations(FRAMES)
    part = np.ascontiguousarray(q[:REFERENCE_FRAMES, :4])
    slow = reference(lambda: qf.smooth(part), scale=FRAMES / REFERENCE_FRAMES * JOINTS / 4)
    agreement.angles("smooth: reference", qf.smooth(part), slow.call())
    own = ours(lambda: qf.smooth(q))
    table = results.table(
        f"smooth, {JOINTS} joints × {FRAMES:,} frames, float32",
        race([*own, slow, Contender("numpy.copy", q.copy)], repetitions),
        rotations=FRAMES * JOINTS,
        beside=[contender.name for contender in own],
        notes=[f"* on {REFERENCE_FRAMES:,} frames of four joints, multiplied."],
    )
    best = own[-1].name
    results.aim(f"smooth, {JOINTS} × {FRAMES:,}, float32: {best}, s", table.median(best), at_most=1)
