"""Acclaim files through the Python door."""

import numpy as np
import pytest
import quatfilt as qf
import tolerances
from formats.dialects import AMC, ASF
from scipy.spatial.transform import Rotation


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "02.asf").write_text(ASF)
    (tmp_path / "02_01.amc").write_text(AMC)
    return tmp_path


def test_what_the_files_say(folder):
    motion = qf.read_motion(folder / "02_01.amc")
    assert repr(motion) == "Motion(2 frames of 3 joints, 120 fps, 0.01667 s, float64)"
    assert motion.notes == ("AMC has no frame rate: 120 fps assumed",)
    skeleton = motion.skeleton
    assert repr(skeleton) == "Skeleton(3 joints: root, thigh, shin; unit 5.644 cm)"
    assert skeleton.centimetres_per_unit == 2.54 / 0.45
    np.testing.assert_array_equal(skeleton.offsets, [[0, 0, 0], [0, 0, 0], [0, -7, 0]])
    assert skeleton.end_sites == (qf.EndSite(2, (0.0, -6.0, 0.0)),)
    np.testing.assert_array_equal(motion.translation, [[1, 2, 3], [1, 2, 4]])


def test_rotations_are_about_the_axes_of_the_bones(folder):
    motion = qf.read_motion(folder / "02_01.amc")
    for joint, axis, angles in (
        (0, [0, 0, 0], [10, 20, 30]),
        (1, [0, 0, 20], [5, 6, 7]),
        (2, [90, 0, 20], [8, 0, 0]),
    ):
        c = Rotation.from_euler("xyz", axis, degrees=True)
        expected = c * Rotation.from_euler("xyz", angles, degrees=True) * c.inv()
        got = Rotation.from_quat(motion.rotations[0, joint], scalar_first=True)
        assert (expected.inv() * got).magnitude() < tolerances.EULER


def test_radians_and_fps(folder):
    degrees = qf.read_motion(folder / "02_01.amc")
    lines = []
    for line in AMC.replace(":DEGREES", ":RADIANS").splitlines():
        name, *values = line.split()
        start = 3 if name == "root" else 0
        values[start:] = [repr(np.radians(float(value)).item()) for value in values[start:]]
        lines.append(" ".join([name, *values]))
    (folder / "02_02.amc").write_text("\n".join(lines))
    radians = qf.read_motion(folder / "02_02.amc", fps=60)
    assert radians.notes == ()
    assert radians.fps == 60
    np.testing.assert_allclose(radians.rotations, degrees.rotations, rtol=0, atol=tolerances.EULER)
    assert len(qf.read_motion(folder / "02_02.amc", first_frame="drop")) == 1


def test_bones_that_slide(folder):
    (folder / "02.asf").write_text(ASF.replace("dof rx\n", "dof tx rx\n"))
    (folder / "02_01.amc").write_text(AMC.replace("shin 8", "shin 2 8").replace("shin 9", "shin 3 9"))
    motion = qf.read_motion(folder / "02_01.amc")
    along = Rotation.from_euler("xyz", [90, 0, 20], degrees=True).apply([2, 0, 0])
    np.testing.assert_allclose(
        motion.joint_translations[0, 2], np.add([0, -7, 0], along), atol=tolerances.FLOAT64
    )


def test_where_the_skeleton_comes_from(folder):
    expected = qf.read_motion(folder / "02_01.amc").rotations
    (folder / "03.asf").write_text(ASF)
    assert (qf.read_motion(folder / "02_01.amc").rotations == expected).all()
    (folder / "other_01.amc").write_text(AMC)
    with pytest.raises(qf.FileFormatError, match=r"several skeletons beside it \(02.asf, 03.asf\): choose"):
        qf.read_motion(folder / "other_01.amc")
    first = qf.read_motion(folder / "other_01.amc", skeleton=folder / "02.asf")
    second = qf.read_motion(folder / "other_01.amc", skeleton=first.skeleton)
    assert (second.rotations == expected).all()
    (folder / "02.asf").unlink()
    (folder / "03.asf").rename(folder / "only.ASX")
    assert (qf.read_motion(folder / "other_01.amc").rotations == expected).all()
    (folder / "only.ASX").unlink()
    with pytest.raises(
        qf.FileFormatError, match=r"no skeleton: expected an \.asf file beside it, or skeleton="
    ):
        qf.read_motion(folder / "other_01.amc")


def test_the_skeleton_must_be_of_a_file(folder):
    skeleton = qf.Skeleton(["root"], [-1], [[0.0, 0, 0]])
    with pytest.raises(ValueError, match=r"skeleton: expected one that was read with an \.asf file"):
        qf.read_motion(folder / "02_01.amc", skeleton=skeleton)


def test_written_as_bvh(folder):
    motion = qf.read_motion(folder / "02_01.amc")
    qf.write_motion(folder / "a.bvh", motion)
    back = qf.read_motion(folder / "a.bvh")
    assert qf.geodesic_distance(back.rotations, motion.rotations).max() < tolerances.FILE_ANGLE
    np.testing.assert_allclose(back.positions(), motion.positions(), atol=1e-7)
    assert back.skeleton.end_sites == motion.skeleton.end_sites
