"""Bad files and bad places: one clear line each, and nothing is lost."""

import os
import pickle
from pathlib import Path

import numpy as np
import pytest
import quatfilt as qf
from formats.dialects import AMC, ASF, BVH


def refused(path, **options):
    with pytest.raises(qf.QuatfiltError) as caught:
        qf.read_motion(path, **options)
    message = str(caught.value)
    assert "\n" not in message
    assert message.startswith(f"{path}: ")
    return message.removeprefix(f"{path}: ")


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("a.bvh", b"", "the file is empty"),
        ("a.amc", b"", "the file is empty"),
        ("a.npz", b"", "the file is empty"),
        ("a.npz", b"PK\x03\x04 and no more", "not an .npz archive"),
        ("a.npz", b"\x93NUMPY\x01\x00", "not an .npz archive"),
        ("a.fbx", b"x", "expected .bvh, .amc or .npz, got .fbx"),
        ("a", b"x", "expected .bvh, .amc or .npz, got no extension"),
        ("a.asf", b"x", "a skeleton holds no motion: read the .amc, with this as skeleton="),
        (
            "a.bvh",
            BVH[:100].encode(),
            "line 5: CHANNELS: expected 6 like Xposition or Zrotation, got ``",
        ),
    ],
)
def test_bad_files(tmp_path, name, content, message):
    (tmp_path / name).write_bytes(content)
    (tmp_path / "skeleton.asx").write_text(ASF)
    assert refused(tmp_path / name) == message


@pytest.mark.parametrize("end", range(len(BVH)))
def test_every_truncation_is_read_or_refused(tmp_path, end):
    path = tmp_path / "a.bvh"
    path.write_text(BVH[:end])
    # A last row that lacks nothing but digits of its last number looks like any other without a final newline.
    ends = [at for at in range(len(BVH) + 1) if BVH[:at].endswith(" 60\n") or BVH[:at].endswith(" 61\n")]
    last_number = len(BVH) - len("62\n") + 1
    if end < ends[0]:
        refused(path)
    else:
        motion = qf.read_motion(path)
        assert len(motion) == (3 if end >= last_number else sum(end >= row for row in ends))
        assert (motion.notes == ()) == (end >= last_number)


def test_binary_files(tmp_path):
    noise = np.random.default_rng(0).bytes(5000)
    (tmp_path / "skeleton.asf").write_text(ASF)
    for name in ("a.bvh", "a.amc", "a.npz"):
        (tmp_path / name).write_bytes(noise)
        refused(tmp_path / name)
    (tmp_path / "skeleton.asf").write_bytes(noise)
    (tmp_path / "a.amc").write_text(AMC)
    with pytest.raises(qf.FileFormatError, match=r"skeleton\.asf: "):
        qf.read_motion(tmp_path / "a.amc")


def test_damaged_archives(tmp_path):
    path = tmp_path / "a.npz"
    np.savez_compressed(path, poses=np.random.default_rng(0).standard_normal((50, 156)), mocap_framerate=60)
    content = path.read_bytes()
    for at in (100, 3000, 20_000):
        path.write_bytes(content[:at] + b"\xff" * 40 + content[at + 40 :])
        assert refused(path) == "not an .npz archive, or a damaged one"
    for arrays, message in (
        ({"a": [1]}, "expected the arrays `poses` and `trans`, or `rotations`, got a"),
        ({"poses": np.zeros((2, 7))}, "poses: expected shape (frames, 66, 72, 156 or 165), got (2, 7)"),
        ({"poses": np.zeros((2, 66)), "trans": np.zeros(3)}, "trans: expected shape (2, 3), got (3,)"),
        ({"poses": np.zeros((2, 66)), "fps": -1}, "fps: expected a positive number, got -1"),
        ({"rotations": np.zeros((2, 1, 4))}, "no `translation`"),
    ):
        np.savez(path, **arrays)
        assert refused(path) == message


def test_places_that_cannot_be_read(tmp_path):
    assert refused(tmp_path / "missing.bvh") == "No such file or directory"
    (tmp_path / "folder.bvh").mkdir()
    assert refused(tmp_path / "folder.bvh") == "Is a directory"
    (tmp_path / "a.amc").write_text(AMC)
    with pytest.raises(qf.FileAccessError, match=r"missing\.asf: No such file"):
        qf.read_motion(tmp_path / "a.amc", skeleton=tmp_path / "missing.asf")
    with pytest.raises(qf.QuatfiltError):
        qf.read_motion("nul\0.bvh")


@pytest.fixture
def motion(tmp_path):
    (tmp_path / "a.bvh").write_text(BVH)
    return qf.read_motion(tmp_path / "a.bvh")


def not_written(path, motion):
    with pytest.raises(qf.QuatfiltError) as caught:
        qf.write_motion(path, motion)
    assert str(caught.value).startswith(f"{path}: ")
    return str(caught.value).removeprefix(f"{path}: ")


def test_places_that_cannot_be_written(tmp_path, motion):
    (tmp_path / "folder.bvh").mkdir()
    assert not_written(tmp_path / "folder.bvh", motion) == "Is a directory"
    assert not_written(tmp_path / "missing" / "b.bvh", motion) == "No such directory"
    assert not_written(tmp_path / "b.amc", motion) == "AMC is read only: write .bvh or .npz"
    assert not_written(tmp_path / "b.fbx", motion) == "expected .bvh or .npz, got .fbx"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.bvh", "folder.bvh"]


def test_a_folder_without_permission(tmp_path, motion, monkeypatch):
    """What an administrator may write, too, is told by the system's answer: it is made up here."""

    def deny(*_args, **_options):
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(Path, "open", deny)
    assert not_written(tmp_path / "b.bvh", motion) == "Permission denied"
    monkeypatch.undo()
    monkeypatch.setattr(os, "access", lambda *_: False)
    before = (tmp_path / "a.bvh").read_bytes()
    assert not_written(tmp_path / "a.bvh", motion) == "Permission denied"
    assert (tmp_path / "a.bvh").read_bytes() == before


@pytest.mark.parametrize("name", ["a.bvh", "a.npz"])
@pytest.mark.parametrize("interruption", [KeyboardInterrupt, OSError(28, "No space left on device")])
def test_an_interrupted_run_leaves_the_old_file(tmp_path, motion, monkeypatch, name, interruption):
    (tmp_path / name).write_text("old")

    def interrupt(*_args):
        raise interruption

    monkeypatch.setattr(Path, "replace", interrupt)
    with pytest.raises((KeyboardInterrupt, qf.FileAccessError)):
        qf.write_motion(tmp_path / name, motion)
    assert (tmp_path / name).read_text() == "old"
    assert not list(tmp_path.glob(".*")), "no temporary file is left"


def test_permissions_and_links_are_kept(tmp_path, motion):
    target = tmp_path / "target.bvh"
    target.write_text("old")
    target.chmod(0o640)
    (tmp_path / "link.bvh").symlink_to(target)
    qf.write_motion(tmp_path / "link.bvh", motion)
    assert (tmp_path / "link.bvh").is_symlink()
    assert target.stat().st_mode & 0o777 == 0o640
    assert len(qf.read_motion(target)) == 3


def test_options(tmp_path, motion):
    path = tmp_path / "a.bvh"
    for options, message in (
        ({"fps": 0}, "fps: expected a number above 0, got 0"),
        ({"first_frame": "skip"}, "first_frame: expected one of 'auto', 'keep', 'drop', got 'skip'"),
    ):
        with pytest.raises(ValueError) as caught:
            qf.read_motion(path, **options)
        assert str(caught.value) == message
    with pytest.raises(TypeError, match=r"skeleton: expected None for \.bvh"):
        qf.read_motion(path, skeleton="a.asf")
    with pytest.raises(TypeError, match="motion: expected a Motion, got ndarray"):
        qf.write_motion(path, motion.rotations)


def test_errors_are_values_and_travel(tmp_path):
    (tmp_path / "a.bvh").write_text("solid cube")
    with pytest.raises(ValueError) as caught:
        qf.read_motion(tmp_path / "a.bvh")
    error = caught.value
    assert (error.path, error.line) == (str(tmp_path / "a.bvh"), 1)
    assert str(pickle.loads(pickle.dumps(error))) == str(error)  # noqa: S301
    with pytest.raises(OSError) as caught:
        qf.read_motion(tmp_path / "b.bvh")
    assert str(pickle.loads(pickle.dumps(caught.value))) == str(caught.value)  # noqa: S301


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (
            (["a"], [0], [[0, 0, 0]]),
            "parents: expected −1 or the index of a joint before it for joint 0, got 0",
        ),
        ((["a"], [-1, 0], [[0, 0, 0]]), "parents: expected one parent for each of 1 names, got shape (2,)"),
        ((["a"], [-1], [[0, 0]]), "offsets: expected shape (1, 3), got (1, 2)"),
        ((["a"], [-1], [[0, 0, np.nan]]), "offsets: expected finite numbers, got nan"),
    ],
)
def test_skeletons(arguments, message):
    with pytest.raises(ValueError) as caught:
        qf.Skeleton(*arguments)
    assert str(caught.value) == message


def test_motions(motion):
    for changes, message in (
        ({"rotations": motion.rotations[:, :1]}, "rotations: expected 2 joints as in the skeleton, got 1"),
        ({"rotations": motion.rotations[:2]}, "translation: expected shape (2, 3), got (3, 3)"),
        (
            {
                "rotations": motion.rotations
                * np.array([1, 2, 1])[:, None, None]
                * np.array([1, 0.5])[:, None]
            },
            "rotations: expected unit quaternions, got norm 2 at frame 1, joint 0",
        ),
        ({"joint_translations": [1.0]}, "joint_translations: expected shape (3, 2, 3), got (1,)"),
        ({"fps": -1}, "fps: expected a number above 0, got -1"),
    ):
        with pytest.raises(ValueError) as caught:
            motion.replace(**changes)
        assert str(caught.value) == message
    with pytest.raises(TypeError, match=r"replace: expected one of rotations, .*, got 'names'"):
        motion.replace(names=[])
    with pytest.raises(AttributeError):
        motion.fps = 3
    assert len(motion.replace(rotations=np.zeros((0, 2, 4)), translation=np.zeros((0, 3))).positions()) == 0
