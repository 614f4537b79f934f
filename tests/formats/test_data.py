"""Real files: each opens or is refused with one line, and comes back as it was."""

import numpy as np
import pytest
import quatfilt as qf
import tolerances
from plugins.data import DATA
from quatfilt import _core

BVH = sorted(path.name for path in DATA.glob("bvh/*.bvh"))
PAIRS = [name[:5] for name in BVH if name.endswith(".mb.bvh")]

REFUSED = {
    "output1_nohierarchy.bvh": "line 1: MOTION without a HIERARCHY before it: the file has no skeleton"
}
REPAIRED = {"nan_row_sideskip.bvh": ("line 905: 3 values are not a number: kept as missing samples",)}
CUT = {"07_12.amc", "golf_01.amc"}

SAME_JOINTS = {
    "root": "Hips",
    "lhipjoint": "LHipJoint",
    "lfemur": "LeftUpLeg",
    "ltibia": "LeftLeg",
    "lfoot": "LeftFoot",
    "ltoes": "LeftToeBase",
    "rhipjoint": "RHipJoint",
    "rfemur": "RightUpLeg",
    "rtibia": "RightLeg",
    "rfoot": "RightFoot",
    "rtoes": "RightToeBase",
    "lowerback": "LowerBack",
    "upperback": "Spine",
    "thorax": "Spine1",
}
"""Joints with the same offsets in ASF and in its conversion, which leaves out the length of the thorax."""

SAME_ROTATIONS = SAME_JOINTS | {
    "lowerneck": "Neck",
    "upperneck": "Neck1",
    "head": "Head",
    "lclavicle": "LeftShoulder",
    "lhumerus": "LeftArm",
    "lradius": "LeftForeArm",
    "lwrist": "LeftHand",
    "lhand": "LeftFingerBase",
    "lfingers": "LeftHandIndex1",
    "lthumb": "LThumb",
    "rclavicle": "RightShoulder",
    "rhumerus": "RightArm",
    "rradius": "RightForeArm",
    "rwrist": "RightHand",
    "rhand": "RightFingerBase",
    "rfingers": "RightHandIndex1",
    "rthumb": "RThumb",
}


def rests(name):
    return name.endswith((".mb.bvh", ".daz.bvh"))


@pytest.mark.parametrize("name", BVH)
def test_bvh(data_dir, tmp_path, name):
    path = data_dir / "bvh" / name
    if name in REFUSED:
        with pytest.raises(qf.FileFormatError) as caught:
            qf.read_motion(path)
        assert str(caught.value) == f"{path}: {REFUSED[name]}"
        return
    motion = qf.read_motion(path)
    rest = ("the first row is a rest pose, no recording: left out, and put back when written",)
    assert motion.notes == (rest if rests(name) else REPAIRED.get(name, ()))
    qf.write_motion(tmp_path / name, motion)
    back = qf.read_motion(tmp_path / name)
    np.testing.assert_array_equal(back.rotations, motion.rotations)
    np.testing.assert_array_equal(back.positions(), motion.positions())
    before, after = (_core.read_bvh(file.read_bytes()) for file in (path, tmp_path / name))
    assert after[:2] == before[:2]
    np.testing.assert_array_equal(after[2], before[2])

    turn = qf.exp(1e-3 * np.random.default_rng(0).standard_normal((*motion.rotations.shape[:-1], 3)))
    turned = motion.replace(rotations=qf.multiply(motion.rotations, turn))
    qf.write_motion(tmp_path / name, turned)
    back = qf.read_motion(tmp_path / name)
    assert len(back) == len(turned)
    assert np.nanmax(qf.geodesic_distance(back.rotations, turned.rotations)) < tolerances.FILE_ANGLE


@pytest.mark.parametrize("folder", sorted(path.name for path in DATA.glob("cmu/*")))
def test_amc(data_dir, folder):
    for path in sorted((data_dir / "cmu" / folder).glob("*.amc")):
        motion = qf.read_motion(path)
        assert motion.notes[-1] == "AMC has no frame rate: 120 fps assumed"
        assert len(motion.notes) == 1 + (path.name in CUT), motion.notes
        assert np.isfinite(motion.positions()).all()
        assert motion.skeleton.centimetres_per_unit == pytest.approx(5.644, abs=1e-3)


@pytest.mark.parametrize("trial", PAIRS)
def test_amc_equals_its_conversion(data_dir, trial):
    amc = qf.read_motion(data_dir / "cmu" / trial[:2] / f"{trial}.amc")
    bvh = qf.read_motion(data_dir / "bvh" / f"{trial}.mb.bvh")
    assert len(amc) == len(bvh)
    np.testing.assert_allclose(amc.translation, bvh.translation, rtol=0, atol=tolerances.PAIR_POSITION)
    a = [amc.skeleton.index(name) for name in SAME_ROTATIONS]
    b = [bvh.skeleton.index(name) for name in SAME_ROTATIONS.values()]
    angles = qf.geodesic_distance(amc.rotations[:, a], bvh.rotations[:, b])
    assert np.degrees(angles.max()) < tolerances.PAIR_ANGLE
    positions = amc.positions()[:, a[: len(SAME_JOINTS)]], bvh.positions()[:, b[: len(SAME_JOINTS)]]
    np.testing.assert_allclose(*positions, rtol=0, atol=tolerances.PAIR_POSITION)
