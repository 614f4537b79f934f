"""Which joints of a skeleton are its legs."""

import json

import numpy as np
import pytest
import quatfilt as qf
from quatfilt.evaluation.synthetic import walk
from quatfilt.motion.legs import find_legs, foot_joints, words

NAMES = {
    "bvh": ("LeftUpLeg", "LeftLeg", "LeftFoot", "LeftToeBase"),
    "bvh by parts": ("LeftHip", "LeftKnee", "LeftAnkle", "LeftToe"),
    "namespace": ("mixamorig:LeftUpLeg", "mixamorig:LeftLeg", "mixamorig:LeftFoot", "mixamorig:LeftToeBase"),
    "glued namespace": (
        "mixamorigLeftUpLeg",
        "mixamorigLeftLeg",
        "mixamorigLeftFoot",
        "mixamorigLeftToeBase",
    ),
    "path": ("|Rig|LeftUpLeg", "|Rig|LeftLeg", "|Rig|LeftFoot", "|Rig|LeftToeBase"),
    "acclaim": ("lfemur", "ltibia", "lfoot", "ltoes"),
    "daz": ("lThigh", "lShin", "lFoot", "lToe"),
    "3ds max": ("Bip01 L Thigh", "Bip01 L Calf", "Bip01 L Foot", "Bip01 L Toe0"),
    "character creator": ("CC_Base_L_Thigh", "CC_Base_L_Calf", "CC_Base_L_Foot", "CC_Base_L_ToeBase"),
    "smpl": ("left_hip", "left_knee", "left_ankle", "left_foot"),
    "smpl, short": ("L_Hip", "L_Knee", "L_Ankle", "L_Foot"),
    "unreal": ("thigh_l", "calf_l", "foot_l", "ball_l"),
    "blender": ("thigh.L", "shin.L", "foot.L", "toe.L"),
    "blender, numbered": ("thigh.L.001", "shin.L.001", "foot.L.001", "toe.L.001"),
    "unity": ("LeftUpperLeg", "LeftLowerLeg", "LeftFoot", "LeftToes"),
    "kinect": ("HIP_LEFT", "KNEE_LEFT", "ANKLE_LEFT", "FOOT_LEFT"),
    "vrm": ("J_Bip_L_UpperLeg", "J_Bip_L_LowerLeg", "J_Bip_L_Foot", "J_Bip_L_ToeBase"),
    "small letters": ("leftupleg", "leftleg", "leftfoot", "lefttoebase"),
    "biped": ("b_l_thigh", "b_l_shin", "b_l_foot", "b_l_toe"),
    "capital side": ("LHip", "LKnee", "LAnkle", "LToe"),
    "side last": ("HipLeft", "KneeLeft", "AnkleLeft", "ToeLeft"),
}

MIRRORED = {"left": "right", "Left": "Right", "LEFT": "RIGHT", "l": "r", "L": "R"}


def mirrored(name):
    """The name of the other side."""
    for left in ("left", "Left", "LEFT"):
        if left in name:
            return name.replace(left, MIRRORED[left])
    for left, right in (
        ("_L_", "_R_"),
        (" L ", " R "),
        ("_l_", "_r_"),
        (".L", ".R"),
        ("L_", "R_"),
        ("_l", "_r"),
    ):
        if left in name:
            return name.replace(left, right, 1)
    return MIRRORED.get(name[0], "other " + name[0]) + name[1:]


def body(names, *, extra=()):
    """Two legs and two arms; `extra` joints are ``(name, parent's name, offset)``."""
    left = [("Hips", None, (0, 95, 0)), ("Spine", "Hips", (0, 30, 0))]
    for sign, own in ((1, names), (-1, [mirrored(name) for name in names])):
        steps = ((sign * 9, -4, 0), (0, -43, 0), (0, -42, 0), (0, -7, 13))
        above = "Hips"
        for name, offset in zip(own, steps, strict=True):
            left.append((name, above, offset))
            above = name
        above = "Spine"
        for name, offset in zip(
            ("Shoulder", "Elbow", "Hand"), ((sign * 18, 20, 0), (0, -28, 0), (0, -26, 0)), strict=True
        ):
            left.append((f"{name}{sign}", above, offset))
            above = f"{name}{sign}"
    joints = [*left, *extra]
    order = [name for name, _, _ in joints]
    parents = [-1 if parent is None else order.index(parent) for _, parent, _ in joints]
    return qf.Skeleton(order, parents, np.array([offset for _, _, offset in joints], float))


def named(skeleton, legs):
    return [tuple(skeleton.names[joint] for joint in (leg.hip, leg.knee, leg.ankle, leg.toe)) for leg in legs]


@pytest.mark.parametrize("names", NAMES.values(), ids=NAMES)
def test_legs_are_found_by_the_names_that_programs_use(names):
    skeleton = body(names)
    legs = find_legs(skeleton)
    assert [leg.side for leg in legs] == ["left", "right"]
    assert named(skeleton, legs) == [names, tuple(map(mirrored, names))]
    assert [leg.length for leg in legs] == [85, 85]
    assert named(skeleton, find_legs(skeleton, feet="topology")) == named(skeleton, legs)


def test_joints_that_share_a_bone_and_controls_are_passed_over():
    names = NAMES["unreal"]
    extra = [("ik_foot_root", "Hips", (0, -95, 0)), ("ik_foot_l", "ik_foot_root", (9, 0, 0))]
    skeleton = body(
        names, extra=[*extra, ("foot_l_roll", "foot_l", (0, -5, 0)), ("heel_l", "foot_l", (0, -7, -4))]
    )
    assert named(skeleton, find_legs(skeleton))[0] == names
    chain = ["Hips", "LeftUpLeg", "LeftUpLegTwist", "LeftLeg", "LeftLegRoll", "LeftFoot"]
    offsets = [(0, 90, 0), (9, 0, 0), (0, -20, 0), (0, -22, 0), (0, -21, 0), (0, -21, 0)]
    (leg,) = find_legs(qf.Skeleton(chain, range(-1, 5), np.array(offsets, float)))
    assert (chain[leg.hip], chain[leg.knee], chain[leg.ankle], leg.toe) == (
        "LeftUpLeg",
        "LeftLeg",
        "LeftFoot",
        None,
    )
    assert leg.length == 84


def test_nothing_is_claimed_where_there_are_no_legs():
    line = qf.Skeleton([f"joint{i}" for i in range(6)], range(-1, 5), np.ones((6, 3)))

    for feet in ("auto", "topology"):
        assert find_legs(line, feet=feet) == ()
    short = qf.Skeleton(["hips", "LeftFoot"], [-1, 0], [[0.0, 90, 0], [9, -90, 0]])
    assert find_legs(short) == ()
    # Six legs: a side has three feet, and which of them is meant is not known.
    names, parents, offsets = ["body"], [-1], [(0.0, 5, 0)]
    for side, sign in (("l", 1), ("r", -1)):
        for pair in range(3):
            for part, name in enumerate(("hip", "knee", "foot")):
                names.append(f"{side}_{name}_{pair}")
                parents.append(0 if part == 0 else len(names) - 2)
                offsets.append((sign * 2.0, -1.0, pair * 3.0 if part == 0 else 0.0))
    crab = qf.Skeleton(names, parents, offsets)
    for feet in ("auto", "topology"):
        assert find_legs(crab, feet=feet) == ()


def test_callers_may_name_the_feet():
    skeleton = body(("tl", "sl", "al", "bl"), extra=[("toe2", "al", (0, -7, 10))])
    assert find_legs(skeleton) == ()
    (leg,) = find_legs(skeleton, feet={"left": ["al", "bl"]})
    assert named(skeleton, [leg]) == [("tl", "sl", "al", "bl")]
    (leg,) = find_legs(skeleton, feet={"right": ["Spine", "Elbow1", "Hand1"]})
    assert (leg.side, leg.toe, skeleton.names[leg.knee]) == ("right", None, "Elbow1")
    for feet, message in (
        ({"left": ["foot"]}, "feet: expected names of the skeleton's joints, got 'foot'"),
        ({"middle": ["al"]}, "feet: expected a dict with 'left' and 'right', got 'middle'"),
        ({"left": []}, r"feet\['left'\]: expected ankle and toe, or hip, knee, ankle and toe, got 0 names"),
        ({"left": ["Hips"]}, r"feet\['left'\]: expected an ankle below a shank and a thigh, got 'Hips'"),
        ({"left": ["al", "Spine"]}, r"feet\['left'\]: expected a toe below the ankle"),
        (
            {"left": ["al", "sl", "tl"]},
            r"feet\['left'\]: expected hip, knee and ankle each below the one before",
        ),
        ("names", "feet: expected 'auto', 'topology' or a dict"),
    ):
        with pytest.raises(ValueError, match=message):
            find_legs(skeleton, feet=feet)


def test_words_of_a_name():
    assert words("mixamorig:LeftToe_End") == ("left", ("toe", "end"))
    assert words("rfoot") == ("right", ("foot",))
    assert words("Ball") == (None, ("ball",))
    assert words("lower") == (None, ("lower",))
    assert words("左足首") == ("left", ("足首",))


def test_foot_joints_are_those_of_legs_or_have_words_for_feet():
    skeleton = body(
        NAMES["bvh"], extra=[("football", "Hips", (0, 0, 30)), ("LeftToeEnd", "LeftToeBase", (0, 0, 5))]
    )
    assert [skeleton.names[joint] for joint in foot_joints(skeleton)] == [
        *("LeftFoot", "LeftToeBase", "RightFoot", "RightToeBase")
    ]
    alone = qf.Skeleton(["root", "a foot", "b"], [-1, 0, 0], np.zeros((3, 3)))
    assert foot_joints(alone) == [1]


WITHOUT_LEGS = ("full_precision_frame_time", "rotation_first_root")
"""Two files of two and four joints."""


def test_legs_of_all_files(data_dir):
    files = [*data_dir.glob("bvh/*.bvh"), *data_dir.glob("trackers/*.bvh")]
    files += [next(folder.glob("*.amc")) for folder in data_dir.glob("cmu/*")]
    found = {}
    for path in files:
        try:
            skeleton = qf.read_motion(path).skeleton
        except qf.FileFormatError:
            continue  # a file that is broken on purpose
        legs = find_legs(skeleton)
        assert len(legs) == (0 if path.stem in WITHOUT_LEGS else 2), path
        by_topology = find_legs(skeleton, feet="topology")
        found[path.name] = {leg.ankle for leg in legs} == {leg.ankle for leg in by_topology}
    assert len(found) == len(files) - 1
    # Two takes of video have legs of unequal length.
    assert sum(found.values()) >= len(found) - 2, json.dumps(found)


def test_slide_does_not_depend_on_a_unit_that_is_not_known():

    motion = walk(seconds=2)
    noisy = motion.replace(rotations=qf.add_gaussian_noise(motion.rotations, sigma=0.003, rng=0))
    leg = find_legs(motion.skeleton)[0].length
    assert qf.metrics.foot_scale(motion) == 1
    for unit in (1 / 6, 0.01, 25.4):
        skeleton = qf.Skeleton(motion.skeleton.names, motion.skeleton.parents, motion.skeleton.offsets * unit)
        other = noisy.replace(skeleton=skeleton, translation=noisy.translation * unit)
        assert qf.metrics.foot_scale(other) == pytest.approx(90 / (leg * unit))
        long = noisy.replace(
            skeleton=qf.Skeleton(
                motion.skeleton.names, motion.skeleton.parents, motion.skeleton.offsets * 90 / leg
            ),
            translation=noisy.translation * 90 / leg,
        )
        assert qf.metrics.foot_slide(other) == pytest.approx(qf.metrics.foot_slide(long))
        told = qf.report(other, other)
        assert told.foot_scale == told.as_dict()["foot_scale"] == qf.metrics.foot_scale(other)
        assert "the unit of the skeleton is not known" in str(told)
        known = other.replace(
            skeleton=qf.Skeleton(
                motion.skeleton.names,
                motion.skeleton.parents,
                motion.skeleton.offsets * unit,
                centimetres_per_unit=1 / unit,
            )
        )
        assert qf.metrics.foot_scale(known) == 1
    assert "the unit of the skeleton" not in str(qf.report(noisy, noisy))
