"""BVH through the Python door: dialects, and files that come back as they were."""

import numpy as np
import pytest
import quatfilt as qf
import tolerances
from formats.dialects import BVH, ROWS
from quatfilt import _core
from scipy.spatial.transform import Rotation


@pytest.fixture
def read(tmp_path):
    def read(text, **options):
        path = tmp_path / "a.bvh"
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
        return qf.read_motion(path, **options)

    return read


@pytest.fixture
def again(tmp_path):
    def again(motion):
        path = tmp_path / "again.bvh"
        qf.write_motion(path, motion)
        return qf.read_motion(path, first_frame="keep"), _core.read_bvh(path.read_bytes())

    return again


def angle(a, b):
    return np.nanmax(qf.geodesic_distance(a, b))


def test_what_a_file_says(read):
    motion = read(BVH)
    assert repr(motion) == "Motion(3 frames of 2 joints, 120 fps, 0.025 s, float64)"
    assert motion.notes == ()
    assert motion.skeleton.names == ("Hips", "LeftUpLeg #1")
    assert motion.skeleton.parents.tolist() == [-1, 0]
    assert motion.skeleton.end_sites == (qf.EndSite(1, (0.0, -40.0, 0.0), "#5"),)
    assert motion.fps == 1 / 0.0083333
    np.testing.assert_array_equal(motion.translation, [[0, 1, 2], [0, 1, 3], [0, 1, 4]])
    expected = Rotation.from_euler("ZXY", [10, 20, 30], degrees=True).as_quat(scalar_first=True)
    np.testing.assert_allclose(motion.rotations[0, 0], expected, atol=tolerances.EULER)
    expected = Rotation.from_euler("XYZ", [42, 52, 62], degrees=True).as_quat(scalar_first=True)
    np.testing.assert_allclose(motion.rotations[2, 1], expected, atol=tolerances.EULER)
    root = Rotation.from_quat(motion.rotations[1, 0], scalar_first=True)
    np.testing.assert_allclose(
        motion.positions()[1], [[0, 1, 3], np.add([0, 1, 3], root.apply([5, -2, 0]))], atol=tolerances.FLOAT64
    )


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("\n", "\r\n"),
        ("Zrotation Xrotation Yrotation\n", "Zrotation Xrotation Yrotation \t\n"),
        ("Frames: 3\nFrame Time: ", "Frames:\t3\nFrame Time:\t"),
        ("HIERARCHY\n", "\ufeffHIERARCHY\n"),
        ("0 1 2 10", "-0.0 1.0e+000  2.00000000000000000\t1000e-002"),
        (" 62\n", " 62"),
        ("    End Site #5\n    {\n      OFFSET 0 -40 0\n    }\n", ""),
    ],
)
def test_dialects_that_mean_the_same(read, old, new):
    expected, motion = read(BVH), read(BVH.replace(old, new))
    assert motion.fps == expected.fps
    np.testing.assert_array_equal(motion.rotations, expected.rotations)
    np.testing.assert_array_equal(motion.translation, expected.translation)


@pytest.mark.parametrize(
    ("old", "new", "note"),
    [
        ("HIERARCHY\n", "", "line 1: HIERARCHY missing: the file starts with a root"),
        ("Frames: 3", "Frames: 5", "`Frames:` says 5, the file has 3: these are kept"),
    ],
)
def test_repairs_are_noted(read, old, new, note):
    motion = read(BVH.replace(old, new))
    assert motion.notes == (note,)
    assert len(motion) == 3


def test_missing_samples(read, again):
    motion = read(BVH.replace("11 21", "nan 21").replace("1 4 12", "nan 4 12"))
    np.testing.assert_array_equal(np.isnan(motion.rotations).all(axis=-1), [[0, 0], [1, 0], [0, 0]])
    np.testing.assert_array_equal(np.isnan(motion.translation), [[0, 0, 0], [0, 0, 0], [0, 1, 0]])
    back, (_, _, values, _) = again(motion)
    np.testing.assert_array_equal(back.rotations, motion.rotations)
    np.testing.assert_array_equal(values[1], [0, 1, 3, np.nan, 21, 31, 41, 51, 61])


def test_rotation_before_position_and_fewer_channels(read, again):
    text = BVH.replace(
        "6 Xposition Yposition Zposition Zrotation Xrotation Yrotation",
        "4 Yrotation Zposition Zrotation Xrotation",
    )
    text = text.replace("3 Xrotation Yrotation Zrotation", "1 Yrotation")
    motion = read(text.partition("Frames:")[0] + "Frames: 2\nFrame Time: 1\n10 7 20 30 40\n11 8 21 31 41\n")
    np.testing.assert_array_equal(motion.translation, [[0, 90, 7], [0, 90, 8]])
    expected = Rotation.from_euler("YZX", [10, 20, 30], degrees=True).as_quat(scalar_first=True)
    np.testing.assert_allclose(motion.rotations[0, 0], expected, atol=tolerances.EULER)
    half = np.radians(20)
    np.testing.assert_allclose(motion.rotations[0, 1], [np.cos(half), 0, np.sin(half), 0], atol=1e-15)
    turn = [np.cos(0.1), 0, np.sin(0.1), 0]
    back, (joints, *_) = again(motion.replace(rotations=qf.multiply(motion.rotations, turn)))
    assert joints[1][3] == ["Yrotation"], "a turn about the joint's only axis needs no other channel"
    assert angle(back.rotations, qf.multiply(motion.rotations, turn)) < tolerances.FILE_ANGLE


def test_what_the_channels_cannot_hold_gets_channels(read, again):
    text = BVH.replace("3 Xrotation Yrotation Zrotation", "1 Yrotation")
    text = text.replace("6 Xposition Yposition Zposition Zrotation", "5 Xposition Zposition Zrotation")
    motion = read(text.partition("Frames:")[0] + "Frames: 1\nFrame Time: 1\n1 2 10 20 30 40\n")
    moved = motion.replace(
        rotations=qf.multiply(motion.rotations, [0.6, 0.8, 0, 0]), translation=motion.translation + 1
    )
    back, (joints, *_) = again(moved)
    assert joints[0][3] == ["Yposition", "Xposition", "Zposition", "Zrotation", "Xrotation", "Yrotation"]
    assert joints[1][3] == ["Yrotation", "Xrotation", "Zrotation"]
    assert angle(back.rotations, moved.rotations) < tolerances.FILE_ANGLE
    np.testing.assert_allclose(back.translation, moved.translation, atol=1e-8)


def test_position_channels_on_every_joint_and_several_roots(read, again):
    channels = "CHANNELS 6 Xposition Yposition Zposition Zrotation Yrotation Xrotation"
    text = f"""HIERARCHY
ROOT a {{ OFFSET 0 0 0 {channels}
JOINT b {{ OFFSET 1 2 3 {channels} }} }}
ROOT prop {{ OFFSET 9 9 9 CHANNELS 0 }}
MOTION
Frames: 1
Frame Time: 0.1
1 2 3 90 0 0 4 5 6 0 0 0
"""
    motion = read(text)
    np.testing.assert_array_equal(motion.joint_translations, [[[1, 2, 3], [4, 5, 6], [9, 9, 9]]])
    np.testing.assert_allclose(motion.positions(), [[[1, 2, 3], [-4, 6, 9], [9, 9, 9]]], atol=1e-14)
    back, (_, _, values, _) = again(motion.replace(translation=[[7.0, 8, 9]]))
    np.testing.assert_array_equal(values, [[7, 8, 9, 90, 0, 0, 4, 5, 6, 0, 0, 0]])
    np.testing.assert_array_equal(back.joint_translations[0, 1], [4, 5, 6])


def test_read_write_read_is_the_identity(read, again):
    motion = read(BVH)
    back, (joints, frame_time, values, _) = again(motion)
    before = _core.read_bvh(BVH.encode())
    assert joints == before[0]
    assert frame_time == before[1] == (0.0083333, ".0083333")
    np.testing.assert_array_equal(values, before[2])
    np.testing.assert_array_equal(back.rotations, motion.rotations)


def test_fps(read, again):
    motion = read(BVH, fps=60)
    assert motion.fps == 60
    back, _ = again(motion)
    assert back.fps == 60
    assert again(read(BVH).replace(fps=30))[1][1][0] == pytest.approx(1 / 30, abs=1e-15)


def test_new_curves_are_continuous_and_begin_on_the_branch_of_the_file(read, again):
    degrees = np.linspace(350, 1500, 400)
    rows = "".join(f"0 0 0 {d} 80 0 {-d} 0 {2 * d}\n" for d in degrees)
    motion = read(BVH.replace("Frames: 3", "Frames: 400").replace(ROWS, rows))
    turn = [np.cos(0.01), np.sin(0.01), 0, 0]
    turned = motion.replace(rotations=-qf.multiply(turn, motion.rotations))
    back, (_, _, values, _) = again(turned)
    assert angle(back.rotations, turned.rotations) < tolerances.FILE_ANGLE
    assert np.abs(np.diff(values, axis=0)).max() < 20
    assert np.abs(values[0, 3:] - [350, 80, 0, -350, 0, 700]).max() < 20


def test_a_sample_that_changed_leaves_the_others_their_numbers(read, again):
    motion = read(BVH)
    q = motion.rotations.copy()
    q[1, 0] = qf.slerp(q[:, 0], [0.0, 1, 2], [0.3])[0]
    back, (_, _, values, _) = again(motion.replace(rotations=q))
    before = _core.read_bvh(BVH.encode())[2]
    np.testing.assert_array_equal(np.argwhere(values != before), [[1, 3], [1, 4], [1, 5]])
    assert angle(back.rotations, q) < tolerances.FILE_ANGLE


def test_float32(read, again):
    motion = read(BVH)
    narrow = motion.replace(rotations=motion.rotations.astype(np.float32))
    assert narrow.translation.dtype == np.float32
    _, (_, _, values, _) = again(narrow)
    np.testing.assert_array_equal(values, _core.read_bvh(BVH.encode())[2])


def test_other_numbers_of_frames(read, again):
    motion = read(BVH)
    shorter = motion.replace(rotations=motion.rotations[1:], translation=motion.translation[1:])
    back, (joints, *_) = again(shorter)
    assert joints == _core.read_bvh(BVH.encode())[0]
    assert angle(back.rotations, shorter.rotations) < tolerances.FILE_ANGLE


def rest_row_file(first, rows):
    names = "".join(
        f"JOINT j{i} {{ OFFSET 0 1 0 CHANNELS 3 Zrotation Yrotation Xrotation }}\n" for i in range(19)
    )
    head = "ROOT r { OFFSET 0 0 0 CHANNELS 6 Xposition Yposition Zposition Zrotation Yrotation Xrotation\n"
    table = [np.concatenate([[0, 90, 0], first])] + [
        np.concatenate([[0, 90, i], 20 + i + np.arange(60) % 7]) for i in range(rows)
    ]
    text = "\n".join(" ".join(map(str, row)) for row in table)
    return f"HIERARCHY\n{head}{names}}}\nMOTION\nFrames: {rows + 1}\nFrame Time: 0.01\n{text}\n"


def test_rest_row(read, again):
    first = np.zeros(60)
    first[9] = -21
    text = rest_row_file(first, 5)
    note = "the first row is a rest pose, no recording: left out, and put back when written"
    motion, kept, dropped = (read(text, first_frame=how) for how in ("auto", "keep", "drop"))
    assert (len(motion), len(kept), len(dropped)) == (5, 6, 5)
    assert (motion.notes, kept.notes, dropped.notes) == ((note,), (), ())
    np.testing.assert_array_equal(motion.rotations, kept.rotations[1:])
    values = _core.read_bvh(text.encode())[2]
    turned = motion.replace(rotations=qf.multiply(motion.rotations, [np.cos(0.1), 0, 0, np.sin(0.1)]))
    for written, rows in ((motion, values), (kept, values), (dropped, values[1:])):
        np.testing.assert_array_equal(again(written)[1][2], rows)
    np.testing.assert_array_equal(again(turned)[1][2][0], values[0])
    assert len(again(turned)[0]) == 6


@pytest.mark.parametrize("rows", [1, 5])
def test_no_rest_row(read, rows):
    smooth = rest_row_file(19.0 + np.arange(60) % 7, rows)
    assert len(read(smooth)) == rows + 1
    still = rest_row_file(np.zeros(60), 0)
    assert len(read(still)) == 1


def test_any_motion_is_written(again):
    skeleton = qf.Skeleton(["a", "b", "c"], [-1, 0, 0], [[1.0, 2, 3], [4, 5, 6], [7, 8, 9]])
    rng = np.random.default_rng(0)
    q = rng.standard_normal((50, 3, 4))
    q /= np.linalg.norm(q, axis=-1, keepdims=True)
    motion = qf.Motion(q, rng.standard_normal((50, 3)), fps=25, skeleton=skeleton)
    back, (joints, *_) = again(motion)
    assert angle(back.rotations, q) < tolerances.FILE_ANGLE
    np.testing.assert_allclose(back.positions(), motion.positions(), atol=1e-7)
    assert [len(joint[4]) for joint in joints] == [0, 1, 1]
    assert back.fps == 25
    moving = motion.replace(joint_translations=rng.standard_normal((50, 3, 3)))
    np.testing.assert_allclose(again(moving)[0].positions(), moving.positions(), atol=1e-7)
