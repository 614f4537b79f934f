"""What a database holds: poses, headings, skeletons, and what is refused."""

import re

import clips
import numpy as np
import pytest
import quatfilt as qf
import tolerances
from quatfilt.evaluation.synthetic import walk


def shuffled(motion, rng):
    """The same motion with its joints in another order, parents still first."""
    skeleton, order = motion.skeleton, [0]
    waiting = set(range(1, len(skeleton)))
    while waiting:
        ready = [joint for joint in sorted(waiting) if skeleton.parents[joint] in order]
        order.append(int(rng.choice(ready)))
        waiting.remove(order[-1])
    place = {joint: number for number, joint in enumerate(order)}
    other = qf.Skeleton(
        [skeleton.names[joint] for joint in order],
        [place.get(int(skeleton.parents[joint]), -1) for joint in order],
        skeleton.offsets[order],
        centimetres_per_unit=skeleton.centimetres_per_unit,
        end_sites=[qf.EndSite(place[site.joint], site.offset, site.name) for site in skeleton.end_sites],
    )
    return qf.Motion(motion.rotations[:, order], motion.translation, fps=motion.fps, skeleton=other)


def in_other_unit(motion, centimetres):
    """The same motion in another unit of length."""
    skeleton = motion.skeleton
    scale = skeleton.centimetres_per_unit / centimetres
    sites = [qf.EndSite(s.joint, tuple(scale * x for x in s.offset), s.name) for s in skeleton.end_sites]
    other = qf.Skeleton(
        skeleton.names,
        skeleton.parents,
        skeleton.offsets * scale,
        centimetres_per_unit=centimetres,
        end_sites=sites,
    )
    return qf.Motion(motion.rotations, motion.translation * scale, fps=motion.fps, skeleton=other)


def turned(motion, angles):
    """The same motion in a world that is turned about the vertical."""
    vectors = np.zeros((len(motion), 3))
    vectors[:, 1] = angles
    about = clips.from_vectors(vectors)
    rotations = motion.rotations.copy()
    rotations[:, 0] = clips.product(about, rotations[:, 0])
    return motion.replace(rotations=rotations, translation=clips.rotation(about).apply(motion.translation))


def same_motion(result, expected, *, rotations=tolerances.ALGEBRA_FLOAT32):
    """Ask for the same motion to the accuracy of float32."""
    assert result.fps == expected.fps
    assert len(result) == len(expected)
    order = [expected.skeleton.names.index(name) for name in result.skeleton.names]
    angles = qf.geodesic_distance(result.rotations.astype(float), expected.rotations[:, order])
    assert angles.max() < rotations
    unit = result.skeleton.centimetres_per_unit
    places = expected.positions()[:, order] * expected.skeleton.centimetres_per_unit
    scale = np.abs(places).max()
    np.testing.assert_allclose(result.positions() * unit, places, rtol=0, atol=1e-5 * scale)


def test_a_frame_rate_that_would_fill_the_memory_is_refused(tmp_path):
    slow = walk(seconds=1).replace(fps=0.001)
    with pytest.raises(
        ValueError, match=r"fps: expected at most 0\.1 hertz, because crawl has 0\.001, got 60"
    ):
        qf.MotionDatabase.from_motions([slow], clip_names=["crawl"])
    with pytest.raises(ValueError, match=r"fps: expected at most 12000 hertz, because 0 has 120, got 1e\+09"):
        qf.MotionDatabase.from_motions([walk(seconds=1)], fps=1e9)
    qf.write_motion(tmp_path / "a.npz", walk(seconds=1))
    with pytest.raises(ValueError, match=r"fps: expected at most 0\.1 hertz, because a has 0\.001, got 60"):
        qf.MotionDatabase.from_folders(tmp_path, source_fps=0.001)
    assert len(qf.MotionDatabase.from_motions([walk(seconds=60)], fps=0.5)) == 30


def test_clips_come_back(backend):
    del backend
    walks = [walk(seconds=2, seed=seed) for seed in range(3)]
    db = qf.MotionDatabase.from_motions(walks, fps=120, clip_names=["a", "b", "c"])
    assert len(db) == db.starts[-1] == sum(map(len, walks))
    assert db.clip_names == ("a", "b", "c")
    assert db.names == walks[0].skeleton.names
    np.testing.assert_array_equal(db.parents, walks[0].skeleton.parents)
    for number, motion in enumerate(walks):
        same_motion(db.motion(number), motion)
    same_motion(db.motion(-1), walks[2])


def test_shapes_and_types():
    db = qf.MotionDatabase.from_motions([walk(seconds=2), walk(seconds=1)], fps=30)
    poses, joints = len(db), len(db.names)
    assert db.rotations.shape == (poses, joints, 4)
    assert db.features.shape == (poses, 3 * joints)
    assert db.heading.shape == (poses,)
    assert db.translation.shape == (poses, 3)
    assert db.mean_rotations.shape == (joints, 4)
    assert db.joint_weights.shape == (joints,)
    assert {x.dtype for x in (db.rotations, db.features, db.heading, db.translation)} == {np.dtype("f4")}
    assert db.starts.dtype == db.skeleton_indices.dtype == np.int64
    assert (db.up, db.fps, db.graph) == (1, 30, None)


def test_what_follows_from_the_rotations():
    db = qf.MotionDatabase.from_motions([walk(seconds=3), walk(seconds=2, seed=4)])
    means = qf.mean(db.rotations.astype(float))
    assert qf.geodesic_distance(means, db.mean_rotations).max() < tolerances.FLOAT32
    away = 2 * qf.log(qf.multiply(qf.conjugate(means), db.rotations.astype(float)))
    away = np.where(np.linalg.norm(away, axis=-1, keepdims=True) > np.pi, np.nan, away)
    expected = np.sqrt(db.joint_weights)[:, None] * away
    got = db.features.reshape(len(db), -1, 3)
    known = np.isfinite(expected)
    assert known.mean() > 0.4
    np.testing.assert_allclose(got[known], expected[known], rtol=0, atol=tolerances.FLOAT32)
    for start, stop in zip(db.starts[:-1], db.starts[1:], strict=True):
        steps = np.sum(db.rotations[start + 1 : stop] * db.rotations[start : stop - 1], axis=-1)
        assert steps.min() > 0, "the sign jumps"


def test_where_a_body_faces_does_not_matter():
    motion = walk(seconds=3)
    db = qf.MotionDatabase.from_motions([motion, turned(motion, np.full(len(motion), 2.0))])
    half = len(db) // 2
    angles = qf.geodesic_distance(db.rotations[:half].astype(float), db.rotations[half:].astype(float))
    assert angles.max() < tolerances.ALGEBRA_FLOAT32
    np.testing.assert_allclose(db.features[:half], db.features[half:], rtol=0, atol=tolerances.FLOAT32)
    np.testing.assert_allclose(db.heading[half:] - db.heading[:half], 2, rtol=0, atol=tolerances.FLOAT32)


def test_headings_go_on_through_whole_turns():
    motion = walk(seconds=4)
    angles = np.linspace(0, 30, len(motion))
    db = qf.MotionDatabase.from_motions([turned(motion, angles)], fps=120)
    plain = qf.MotionDatabase.from_motions([motion], fps=120)
    np.testing.assert_allclose(db.heading - plain.heading, angles, rtol=0, atol=1e-4)
    same_motion(db.motion(0), turned(motion, angles), rotations=1e-5)


def test_joints_are_matched_by_name_and_lengths_by_unit():
    rng = np.random.default_rng(5)
    motion, other = walk(seconds=2), walk(seconds=2, seed=1)
    mixed = [motion, shuffled(other, rng), in_other_unit(shuffled(motion, rng), 2.54)]
    assert mixed[1].skeleton.names != motion.skeleton.names
    db = qf.MotionDatabase.from_motions(mixed, fps=120)
    plain = qf.MotionDatabase.from_motions([motion, other, motion], fps=120)
    assert db.names == plain.names
    np.testing.assert_array_equal(db.rotations, plain.rotations)
    np.testing.assert_allclose(db.translation, plain.translation, rtol=1e-6)
    for number, expected in enumerate(mixed):
        same_motion(db.motion(number), expected)


def test_skeletons_are_kept_once_each_and_their_mean_counts_poses():
    motion = walk(seconds=2)
    skeleton = motion.skeleton
    larger = qf.Skeleton(
        skeleton.names, skeleton.parents, skeleton.offsets * 1.2, end_sites=skeleton.end_sites
    )
    tall = motion.replace(skeleton=larger)
    db = qf.MotionDatabase.from_motions([motion, tall, motion, motion])
    assert len(db.skeletons) == 2
    assert db.skeleton_indices.tolist() == [0, 1, 0, 0]
    np.testing.assert_allclose(db.skeletons[1].offsets, larger.offsets)
    np.testing.assert_allclose(db.skeleton.offsets, skeleton.offsets * 1.05)
    assert db.skeleton.end_sites
    for site, expected in zip(db.skeleton.end_sites, sorted(skeleton.end_sites), strict=True):
        assert (site.joint, site.name) == (expected.joint, expected.name)
        np.testing.assert_allclose(site.offset, expected.offset)


@pytest.mark.parametrize("fps", [24, 50, 60, 59.94])
def test_rates_that_do_not_divide(fps):
    motion = walk(seconds=3)
    db = qf.MotionDatabase.from_motions([motion], fps=fps)
    expected = qf.resample(motion.rotations, fps=120, new_fps=fps)
    result = db.motion(0)
    assert len(result) == len(expected)
    assert qf.geodesic_distance(result.rotations.astype(float), expected).max() < tolerances.ALGEBRA_FLOAT32
    times = np.arange(len(result)) / fps
    for axis in range(3):
        way = np.interp(times, np.arange(len(motion)) / 120, motion.translation[:, axis])
        np.testing.assert_allclose(result.translation[:, axis], way, rtol=0, atol=1e-3)


def test_weights_follow_the_reach():
    db = qf.MotionDatabase.from_motions([walk(seconds=1)])
    weights = dict(zip(db.names, db.joint_weights, strict=True))
    assert np.isclose(sum(weights.values()), 1)
    for joint, parent in enumerate(db.parents):
        if parent >= 0:
            assert db.joint_weights[joint] <= db.joint_weights[parent]
    assert min(weights.values()) > 0
    arm = qf.Skeleton(
        ["a", "b", "c"], [-1, 0, 1], [[0.0, 9, 0], [0, -30, 0], [0, -20, 0]], end_sites=[(2, (0, 0, 10))]
    )
    q = np.tile([1.0, 0, 0, 0], (60, 3, 1))
    db = qf.MotionDatabase.from_motions([qf.Motion(q, fps=60, skeleton=arm)])
    np.testing.assert_allclose(db.joint_weights, np.array([60, 30, 10]) / 100)
    given = qf.MotionDatabase.from_motions([qf.Motion(q, fps=60, skeleton=arm)], joint_weights=[3, 0, 1])
    assert given.joint_weights.tolist() == [3, 0, 1]
    # Without bones all joints count alike.
    point = qf.Skeleton(["a", "b"], [-1, 0], np.zeros((2, 3)))
    db = qf.MotionDatabase.from_motions([qf.Motion(q[:, :2], fps=60, skeleton=point)])
    assert db.joint_weights.tolist() == [0.5, 0.5]


def test_short_gaps_are_filled_and_clips_are_cut_at_long_ones():
    motion = walk(seconds=4)
    rotations, translation = motion.rotations.copy(), motion.translation.copy()
    rotations[100:106, 3] = np.nan
    rotations[50:53, 7] = 0
    translation[150:155] = np.nan
    rotations[200:240, 5] = np.nan
    translation[:7] = np.nan
    rotations[-4:, 2] = np.nan
    gappy = motion.replace(rotations=rotations, translation=translation)
    db = qf.MotionDatabase.from_motions([gappy], fps=120, clip_names=["walk"])
    assert db.clip_names == ("walk[7:200]", "walk[240:476]")
    assert db.notes == ("walk: cut where samples are missing: 51 of 480 frames left out",)
    assert np.isfinite(db.rotations).all()
    assert np.isfinite(db.translation).all()
    known = np.isfinite(rotations[7:200]).all(axis=-1) & rotations[7:200].any(axis=-1)
    angles = qf.geodesic_distance(db.motion(0).rotations.astype(float), motion.rotations[7:200])
    assert angles[known].max() < tolerances.ALGEBRA_FLOAT32
    assert angles[~known].max() < 0.1
    np.testing.assert_allclose(db.motion(0).translation, motion.translation[7:200], rtol=0, atol=0.2)
    nothing = qf.MotionDatabase.from_motions([gappy], fps=120, max_gap=0, min_length=0.2)
    assert [name.partition("[")[2] for name in nothing.clip_names] == [
        "7:50]",
        "53:100]",
        "106:150]",
        "155:200]",
        "240:476]",
    ]


def test_short_clips_are_left_out():
    db = qf.MotionDatabase.from_motions(
        [walk(seconds=0.3), walk(seconds=2), walk(seconds=0)], clip_names=["blink", "walk", "nothing"]
    )
    assert db.clip_names == ("walk",)
    assert db.notes == ("blink: left out: 0.3 s, shorter than 0.5 s", "nothing: left out: no frames")


def test_joints_that_stand_where_every_frame_says():
    motion = walk(seconds=1)
    places = np.tile(motion.skeleton.offsets * 1.1, (len(motion), 1, 1))
    db = qf.MotionDatabase.from_motions([motion.replace(joint_translations=places)], fps=120)
    np.testing.assert_allclose(db.skeleton.offsets[1:], motion.skeleton.offsets[1:] * 1.1)
    assert db.notes == ()
    places[:, 4, 0] += np.linspace(-1, 1, len(motion))
    db = qf.MotionDatabase.from_motions([motion.replace(joint_translations=places)], fps=120)
    np.testing.assert_allclose(db.skeleton.offsets[1:], motion.skeleton.offsets[1:] * 1.1, atol=1e-12)
    moving = motion.skeleton.names[4]
    assert db.notes == (f"0: joints that move in their parents are kept at their mean places: {moving}",)


def test_another_vertical():
    motion = walk(seconds=2)
    # x → y → z → x: what was up along y is up along z.
    cycle = [2, 0, 1]
    rotations = np.concatenate([motion.rotations[..., :1], motion.rotations[..., 1:][..., cycle]], axis=-1)
    skeleton = motion.skeleton
    other = qf.Motion(
        rotations,
        motion.translation[:, cycle],
        fps=120,
        skeleton=qf.Skeleton(skeleton.names, skeleton.parents, skeleton.offsets[:, cycle]),
    )
    db = qf.MotionDatabase.from_motions([other], up="z", mirror=True)
    plain = qf.MotionDatabase.from_motions([motion], mirror=True)
    assert db.up == 2
    np.testing.assert_allclose(db.heading, plain.heading, rtol=0, atol=tolerances.FLOAT32)
    np.testing.assert_allclose(
        db.rotations[..., 1:], plain.rotations[..., 1:][..., cycle], rtol=0, atol=tolerances.FLOAT32
    )
    wrong = qf.MotionDatabase.from_motions([other])
    assert re.fullmatch(
        r"bodies reach \d+ along z and [\d.]+ along y, which is said to be up: up='z'\?", wrong.notes[0]
    )


def test_a_root_that_never_turns_is_told():
    motion = walk(seconds=1)
    skeleton = motion.skeleton
    rooted = qf.Skeleton(
        ["world", *skeleton.names], [-1, *(skeleton.parents + 1)], [[0.0] * 3, *skeleton.offsets]
    )
    still = np.tile([1.0, 0, 0, 0], (len(motion), 1, 1))
    rotations = np.concatenate([still, motion.rotations], axis=1)
    db = qf.MotionDatabase.from_motions([qf.Motion(rotations, fps=120, skeleton=rooted)])
    assert db.notes == (
        "world never turns about y: if a joint below it leads, the headings of clips are not taken out",
    )


def test_neighbours_of_poses():
    db = qf.MotionDatabase.from_motions([walk(seconds=1)])
    neighbors = np.tile([0, 1, -1], (len(db), 1))
    db.graph = neighbors
    np.testing.assert_array_equal(db.graph, neighbors)
    assert db.graph.dtype == np.int32
    db.graph = None
    assert db.graph is None
    for wrong, message in [
        (neighbors[1:], rf"graph: expected shape \({len(db)}, degree\), got \({len(db) - 1}, 3\)"),
        (
            neighbors + len(db),
            rf"graph: expected indices from −1 to {len(db) - 1}, got {len(db) - 1} to {len(db) + 1}",
        ),
        (neighbors[:, 0], rf"graph: expected shape \({len(db)}, degree\), got \({len(db)},\)"),
    ]:
        with pytest.raises(ValueError, match=f"^{message}$"):
            db.graph = wrong
    with pytest.raises(TypeError, match=r"^graph: expected integers, got dtype float64$"):
        db.graph = neighbors * 1.0


def renamed(motion, names):
    skeleton = motion.skeleton
    return motion.replace(skeleton=qf.Skeleton(names, skeleton.parents, skeleton.offsets))


def test_other_joints_are_refused_by_name():
    motion = walk(seconds=1)
    names = list(motion.skeleton.names)
    fewer = renamed(motion, ["Pelvis", *names[1:]])
    with pytest.raises(
        ValueError,
        match=f"^motions: 1: expected the joints of 0, got none named {names[0]} and others, Pelvis$",
    ):
        qf.MotionDatabase.from_motions([motion, fewer])
    twice = renamed(motion, [*names[:-1], names[1]])
    with pytest.raises(
        ValueError, match=f"^motions: 0: expected joints of different names, got several named {names[1]}$"
    ):
        qf.MotionDatabase.from_motions([twice])
    parents = motion.skeleton.parents.copy()
    parents[-1] = 0
    moved = motion.replace(skeleton=qf.Skeleton(names, parents, motion.skeleton.offsets))
    was = names[motion.skeleton.parents[-1]]
    with pytest.raises(
        ValueError,
        match=f"^motions: b: expected the joints of a, got {names[-1]} with the parent {names[0]} instead of {was}$",
    ):
        qf.MotionDatabase.from_motions([motion, moved], clip_names=["a", "b"])
    two = qf.Skeleton(["a", "b"], [-1, -1], np.zeros((2, 3)))
    with pytest.raises(ValueError, match=r"^motions: 0: expected one root, got a, b$"):
        qf.MotionDatabase.from_motions([qf.Motion(np.ones((60, 2, 4)) / 2, fps=60, skeleton=two)])


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"fps": 0}, "fps: expected a number above 0, got 0"),
        ({"up": 1}, "up: expected one of 'x', 'y', 'z', got 1"),
        ({"max_gap": -1}, "max_gap: expected a number of at least 0, got -1"),
        ({"min_length": -1}, "min_length: expected a number of at least 0, got -1"),
        ({"clip_names": ["a", "b"]}, "clip_names: expected one for each of 1 motions, got 2"),
        (
            {"joint_weights": [1, 2]},
            r"joint_weights: expected a number or one per joint, shape \(21,\), got \(2,\)",
        ),
        ({"joint_weights": [0] * 21}, "joint_weights: expected a weight above 0, got none"),
        (
            {"min_length": 5},
            "motions: expected clips that can be used, got none: 0: left out: 1 s, shorter than 5 s",
        ),
    ],
)
def test_bad_options(options, message):
    with pytest.raises(ValueError, match=f"^{message}$"):
        qf.MotionDatabase.from_motions([walk(seconds=1)], **options)


@pytest.mark.parametrize(("names", "kind"), [("a", "str"), (5, "int")])
def test_names_of_clips_are_several(names, kind):
    with pytest.raises(TypeError, match=f"^clip_names: expected a sequence of names, got {kind}$"):
        qf.MotionDatabase.from_motions([walk(seconds=1)], clip_names=names)


def test_no_motions():
    with pytest.raises(ValueError, match=r"^motions: expected at least one, got none$"):
        qf.MotionDatabase.from_motions([])
    with pytest.raises(TypeError, match=r"^motions\[1\]: expected a Motion, got str$"):
        qf.MotionDatabase.from_motions([walk(seconds=1), "walk.bvh"])
    with pytest.raises(TypeError, match=r"^motions: expected a sequence of Motions, got Motion$"):
        qf.MotionDatabase.from_motions(walk(seconds=1))
    db = qf.MotionDatabase.from_motions([walk(seconds=1)])
    with pytest.raises(ValueError, match=r"^clip: expected an integer of at least -1 and at most 0, got 1$"):
        db.motion(1)
