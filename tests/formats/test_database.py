"""The file of a motion database: comes back as it was, and nothing else is taken for it."""

import json
import re
import struct
import sys
import zlib

import numpy as np
import pytest
import quatfilt as qf
from quatfilt.evaluation.synthetic import walk
from quatfilt.reconstruction.database import file, writer

ARRAYS = (
    "rotations",
    "features",
    "heading",
    "translation",
    "starts",
    "skeleton_indices",
    "mean_rotations",
    "joint_weights",
    "parents",
)


@pytest.fixture(scope="module", name="db")
def database():
    clips = [walk(seconds=2), walk(seconds=1.5, seed=3)]
    return qf.MotionDatabase.from_motions(clips, mirror=True, clip_names=["één", "zwei"])


@pytest.fixture(name="path")
def saved(db, tmp_path):
    path = tmp_path / "walks.db"
    db.save(path)
    return path


def names(folder):
    """What a folder holds, hidden files too."""
    return sorted(path.name for path in folder.iterdir())


def test_what_was_saved_is_opened(db, path):
    other = qf.MotionDatabase.open(path, verify=True)
    for name in ARRAYS:
        mine, theirs = getattr(db, name), getattr(other, name)
        assert mine.dtype == theirs.dtype
        np.testing.assert_array_equal(mine, theirs)
    assert repr(other) == repr(db)
    assert (other.names, other.clip_names, other.fps, other.up) == (db.names, db.clip_names, db.fps, db.up)
    assert other.notes == db.notes
    for mine, theirs in zip((db.skeleton, *db.skeletons), (other.skeleton, *other.skeletons), strict=True):
        np.testing.assert_array_equal(mine.offsets, theirs.offsets)
        assert mine.end_sites == theirs.end_sites
        assert mine.centimetres_per_unit == theirs.centimetres_per_unit
    np.testing.assert_array_equal(other.motion(3).rotations, db.motion(3).rotations)


def test_arrays_are_mapped_and_cannot_be_written(path):
    db = qf.MotionDatabase.open(path)
    for name in ("rotations", "features", "heading", "translation"):
        array = getattr(db, name)
        assert not array.flags.writeable
        assert not array.flags.owndata
        assert array.ctypes.data % 64 == 0
        assert array.flags.c_contiguous


def test_the_same_database_gives_the_same_bytes(db, path, tmp_path):
    db.save(tmp_path / "again")
    qf.MotionDatabase.open(path).save(tmp_path / "copy")
    assert path.read_bytes() == (tmp_path / "again").read_bytes() == (tmp_path / "copy").read_bytes()


def test_an_open_database_is_saved_over_itself(path):
    db = qf.MotionDatabase.open(path)
    before = db.rotations.copy()
    db.graph = np.zeros((len(db), 2), int)
    db.save(path)
    np.testing.assert_array_equal(db.rotations, before)
    other = qf.MotionDatabase.open(path, verify=True)
    np.testing.assert_array_equal(other.graph, db.graph)
    np.testing.assert_array_equal(other.rotations, before)
    assert names(path.parent) == [path.name]


def test_the_layout_is_what_the_documentation_says(db, path):
    data = path.read_bytes()
    magic, version, crc, place, size, length, zeros, own = struct.unpack("<16sIIQQQ12sI", data[:64])
    assert (magic, version, length, zeros) == (b"\x89quatfiltdb\r\n\x1a\n\0", 1, len(data), bytes(12))
    assert zlib.crc32(data[:60]) == own
    text = data[place : place + size]
    assert zlib.crc32(text) == crc
    assert place + size == len(data)
    description = json.loads(text)
    for name, section in description["sections"].items():
        assert section["offset"] % 64 == 0, name
        count = int(np.prod(section["shape"]))
        array = np.frombuffer(data, section["dtype"], count, section["offset"]).reshape(section["shape"])
        assert zlib.crc32(array.tobytes()) == section["crc32"]
        if hasattr(db, name):
            np.testing.assert_array_equal(array, getattr(db, name))


def refused(path):
    with pytest.raises(qf.FileFormatError) as error:
        qf.MotionDatabase.open(path)
    assert error.value.path == str(path)
    assert str(error.value).startswith(f"{path}: ")
    return error.value.reason


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        (b"", "not a motion database: the file is empty"),
        (b"HIERARCHY\nROOT hips\n", "not a motion database"),
        (b"PK\x03\x04" + bytes(200), "not a motion database"),
        (writer.MAGIC.replace(b"\r\n", b"\n") + bytes(100), "not a motion database"),
        (writer.MAGIC[:7], "a damaged motion database: it ends after 7 bytes"),
        (writer.MAGIC + bytes(40), "a damaged motion database: it ends after 56 bytes"),
        (writer.MAGIC + bytes(100), "a damaged motion database: its header is not what was written"),
    ],
)
def test_foreign_files(tmp_path, content, reason):
    path = tmp_path / "other"
    path.write_bytes(content)
    assert refused(path) == reason


def test_no_file(tmp_path):
    for path, reason in ((tmp_path / "none", "No such file or directory"), (tmp_path, "Is a directory")):
        with pytest.raises(qf.FileAccessError) as error:
            qf.MotionDatabase.open(path)
        assert str(error.value) == f"{path}: {reason}"


@pytest.mark.parametrize("part", [0.001, 0.1, 0.5, 0.999])
def test_files_that_were_cut(path, part):
    data = path.read_bytes()
    path.write_bytes(data[: int(part * len(data))])
    assert (
        refused(path) == f"a damaged motion database: expected {len(data)} bytes, got {int(part * len(data))}"
    )


def test_files_that_have_grown(path):
    with path.open("ab") as handle:
        handle.write(b"!")
    size = path.stat().st_size
    assert refused(path) == f"a damaged motion database: expected {size - 1} bytes, got {size}"


def with_header(path, **changes):
    """Write a header whose check sum is right."""
    data = bytearray(path.read_bytes())
    fields = dict(
        zip(
            ("magic", "version", "crc", "place", "size", "length", "zeros", "own"),
            writer.HEADER.unpack(data[:64]),
            strict=True,
        )
    )
    fields |= changes
    header = writer.HEADER.pack(*fields.values())[:-4]
    data[:64] = header + struct.pack("<I", zlib.crc32(header))
    path.write_bytes(data)
    return fields


def test_newer_versions(path):
    with_header(path, version=2)
    assert refused(path) == (
        "a motion database of version 2, and this quatfilt reads up to 1: get a newer one"
    )


def test_every_byte_of_the_header_counts(path):
    data = path.read_bytes()
    for place in range(64):
        path.write_bytes(data[:place] + bytes([data[place] ^ 0x20]) + data[place + 1 :])
        refused(path)


def test_a_description_elsewhere(path):
    with_header(path, place=2**40)
    assert refused(path) == "a damaged motion database: its description lies outside"


def test_every_byte_of_the_description_counts(path):
    data = path.read_bytes()
    _, _, _, place, size, *_ = writer.HEADER.unpack(data[:64])
    for at in range(place, place + size, 97):
        path.write_bytes(data[:at] + bytes([data[at] ^ 1]) + data[at + 1 :])
        assert refused(path) == "a damaged motion database: its description is not what was written"


def test_check_sums_of_arrays_are_compared_when_asked(path):
    data = bytearray(path.read_bytes())
    sections = json.loads(data[slice(*described(data))])["sections"]
    for name, section in sections.items():
        if not np.prod(section["shape"]):
            continue
        spoilt = bytearray(data)
        spoilt[section["offset"] + 2] ^= 4
        path.write_bytes(spoilt)
        with pytest.raises(qf.FileFormatError) as error:
            qf.MotionDatabase.open(path, verify=True)
        assert re.fullmatch(rf"a damaged motion database: {name}.*", error.value.reason)


@pytest.mark.parametrize("name", ["starts", "skeleton_indices", "offsets", "mean_rotations", "joint_weights"])
def test_check_sums_of_short_arrays_are_always_compared(path, name):
    data = bytearray(path.read_bytes())
    section = json.loads(data[slice(*described(data))])["sections"][name]
    data[section["offset"] + 2] ^= 4
    path.write_bytes(data)
    assert refused(path).startswith(f"a damaged motion database: {name}")


def described(data):
    _, _, _, place, size, *_ = writer.HEADER.unpack(data[:64])
    return place, place + size


def with_description(path, change):
    """Write a description that is changed, and all check sums right."""
    data = path.read_bytes()
    start, stop = described(data)
    description = json.loads(data[start:stop])
    changed = change(description)
    text = json.dumps(description if changed is None else changed).encode()
    path.write_bytes(data[:start] + text)
    with_header(path, size=len(text), length=start + len(text), crc=zlib.crc32(text))


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        (lambda d: d.pop("names") and None, "no 'names'"),
        (lambda d: d["sections"].pop("rotations") and None, "no 'rotations'"),
        (lambda d: d.update(fps=0), "fps: expected a number above 0, got 0"),
        (lambda d: d.update(up=3), "up: expected an integer of at least 0 and at most 2, got 3"),
        (
            lambda d: d.update(parents=[5] * 21),
            "parents: expected −1 or the index of a joint before it for joint 0, got 5",
        ),
        (lambda d: d["clip_names"].pop() and None, r"starts: expected shape \(4,\), got \(5,\)"),
        (
            lambda d: d["names"].pop() and None,
            r"rotations: expected shape \(420, 20, 4\), got \(420, 21, 4\)",
        ),
        (
            lambda d: d["sections"]["features"].update(shape=[420, 62]),
            r"features: expected shape \(420, 63\), got \(420, 62\)",
        ),
        (lambda d: d["sections"]["rotations"].update(dtype="<f8"), "rotations: expected dtype <f4, got <f8"),
        (
            lambda d: d["sections"]["rotations"].update(offset=65),
            r"rotations: expected a place in the file, got .*",
        ),
        (
            lambda d: d["sections"]["heading"].update(offset=2**62),
            r"heading: expected a place in the file, got .*",
        ),
        (
            lambda d: d["sections"]["heading"].update(shape=[-1]),
            "heading: expected an integer of at least 0, got -1",
        ),
        (
            lambda d: d["sections"]["heading"].update(shape=[2**40]),
            "heading: expected a place in the file, got .*",
        ),
        (lambda _: [1, 2], "list indices must be integers or slices, not str"),
        (lambda _: 7, "'int' object is not subscriptable"),
    ],
)
def test_descriptions_that_do_not_fit(path, change, reason):
    with_description(path, change)
    assert re.fullmatch(f"a damaged motion database: {reason}", refused(path))


def test_what_cannot_be_written_is_refused(db, tmp_path):
    for target, reason in ((tmp_path, "Is a directory"), (tmp_path / "no" / "db", "No such directory")):
        with pytest.raises(qf.FileAccessError) as error:
            db.save(target)
        assert str(error.value) == f"{target}: {reason}"
    assert names(tmp_path) == []


def test_an_interrupted_save_leaves_the_old_file(db, path, monkeypatch):
    before = path.read_bytes()
    calls = iter(range(3))

    def interrupted(*_):
        if next(calls, None) is None:
            raise KeyboardInterrupt

    monkeypatch.setattr(file, "_append", interrupted)
    with pytest.raises(KeyboardInterrupt):
        db.save(path)
    assert path.read_bytes() == before
    assert names(path.parent) == [path.name]


def test_what_a_killed_process_left_is_removed_by_the_next_one(db, path):
    leftover = path.with_name(f".{path.name}.0123456789ab.unfinished")
    leftover.write_bytes(b"half")
    others = path.with_name(f".{path.name}x.0123456789ab.unfinished")
    others.write_bytes(b"of another file")
    with writer.Writer(str(path)):
        assert not leftover.exists()
        # One that is being written stays.
        db.save(path)
        assert len(names(path.parent)) == 3
    assert names(path.parent) == sorted([path.name, others.name])


@pytest.mark.skipif(sys.platform == "win32", reason="not on this platform: files are not sparse")
def test_millions_of_poses_are_opened_without_being_read(tmp_path):
    path = tmp_path / "large"
    qf.MotionDatabase.from_motions([walk(seconds=1)]).save(path)
    data = path.read_bytes()
    start, stop = described(data)
    description, poses = json.loads(data[start:stop]), 6_000_000
    # A hole of five gigabytes, beyond what 32 bits can count, where the poses would lie.
    place = len(data) + -len(data) % 64
    for name in ("rotations", "features", "heading", "translation"):
        shape = [poses, *description["sections"][name]["shape"][1:]]
        description["sections"][name].update(shape=shape, offset=place)
        place += 4 * int(np.prod(shape))
        place += -place % 64
    starts = np.array([0, poses])
    description["sections"]["starts"].update(offset=place, crc32=zlib.crc32(starts.tobytes()))
    text = json.dumps(description).encode()
    with path.open("r+b") as handle:
        handle.seek(place)
        handle.write(starts.tobytes())
        handle.write(text)
        length = handle.tell()
        header = writer.HEADER.pack(
            writer.MAGIC, 1, zlib.crc32(text), place + 16, len(text), length, bytes(12), 0
        )[:-4]
        handle.seek(0)
        handle.write(header + struct.pack("<I", zlib.crc32(header)))
    db = qf.MotionDatabase.open(path)
    assert len(db) == poses
    assert db.features.shape == (poses, 63)
    assert not db.features[-1].any()
    assert not db.rotations[poses // 2].any()
    assert 512 * path.stat().st_blocks < 0.01 * length
