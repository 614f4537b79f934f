"""Mirror images: what is on the left comes to the right, in space and not only by name."""

import numpy as np
import pytest
import quatfilt as qf
from quatfilt.evaluation.synthetic import walk


def image_of(db):
    """Which joint is the other one of each joint, by the names of the synthetic body and of CMU's."""
    swapped = {
        name: name.replace("Left", "~").replace("Right", "Left").replace("~", "Right") for name in db.names
    }
    if all(name == other for name, other in swapped.items()):
        sides = {"l": "r", "r": "l"}
        swapped = {name: sides.get(name[0], name[0]) + name[1:] for name in db.names}
        swapped = {name: other if other in swapped else name for name, other in swapped.items()}
    return [db.names.index(swapped[name]) for name in db.names]


def check_mirrored(db, across):
    """Every second clip is the mirror image of the one before, joint by joint, up to the position of the plane."""
    other = image_of(db)
    assert other != list(range(len(db.names)))
    for number in range(0, len(db.clip_names), 2):
        assert db.clip_names[number + 1] == f"{db.clip_names[number]} mirrored"
        places, image = (db.motion(n).positions().astype(float) for n in (number, number + 1))
        places[..., across] *= -1
        scale = np.abs(places).max()
        np.testing.assert_allclose(image, places[:, other], rtol=0, atol=1e-6 * scale)
        # The ends of bones too.
        for skeleton in (db.skeletons[db.skeleton_indices[n]] for n in (number, number + 1)):
            assert len(skeleton.end_sites) == len(db.skeleton.end_sites)


def test_mirrored_positions_are_the_mirror_image():
    walks = [walk(seconds=1, seed=seed) for seed in range(2)]
    db = qf.MotionDatabase.from_motions(walks, mirror=True)
    assert len(db.clip_names) == 4
    check_mirrored(db, 0)
    poses = slice(0, db.starts[1])
    image = slice(db.starts[1], db.starts[2])
    np.testing.assert_array_equal(db.heading[image], -db.heading[poses])
    np.testing.assert_array_equal(db.translation[image], db.translation[poses] * np.float32([-1, 1, 1]))


def test_a_mirror_image_of_a_mirror_image_is_the_clip():
    motion = walk(seconds=1)
    once = qf.MotionDatabase.from_motions([motion], mirror=True, fps=120)
    twice = qf.MotionDatabase.from_motions([once.motion(1)], mirror=True, fps=120)
    angles = qf.geodesic_distance(twice.motion(1).rotations, once.motion(0).rotations)
    assert angles.max() < 1e-6
    np.testing.assert_allclose(twice.skeletons[1].offsets, once.skeletons[0].offsets)


@pytest.mark.parametrize(
    ("left", "right"),
    [
        ("LeftArm", "RightArm"),
        ("mixamorig:LeftArm", "mixamorig:RightArm"),
        ("left_arm", "right_arm"),
        ("LArm", "RArm"),
        ("lArm", "rArm"),
        ("L_Arm", "R_Arm"),
        ("arm.L", "arm.R"),
        ("arm_l", "arm_r"),
        ("CC_Base_L_Arm", "CC_Base_R_Arm"),
        ("ARM LEFT", "ARM RIGHT"),
    ],
)
def test_names_of_sides(left, right):
    body = qf.Skeleton(
        ["lower", left, right, "level"], [-1, 0, 0, 0], [[0, 0, 0], [5, 1, 0], [-5, 1, 0], [0, 9, 0]]
    )
    rng = np.random.default_rng(0)
    q = qf.exp(0.2 * rng.standard_normal((60, 4, 3)))
    db = qf.MotionDatabase.from_motions([qf.Motion(q, fps=60, skeleton=body)], mirror=True)
    places, image = db.motion(0).positions(), db.motion(1).positions()
    np.testing.assert_allclose(image, places[:, [0, 2, 1, 3]] * np.float32([-1, 1, 1]), rtol=0, atol=1e-5)


def test_a_body_that_looks_along_x():
    body = qf.Skeleton(["hips", "LeftArm", "RightArm"], [-1, 0, 0], [[0.0, 0, 0], [1, 1, -5], [1, 1, 5]])
    q = qf.exp(np.full((60, 3, 3), 0.1))
    db = qf.MotionDatabase.from_motions([qf.Motion(q, fps=60, skeleton=body)], mirror=True)
    places, image = db.motion(0).positions(), db.motion(1).positions()
    np.testing.assert_allclose(image, places[:, [0, 2, 1]] * np.float32([1, 1, -1]), rtol=0, atol=1e-5)


def test_what_has_no_mirror_image_is_refused():
    q = np.tile([1.0, 0, 0, 0], (60, 3, 1))

    def refusal(names, parents, offsets):
        motion = qf.Motion(q, fps=60, skeleton=qf.Skeleton(names, parents, offsets))
        with pytest.raises(ValueError) as error:
            qf.MotionDatabase.from_motions([motion], mirror=True, clip_names=["walk"])
        return str(error.value)

    places = [[0.0, 0, 0], [5, 0, 0], [-5, 0, 0]]
    assert refusal(["hips", "lower", "level"], [-1, 0, 0], places) == (
        "mirror: expected left and right joints (LeftArm, l_arm, arm.L …) in walk, got hips, lower, level"
    )
    assert refusal(["hips", "LeftArm", "RightArm"], [-1, 0, 1], places) == (
        "mirror: expected LeftArm and RightArm at joints of one name, but for the side"
    )
    assert refusal(["hips", "LeftArm", "RightArm"], [-1, 0, 0], [[0.0, 0, 0], [5, 0, 0], [-5, 3, 0]]) == (
        "mirror: expected a body that is symmetric across x in walk, got LeftArm elsewhere in its parent than its partner's "
        "mirror image"
    )


def test_recordings(data_dir):
    paths = ["02/02_01", "14/14_05", "86/86_01", "63or64_golf/golf_01", "05/05_16"]
    motions = [qf.read_motion(data_dir / "cmu" / f"{path}.amc") for path in paths]
    check_mirrored(qf.MotionDatabase.from_motions(motions, mirror=True), 0)
