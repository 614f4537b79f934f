"""NumPy archives: AMASS, SMPL, and our own."""

import numpy as np
import pytest
import quatfilt as qf
import tolerances


def amass(columns=156, frames=40):
    rng = np.random.default_rng(0)
    return {
        "poses": rng.standard_normal((frames, columns)),
        "trans": rng.standard_normal((frames, 3)),
        "betas": rng.standard_normal(16),
        "gender": np.array("female"),
        "mocap_framerate": np.array(120.0),
        "dmpls": rng.standard_normal((frames, 8)),
    }


@pytest.fixture
def path(tmp_path):
    return tmp_path / "a.npz"


@pytest.mark.parametrize(
    ("columns", "joints", "last"),
    [(66, 22, "right_wrist"), (72, 24, "right_hand"), (156, 52, "right_thumb3"), (165, 55, "right_thumb3")],
)
def test_amass_round_trip(path, columns, joints, last):
    arrays = amass(columns)
    np.savez(path, **arrays)
    motion = qf.read_motion(path)
    assert motion.rotations.shape == (40, joints, 4)
    assert motion.fps == 120
    assert motion.skeleton.names[-1] == last
    assert motion.skeleton.centimetres_per_unit == 100
    assert motion.notes == ("bone lengths are not in the file: all joints lie at the root",)
    np.testing.assert_allclose(
        motion.rotations, qf.exp(arrays["poses"].reshape(40, -1, 3) / 2), atol=tolerances.ALGEBRA
    )
    qf.write_motion(path, motion)
    with np.load(path) as back:
        assert set(back.files) == set(arrays)
        for name, array in arrays.items():
            np.testing.assert_array_equal(back[name], array)


def test_parents_of_the_fingers(path):
    np.savez(path, **amass(165))
    skeleton = qf.read_motion(path).skeleton
    above = {
        name: skeleton.names[parent] for name, parent in zip(skeleton.names, skeleton.parents, strict=True)
    }
    assert above["left_index1"] == above["left_thumb1"] == "left_wrist"
    assert above["right_pinky3"] == "right_pinky2"
    assert above["right_pinky1"] == "right_wrist"
    assert above["jaw"] == "head"
    assert above["left_collar"] == "spine3"


def test_changed_poses(path):
    arrays = amass(165) | {"root_orient": np.zeros((40, 3)), "pose_hand": np.zeros((40, 90))}
    del arrays["mocap_framerate"]
    arrays["mocap_frame_rate"] = np.array(60.0)
    arrays["poses"][:, :3] = [0, 0, 5]  # beyond half a turn
    np.savez(path, **arrays)
    motion = qf.read_motion(path)
    turn = [np.cos(0.1), 0, 0, np.sin(0.1)]
    turned = motion.replace(rotations=qf.multiply(motion.rotations, turn), fps=30)
    qf.write_motion(path, turned)
    back = qf.read_motion(path)
    assert back.fps == 30
    assert qf.geodesic_distance(back.rotations, turned.rotations).max() < tolerances.FLOAT64
    with np.load(path) as written:
        np.testing.assert_allclose(written["poses"][:, :3], np.tile([0, 0, 5.2], (40, 1)), atol=1e-12)
        np.testing.assert_array_equal(written["root_orient"], written["poses"][:, :3])
        np.testing.assert_array_equal(written["pose_hand"], written["poses"][:, 75:])
    shorter = motion.replace(rotations=motion.rotations[:10], translation=motion.translation[:10])
    qf.write_motion(path, shorter)
    with np.load(path) as written:
        assert written["poses"].shape == (10, 165)
        assert "dmpls" not in written.files
        assert written["betas"].shape == (16,)


def test_frame_rate_is_asked_for(path):
    arrays = amass()
    del arrays["mocap_framerate"]
    np.savez(path, **arrays)
    with pytest.raises(qf.FileFormatError, match="no `mocap_framerate` or `mocap_frame_rate`: give fps="):
        qf.read_motion(path)
    assert qf.read_motion(path, fps=100).fps == 100


def test_smpl_as_bvh(path):
    np.savez(path, **amass(72))
    motion = qf.read_motion(path)
    qf.write_motion(path.with_suffix(".bvh"), motion)
    back = qf.read_motion(path.with_suffix(".bvh"))
    assert back.skeleton.names != motion.skeleton.names, "BVH is depth first"
    order = [back.skeleton.index(name) for name in motion.skeleton.names]
    assert qf.geodesic_distance(back.rotations[:, order], motion.rotations).max() < tolerances.FILE_ANGLE


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("moving", [False, True])
def test_own_archives(path, dtype, moving):
    rng = np.random.default_rng(1)
    q = qf.exp(rng.standard_normal((7, 2, 3))).astype(dtype)
    skeleton = qf.Skeleton(
        ["a", "b"],
        [-1, 0],
        [[0.0, 0, 0], [1, 2, 3]],
        centimetres_per_unit=5,
        end_sites=[(1, (0, 1, 0), "#5")],
    )
    local = rng.standard_normal((7, 2, 3)) if moving else None
    motion = qf.Motion(q, rng.standard_normal((7, 3)), fps=50, skeleton=skeleton, joint_translations=local)
    qf.write_motion(path, motion)
    back = qf.read_motion(path)
    assert back.rotations.dtype == dtype
    np.testing.assert_array_equal(back.rotations, motion.rotations)
    np.testing.assert_array_equal(back.translation, motion.translation)
    np.testing.assert_array_equal(back.positions(), motion.positions())
    assert back.skeleton.names == skeleton.names
    assert back.skeleton.end_sites == skeleton.end_sites
    assert (back.fps, back.skeleton.centimetres_per_unit) == (50, 5)
