"""How the time of non-local pose means grows with what it depends on, and that it does not grow with the patch."""

import quatfilt as qf
from clips import JOINTS, NOISE, rotations
from report import Results, Row, Table
from timing import Contender, Times, all_threads, ours, race

FRAMES = 1_000
FACTORS = (1, 10, 100)


def scaling(results: Results, repetitions: int) -> None:
    """Measure frames, joints and patches."""
    _frames(results, repetitions)
    _others(results, repetitions)


def _rows(times: list[Times], sizes: list[int]) -> list[Row]:
    return [Row(taken.name, taken.seconds, size) for taken, size in zip(times, sizes, strict=True)]


def _frames(results: Results, repetitions: int) -> None:
    contenders: list[Contender] = []
    sizes: list[int] = []
    for factor in FACTORS:
        q = rotations(FRAMES * factor)
        own = ours(lambda q=q: qf.nonlocal_pose_means(q, bandwidth=NOISE), f"{len(q):,} frames")
        contenders += own
        sizes += [len(q) * JOINTS] * len(own)
    # Short calls vary more: they are repeated more often.
    rows = _rows(race(contenders, 4 * repetitions), sizes)
    results.add(
        Table(f"Scaling with frames, {JOINTS} joints, window 21, patch 11, float32", rows, [rows[0].name])
    )
    middle, last = rows[-1 - len(own)], rows[-1]
    growth = last.median / middle.median / (FACTORS[2] / FACTORS[1])
    results.aim(
        f"NLPM, float32: time of ten times the frames, {last.name} ÷ {middle.name}, ÷ 10", growth, at_most=1.1
    )


def _others(results: Results, repetitions: int) -> None:
    q = rotations(10 * FRAMES)
    wide = rotations(10 * FRAMES, 4 * JOINTS)
    contenders = [
        *(
            Contender(
                f"patch radius {radius}",
                lambda radius=radius: qf.nonlocal_pose_means(q, bandwidth=NOISE, patch_radius=radius),
            )
            for radius in (5, 0, 50)
        ),
        Contender("search radius 20", lambda: qf.nonlocal_pose_means(q, bandwidth=NOISE, search_radius=20)),
        Contender(f"{4 * JOINTS} joints", lambda: qf.nonlocal_pose_means(wide, bandwidth=NOISE)),
    ]
    sizes = [10 * FRAMES * JOINTS] * 4 + [10 * FRAMES * 4 * JOINTS]
    rows = _rows(race(contenders, 4 * repetitions), sizes)
    table = Table(
        f"Scaling with patch, window and joints, {JOINTS} joints × {10 * FRAMES:,} frames, search radius 10, "
        f"float32, {all_threads()} threads",
        rows,
        [rows[0].name],
    )
    results.add(table)
