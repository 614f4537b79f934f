"""Motion from a few trajectories: what is taken, and what is refused word for word."""

import copy
import pickle
import re
import threading

import numpy as np
import pytest
import quatfilt as qf
import walkers
from quatfilt.evaluation.synthetic import walk


def reconstructor(**options):
    return qf.MotionReconstructor(
        options.pop("database", None) or walkers.database(),
        **{"control_points": walkers.JOINTS, "neighbors": 24, **options},
    )


def positions(frames=4):
    return walkers.seen(walkers.walker(frames))


@pytest.mark.parametrize(
    ("options", "kind", "message"),
    [
        (
            {"control_points": ["LeftWirst"]},
            ValueError,
            r"control_points: the database has no joint 'LeftWirst'; similar names: LeftWrist, ",
        ),
        (
            {"control_points": ["qqq"]},
            ValueError,
            r"control_points: the database has no joint 'qqq'; the joints are Hips, ",
        ),
        ({"control_points": []}, ValueError, "control_points: expected at least one joint, got none"),
        (
            {"control_points": ["Head", "Head"]},
            ValueError,
            "control_points: 'Head' is named twice; name each joint once",
        ),
        (
            {"control_points": "Head"},
            TypeError,
            "control_points: expected a sequence of names of joints, got 'Head'",
        ),
        ({"order": 0}, ValueError, "order: expected an integer of at least 1"),
        ({"neighbors": 0}, ValueError, "neighbors: expected an integer of at least 1"),
        ({"model": "svm"}, ValueError, "model: expected one of 'local_regression'"),
        ({"control_noise": 0}, ValueError, "control_noise: expected a number of at least"),
        ({"control_scale": -1}, ValueError, "control_scale: expected a number above 0"),
        ({"ridge": 0}, ValueError, "ridge: expected a number of at least"),
        ({"skeleton": 3}, TypeError, "skeleton: expected a Skeleton or None, got int"),
        (
            {"skeleton": qf.Skeleton(["a"], [-1], [[0, 0, 0]])},
            ValueError,
            "skeleton: expected the joints of the database",
        ),
    ],
)
def test_options_that_are_refused(options, kind, message):
    with pytest.raises(kind, match=message):
        reconstructor(**options)


def test_no_database():
    with pytest.raises(TypeError, match="database: expected a MotionDatabase, got int"):
        qf.MotionReconstructor(3, control_points=["Head"])


def test_a_database_of_short_clips():
    small = qf.MotionDatabase.from_motions([walk(seconds=0.2, fps=60)], fps=60, min_length=0)
    with pytest.raises(
        ValueError,
        match="database: expected a clip of more than 15 poses at 60 fps, got none of more than 12",
    ):
        reconstructor(database=small)


@pytest.mark.parametrize(
    ("arguments", "kind", "message"),
    [
        ({"positions": np.zeros((4, 3, 3))}, ValueError, r"positions: expected shape \(frames, 4, 3\), got \(4, 3, 3\)"),
        ({"positions": np.zeros((4, 3))}, ValueError, r"positions: expected shape \(frames, 4, 3\), got \(4, 3\)"),
        ({"positions": np.zeros((4, 4, 2))}, ValueError, r"positions: expected shape \(frames, 4, 3\), got \(4, 4, 2\)"),
        ({"positions": []}, ValueError, r"positions: expected shape \(frames, 4, 3\), got \(0,\)"),
        ({"positions": np.zeros((0, 4, 3))}, ValueError, "positions: expected at least one frame, got none"),
        ({"positions": np.full((4, 4, 3), np.nan)}, ValueError, "positions: expected at least one control point that is seen, got none"),
        ({"fps": 0}, ValueError, "fps: expected a number above 0, got 0"),
        ({"fps": 0.001}, ValueError, "fps: expected 0.6 to 6000 hertz, because the database has 60, got 0.001"),
        ({"fps": 1e9}, ValueError, r"fps: expected 0\.6 to 6000 hertz, because the database has 60, got 1e\+09"),
        ({"orientations": np.ones((4, 3, 4)) / 2}, ValueError, r"orientations: expected shape \(4, 4, 4\) as of the positions, got \(4, 3, 4\)"),
        ({"orientations": np.ones((4, 4, 4))}, ValueError, "orientations: expected unit quaternions, got norm 2"),
        ({"confidence": np.ones((4, 3))}, ValueError, r"confidence: expected shape \(4,\) or \(4, 4\), got \(4, 3\)"),
        ({"confidence": np.full(4, 2.0)}, ValueError, "confidence: expected values from 0 to 1, got 2.0"),
        ({"confidence": np.zeros(4)}, ValueError, "positions: expected at least one control point that is seen, got none"),
        ({"initial": 3}, TypeError, "initial: expected a Motion or None, got int"),
    ],
)  # fmt: skip
def test_trajectories_that_are_refused(arguments, kind, message):
    with pytest.raises(kind, match=message):
        reconstructor().reconstruct(**{"positions": positions(), "fps": 60, **arguments})


@pytest.mark.parametrize("value", [np.inf, -np.inf, 1e200, -2e9])
def test_a_point_beyond_all_bounds_is_refused(value):
    points = positions().copy()
    points[0, 0] = np.nan
    points[2, 3, 1] = value
    expected = re.escape(
        f"positions: expected numbers of at most 1e+09 units, or NaN where a point is not seen, got {value:g} at "
    )
    with pytest.raises(ValueError, match=f"{expected}frame 2, point 3"):
        reconstructor().reconstruct(points, fps=60)
    stream, other = reconstructor().stream(), reconstructor().stream()
    with pytest.raises(ValueError, match=f"{expected}point 3"):
        stream.push(points[2])
    np.testing.assert_array_equal(stream.push(points[1]).rotations, other.push(points[1]).rotations)


def test_initial_of_other_joints_or_without_frames():
    other = qf.Motion(
        np.tile([1.0, 0, 0, 0], (2, 1, 1)), fps=60, skeleton=qf.Skeleton(["a"], [-1], [[0, 0, 0]])
    )
    with pytest.raises(ValueError, match="initial: expected the joints of the database"):
        reconstructor().reconstruct(positions(), fps=60, initial=other)
    none = walkers.part(walkers.walker(4), slice(0, 0))
    with pytest.raises(ValueError, match="initial: expected at least one frame, got none"):
        reconstructor().reconstruct(positions(), fps=60, initial=none)


@pytest.mark.parametrize("factor", [0.01, 100.0, 10.0, 0.1])
def test_another_unit_is_told(factor):
    with pytest.raises(
        ValueError,
        match=f"positions: expected the unit of the database, 1 cm, got .* by {1 / factor:.4g}, they would",
    ):
        reconstructor().reconstruct(positions() * factor, fps=60)


@pytest.mark.parametrize("factor", [0.01, 100.0])
def test_another_unit_is_told_where_a_point_is_never_seen(factor):
    points = positions() * factor
    points[:, 1] = np.nan
    with pytest.raises(ValueError, match=f"multiplied by {1 / factor:.4g}, they would fit"):
        reconstructor().reconstruct(points, fps=60)
    with pytest.raises(ValueError, match=f"multiplied by {1 / factor:.4g}, they would fit"):
        reconstructor().reconstruct(points[:1], fps=60)


def test_a_height_that_the_database_has_is_no_unit():
    low = walk(seconds=2, fps=60, seed=4)
    database = qf.MotionDatabase.from_motions([low, fallen(low)], fps=60)
    only = qf.MotionReconstructor(database, control_points=["LeftWrist"])
    place = low.skeleton.index("LeftWrist")
    only.reconstruct(fallen(low).positions()[:5, [place]], fps=60)
    with pytest.raises(ValueError, match="multiplied by 100, they would fit"):
        only.reconstruct(low.positions()[:5, [place]] * 0.01, fps=60)


def fallen(motion):
    """Return a motion whose left wrist is a tenth as high as it was."""
    height = motion.positions()[:, motion.skeleton.index("LeftWrist"), 1]
    return motion.replace(translation=motion.translation - np.outer(0.9 * height, [0, 1, 0]))


def test_unit_of_the_skeleton_is_told():
    q = [walk(seconds=2, fps=60, seed=seed) for seed in (1, 2)]
    scaled = [
        qf.Motion(
            motion.rotations,
            motion.translation / 5.644,
            fps=60,
            skeleton=qf.Skeleton(
                motion.skeleton.names,
                motion.skeleton.parents,
                motion.skeleton.offsets / 5.644,
                centimetres_per_unit=5.644,
            ),
        )
        for motion in q
    ]
    database = qf.MotionDatabase.from_motions(scaled, fps=60)
    with pytest.raises(ValueError, match=r"multiplied by 0\.1772, they would fit"):
        reconstructor(database=database).reconstruct(positions(), fps=60)
    reconstructor(database=database).reconstruct(positions() / 5.644, fps=60)
    for centimetres in (10, 0.01):  # in a millimetre, in a metre
        with pytest.raises(ValueError, match=r"positions: expected the unit of the database, 5\.644 cm"):
            reconstructor(database=database).reconstruct(positions() * centimetres, fps=60)


def sane(result, frames):
    assert len(result) == frames
    assert np.isfinite(result.rotations).all()
    assert np.isfinite(result.translation).all()
    np.testing.assert_allclose(np.linalg.norm(result.rotations, axis=2), 1, rtol=0, atol=1e-9)


def test_targets_out_of_reach_have_a_high_energy():
    one = reconstructor()
    points = positions(12)
    sane(one.reconstruct(points, fps=60), 12)
    usual = one.energies_.sum(axis=1).max()
    far = points.copy()
    far[:, 0] += [0.0, 300.0, 0.0]
    result = one.reconstruct(far, fps=60)
    sane(result, 12)
    assert one.energies_.sum(axis=1).min() > 20 * usual
    together = np.broadcast_to(points[:, :1], points.shape)
    sane(one.reconstruct(together, fps=60), 12)
    assert one.energies_.sum(axis=1).min() > 20 * usual


def test_points_may_be_missing():
    points = positions(40).copy()
    points[:3] = np.nan
    points[5, 1] = np.nan
    points[10:30] = np.nan
    one = reconstructor()
    sane(one.reconstruct(points, fps=60), 40)
    assert (one.energies_[10:30, 0] == 0).all()
    points[35:] = np.nan
    sane(one.reconstruct(points, fps=60), 40)


def test_neighbors_beyond_the_database():
    few = reconstructor(database=walkers.database(seeds=(1,), seconds=0.5), neighbors=1000)
    sane(few.reconstruct(positions(), fps=60), 4)
    one = reconstructor(neighbors=1)
    sane(one.reconstruct(positions(), fps=60), 4)


def test_dtype_and_inputs():
    points = positions().astype(np.float32)
    before = points.tobytes()
    result = reconstructor().reconstruct(points, fps=60)
    assert result.rotations.dtype == result.translation.dtype == np.float32
    assert points.tobytes() == before
    one = reconstructor()
    wide = one.reconstruct(points.astype(np.float64), fps=60)
    assert wide.rotations.dtype == np.float64
    np.testing.assert_array_equal(wide.rotations.astype(np.float32), result.rotations)
    assert one.energies_.shape == (4, 2)
    again = one.reconstruct(points.astype(np.float64)[:, :, :], fps=60)
    np.testing.assert_array_equal(again.rotations, wide.rotations)
    assert (
        repr(one)
        == "MotionReconstructor(LeftWrist, RightWrist, LeftAnkle, RightAnkle; local_regression, 540 poses)"
    )
    assert one.control_points == walkers.JOINTS


def test_stream_refuses_and_goes_on():
    stream, other = reconstructor().stream(), reconstructor().stream()
    points = positions()
    stream.push(points[0])
    other.push(points[0])
    with pytest.raises(ValueError, match=r"positions: expected shape \(4, 3\), got \(3, 3\)"):
        stream.push(points[1, :3])
    with pytest.raises(ValueError, match="confidence: expected a number or one per joint"):
        stream.push(points[1], confidence=[1.0, 2.0])
    np.testing.assert_array_equal(stream.push(points[1]).rotations, other.push(points[1]).rotations)
    for change in (pickle.dumps, copy.copy, copy.deepcopy):
        with pytest.raises(
            TypeError, match="ReconstructionStream: a stream can neither be pickled nor copied"
        ):
            change(stream)


def test_trackers_share_what_they_make_of_the_poses():
    one, other = reconstructor(), reconstructor(control_points=walkers.JOINTS[:3])
    points = positions()
    first = one.reconstruct(points, fps=60).rotations
    np.testing.assert_array_equal(one.reconstruct(points, fps=60).rotations, first)
    np.testing.assert_array_equal(one.stream().push(points[0]).rotations, first[0])
    for copied in (copy.deepcopy(one), pickle.loads(pickle.dumps(one))):  # noqa: S301
        np.testing.assert_array_equal(copied.reconstruct(points, fps=60).rotations, first)
    # They were made, for those of other points do not fit.
    vars(other._examples)["tables"] = one._examples.tables
    with pytest.raises(ValueError, match="tables: expected those of the same poses and options"):
        other.reconstruct(points[:, :3], fps=60)


def test_streams_in_threads():
    expected = reconstructor().reconstruct(positions(), fps=60).rotations
    results = {}

    def follow(number):
        stream = reconstructor().stream()
        results[number] = np.array([stream.push(points).rotations for points in positions()])

    threads = [threading.Thread(target=follow, args=(number,)) for number in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for result in results.values():
        np.testing.assert_allclose(result, expected, rtol=0, atol=1e-12)
