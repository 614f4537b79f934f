"""Motion from a few trajectories: what holds by definition."""

import clips
import numpy as np
import pytest
import quatfilt as qf
import tolerances
import walkers

pytestmark = pytest.mark.usefixtures("backend")


def reconstructor(**options):
    return qf.MotionReconstructor(
        options.pop("database", None) or walkers.database(),
        **{"control_points": walkers.JOINTS, "neighbors": 24, **options},
    )


def test_turning_and_moving_the_points_turns_and_moves_the_motion():
    positions = walkers.seen(walkers.walker(25))
    result = reconstructor().reconstruct(positions, fps=60)
    for angle in (0.5, 3.0, -2.0):
        away = np.array([120.0, 0.0, -40.0])
        there = reconstructor().reconstruct(walkers.turned(positions, angle, away), fps=60)
        places = walkers.turned(result.positions(), angle, away)
        np.testing.assert_allclose(there.positions(), places, rtol=0, atol=1e-6)
        assert clips.angles(result.rotations[:, 1:], there.rotations[:, 1:]).max() <= 1e-8


def test_lifting_the_points_is_no_symmetry():
    positions = walkers.seen(walkers.walker(5))
    lifted = positions + np.array([0.0, 10.0, 0.0])
    energies = []
    for points in (positions, lifted):
        one = reconstructor()
        one.reconstruct(points, fps=60)
        energies.append(one.energies_.sum())
    assert energies[1] > 2 * energies[0]


def test_signs_of_the_database_do_not_matter():
    signs = np.where(np.random.default_rng(0).random((180, 21, 1)) < 0.5, -1, 1)
    motions = [walkers.walk(seconds=3, fps=60, seed=seed) for seed in (1, 2, 3)]
    flipped = [motion.replace(rotations=motion.rotations * signs[: len(motion)]) for motion in motions]
    other = qf.MotionDatabase.from_motions(flipped, fps=60)
    positions = walkers.seen(walkers.walker(8))
    expected = reconstructor().reconstruct(positions, fps=60)
    result = reconstructor(database=other).reconstruct(positions, fps=60)
    assert clips.angles(expected.rotations, result.rotations).max() <= tolerances.filtered(np.float32)


def test_order_of_the_points_does_not_matter():
    positions = walkers.seen(walkers.walker(8))
    result = reconstructor().reconstruct(positions, fps=60)
    other = reconstructor(control_points=walkers.JOINTS[::-1]).reconstruct(positions[:, ::-1], fps=60)
    assert clips.angles(result.rotations, other.rotations).max() <= 1e-8


def test_all_joints_with_little_noise_give_the_truth():
    walk = walkers.walker(10)
    names = walk.skeleton.names
    one = reconstructor(
        control_points=names, control_noise=0.001, orientation_noise=1e-5, skeleton=walk.skeleton
    )
    orientations = global_rotations(walk)
    result = one.reconstruct(walk.positions(), orientations=orientations, fps=60)
    assert qf.metrics.position_error(walk, result) < 0.01
    assert qf.metrics.angle_error(walk.rotations, result.rotations) < 0.01


def global_rotations(motion):
    turns = motion.rotations.copy()
    for joint, parent in enumerate(motion.skeleton.parents):
        if parent >= 0:
            turns[:, joint] = qf.multiply(turns[:, parent], turns[:, joint])
    return turns


def test_a_walk_is_found_again_in_the_database():
    walk = walkers.part(walkers.database().motion(1), slice(40, 100))
    result = reconstructor().reconstruct(walkers.seen(walk), fps=60)
    assert qf.metrics.angle_error(walk.rotations[20:], result.rotations[20:]) < 2.0


def test_another_walk_is_followed():
    walk = walkers.walker(60)
    result = reconstructor(skeleton=walk.skeleton).reconstruct(walkers.seen(walk), fps=60)
    assert qf.metrics.position_error(walk, result) < 2.0
    still = reconstructor(skeleton=walk.skeleton).reconstruct(walkers.seen(walk)[:1].repeat(60, 0), fps=60)
    assert qf.metrics.position_error(walk, still) > 10.0


def test_more_points_are_followed_better():
    walk = walkers.walker(40)
    errors = []
    for joints in (walkers.JOINTS[1:3], walkers.JOINTS, (*walkers.JOINTS, "Head", "Hips")):
        one = reconstructor(control_points=joints, skeleton=walk.skeleton)
        errors.append(qf.metrics.position_error(walk, one.reconstruct(walkers.seen(walk, joints), fps=60)))
    assert errors[0] > errors[1] > errors[2]


def test_confidence_zero_is_not_seen():
    positions = walkers.seen(walkers.walker(8)).copy()
    confidence = np.ones((8, 4))
    confidence[2:5, 1] = 0
    confidence[6] = 0
    wild = positions.copy()
    wild[confidence == 0] = 1e6
    missing = np.where(confidence[..., None] == 0, np.nan, positions)
    expected = reconstructor().reconstruct(missing, fps=60)
    for points in (positions, wild):
        result = reconstructor().reconstruct(points, fps=60, confidence=confidence)
        np.testing.assert_array_equal(result.rotations, expected.rotations)
        np.testing.assert_array_equal(result.translation, expected.translation)


def test_frames_come_back_at_the_rate_they_came():
    walk = walkers.walker(41)
    full = reconstructor().reconstruct(walkers.seen(walk), fps=60)
    half = reconstructor().reconstruct(walkers.seen(walk)[::2], fps=30)
    assert len(half) == 21
    assert half.fps == 30
    assert qf.metrics.position_error(walkers.part(full, slice(None, None, 2)), half) < 2.0
    doubled = np.repeat(walkers.seen(walk), 2, axis=0)[:-1]
    doubled[1::2] = (doubled[:-1:2] + doubled[2::2]) / 2
    twice = reconstructor().reconstruct(doubled, fps=120)
    assert len(twice) == 81
    np.testing.assert_allclose(twice.translation[::2], full.translation, rtol=0, atol=1e-9)
    assert clips.angles(full.rotations, twice.rotations[::2]).max() <= 1e-9


@pytest.mark.parametrize("initial", [False, True])
def test_stream(initial):
    walk = walkers.walker(30)
    positions = walkers.seen(walk).copy()
    positions[4:6, 2] = np.nan
    positions[10:12] = np.nan
    confidence = np.random.default_rng(1).random((30, 4))
    past = walkers.part(walk, slice(0, 3)) if initial else None
    one = reconstructor()
    expected = one.reconstruct(positions, fps=60, confidence=confidence, initial=past)
    stream = one.stream(initial=past)
    poses = [stream.push(p, confidence=c) for p, c in zip(positions, confidence, strict=True)]
    for name, whole in [
        ("rotations", expected.rotations),
        ("translation", expected.translation),
        ("energies", one.energies_),
    ]:
        np.testing.assert_allclose(
            np.array([getattr(pose, name) for pose in poses]),
            whole,
            rtol=0,
            atol=1e-12 if qf.get_backend() == "rust" else tolerances.TRACK,
        )


def test_a_past_settles_the_start():
    walk = walkers.walker(12)
    rest = walkers.part(walk, slice(3, 12))
    result = reconstructor(skeleton=walk.skeleton).reconstruct(
        walkers.seen(rest),
        fps=60,
        initial=walkers.part(walk, slice(0, 3)),
    )
    assert qf.metrics.angle_error(rest.rotations[:1], result.rotations[:1]) < 3.0


def test_where_a_wrong_past_stands_is_put_right_at_once():
    walk = walkers.walker(12)
    past, rest = walkers.part(walk, slice(0, 3)), walkers.part(walk, slice(3, 12))
    turns = past.rotations.copy()
    turns[:, 0] = qf.multiply(qf.exp(np.tile([0.0, 0.5, 0.0], (3, 1))), turns[:, 0])
    places = walkers.turned(past.translation, 1.0, np.array([50.0, 0.0, 0.0]))
    wrong = past.replace(rotations=turns, translation=places)
    errors = []
    for scale in (None, np.inf):
        one = reconstructor(skeleton=walk.skeleton, control_scale=scale)
        result = one.reconstruct(walkers.seen(rest), fps=60, initial=wrong)
        errors.append(
            qf.metrics.position_error(walkers.part(rest, slice(0, 1)), walkers.part(result, slice(0, 1)))
        )
    assert errors[0] < 1.0
    assert errors[1] > 10.0


def test_points_above_each_other_tell_no_heading():
    walk = walkers.walker(20)
    past, rest = walkers.part(walk, slice(0, 3)), walkers.part(walk, slice(3, 20))
    joints = ("Hips", "Head")
    one = reconstructor(control_points=joints, skeleton=walk.skeleton)
    still = walkers.seen(rest, joints)[:1].repeat(17, 0)
    result = one.reconstruct(still, fps=60, initial=past)
    assert qf.metrics.angle_error(rest.rotations[:1].repeat(17, 0)[:, :1], result.rotations[:, :1]) < 5.0


def test_a_graph_in_which_all_know_all_changes_nothing():
    positions = walkers.seen(walkers.walker(20))
    options = {"control_points": walkers.JOINTS, "neighbors": 16}
    database = walkers.walks()
    everywhere = qf.MotionReconstructor(database, **options).reconstruct(positions, fps=walkers.FPS)
    every = np.arange(len(database), dtype=np.int32)
    database.graph = np.tile(every, (len(database), 1))
    along = qf.MotionReconstructor(database, **options).reconstruct(positions, fps=walkers.FPS)
    np.testing.assert_array_equal(along.rotations, everywhere.rotations)
    np.testing.assert_array_equal(along.translation, everywhere.translation)


def test_a_stream_goes_along_the_graph_as_the_whole_does():
    positions = walkers.seen(walkers.walker(12))
    reconstructor = qf.MotionReconstructor(
        walkers.with_graph(degree=2), control_points=walkers.JOINTS, neighbors=8
    )
    whole = reconstructor.reconstruct(positions, fps=walkers.FPS)
    stream = reconstructor.stream()
    poses = np.array([stream.push(frame).rotations for frame in positions])
    assert clips.angles(whole.rotations, poses).max() <= tolerances.SOLUTION
