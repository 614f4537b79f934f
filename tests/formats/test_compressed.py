"""Files of compressed rotations: what is saved is loaded, and anything else is refused."""

import dataclasses
import pickle
import struct
import zlib

import clips
import numpy as np
import pytest
import quatfilt as qf
import tolerances


def small(frames=120, joints=3):
    return qf.compress(clips.smooth(np.random.default_rng(0), frames, joints), tolerance=0.01)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("shape", [(0, 2, 4), (0, 4), (1, 4), (1, 1, 4), (5, 0, 4), (40, 2, 4), (40, 4)])
def test_round_trip(tmp_path, shape, dtype):
    frames, joints = shape[0], int(np.prod(shape[1:-1]))
    q = (
        clips.smooth(np.random.default_rng(1), frames, max(joints, 1))[:, :joints]
        .reshape(shape)
        .astype(dtype)
    )
    compressed = qf.compress(q, tolerance=0.01)
    path = tmp_path / "clip.qfc"
    compressed.save(path)
    loaded = qf.Compressed.load(path)
    assert loaded == compressed
    assert path.stat().st_size == loaded.nbytes
    assert (loaded.frames, loaded.joints, loaded.dtype) == (frames, joints, np.dtype(dtype))
    back = loaded.decompress()
    assert back.shape == shape
    assert back.dtype == dtype
    np.testing.assert_array_equal(back, compressed.decompress())
    assert pickle.loads(pickle.dumps(loaded)) == loaded  # noqa: S301 - our own


def test_either_backend_reads_the_other(tmp_path):
    path = tmp_path / "clip.qfc"
    small().save(path)
    back = qf.Compressed.load(path).decompress()
    with qf.use_backend("numpy"):
        other, own = qf.Compressed.load(path), small()
        # The measured error differs by roundings; the file's numbers do not.
        assert abs(other.max_error - own.max_error) < tolerances.FLOAT64
        assert dataclasses.replace(own, max_error=other.max_error) == other
        np.testing.assert_array_equal(qf.Compressed.load(path).decompress(), back)


def test_damaged_files_are_refused(tmp_path):
    path = tmp_path / "clip.qfc"
    small(40, 2).save(path)
    data = path.read_bytes()
    damaged = tmp_path / "damaged.qfc"
    rng = np.random.default_rng(2)
    for place in range(len(data)):
        changed = bytearray(data)
        changed[place] ^= 1 << rng.integers(8)
        damaged.write_bytes(changed)
        with pytest.raises(qf.FileFormatError, match=r"damaged\.qfc: ") as error:
            qf.Compressed.load(damaged)
        assert error.value.path == str(damaged)
    for length in range(len(data)):
        damaged.write_bytes(data[:length])
        with pytest.raises(qf.FileFormatError):
            qf.Compressed.load(damaged)
    damaged.write_bytes(data + b"\0")
    with pytest.raises(qf.FileFormatError, match=r"expected .* bytes, got"):
        qf.Compressed.load(damaged)


def forged(data, place, form, value):
    """Change a number of the header, and mend the checksum."""
    body = bytearray(data[:-4])
    struct.pack_into(form, body, place, value)
    return bytes(body) + struct.pack("<I", zlib.crc32(body))


@pytest.mark.parametrize(
    ("place", "form", "value", "reason"),
    [
        (0, "8s", b"BVH file", "expected compressed rotations, got another kind of file"),
        (8, "B", 2, "expected version 1 of compressed rotations, got 2"),
        (9, "B", 16, "damaged: the header holds impossible values"),
        (10, "B", 1, "damaged: the header holds impossible values"),
        (12, "<I", 1 << 31, "damaged: the header holds impossible values"),
        (16, "<Q", 1 << 63, "damaged: the header holds impossible values"),
        (32, "<Q", 1 << 63, "expected 9223372036854775852 bytes, got "),
    ],
)
def test_forged_files_are_refused_without_a_large_allocation(tmp_path, place, form, value, reason):
    path = tmp_path / "clip.qfc"
    small().save(path)
    path.write_bytes(forged(path.read_bytes(), place, form, value))
    with pytest.raises(qf.FileFormatError) as error:
        qf.Compressed.load(path)
    assert str(error.value).startswith(f"{path}: {reason}")


def test_more_than_fits_into_memory_is_refused(tmp_path):
    path = tmp_path / "clip.qfc"
    small(10, 1).save(path)
    path.write_bytes(forged(path.read_bytes(), 16, "<Q", 1 << 36))
    with pytest.raises(MemoryError):
        qf.Compressed.load(path).decompress()


def test_a_forged_stream_is_some_clip(tmp_path):
    path = tmp_path / "clip.qfc"
    small(40, 2).save(path)
    data = path.read_bytes()
    rng = np.random.default_rng(3)
    for _ in range(300):
        path.write_bytes(forged(data, int(rng.integers(40, len(data) - 4)), "B", int(rng.integers(256))))
        assert qf.Compressed.load(path).decompress().shape == (40, 2, 4)


def test_other_files_are_refused(tmp_path):
    for name, data in {"empty": b"", "text": b"HIERARCHY\nROOT hips\n", "zeros": bytes(100)}.items():
        path = tmp_path / name
        path.write_bytes(data)
        with pytest.raises(
            qf.FileFormatError, match="expected compressed rotations, got another kind of file"
        ):
            qf.Compressed.load(path)
    with pytest.raises(qf.FileAccessError, match="No such file"):
        qf.Compressed.load(tmp_path / "missing")
    with pytest.raises(qf.FileAccessError, match="directory"):
        qf.Compressed.load(tmp_path)


def test_an_interrupted_save_leaves_the_older_file(tmp_path, monkeypatch):
    path = tmp_path / "clip.qfc"
    older = small()
    older.save(path)

    def interrupted(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr("pathlib.Path.replace", interrupted)
    with pytest.raises(KeyboardInterrupt):
        small(60).save(path)
    assert qf.Compressed.load(path) == older
    assert [entry.name for entry in tmp_path.iterdir()] == ["clip.qfc"]


def test_representation():
    assert repr(small()).startswith("Compressed(120 frames of 3 joints, float64, ")
    assert repr(qf.compress(np.tile([1.0, 0, 0, 0], (1, 1)), tolerance=1)).startswith(
        "Compressed(1 frame, float64"
    )
