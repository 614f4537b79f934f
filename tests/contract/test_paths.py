"""What names no file is refused by name."""

import numpy as np
import pytest
import quatfilt as qf
from quatfilt.evaluation.synthetic import walk


def database():
    return qf.MotionDatabase.from_motions([walk(seconds=1)])


def compressed():
    return qf.compress(np.tile([1.0, 0.0, 0.0, 0.0], (10, 1)), tolerance=0.1)


CALLS = {
    "read_motion": (qf.read_motion, "path"),
    "read_motion, skeleton": (lambda wrong: qf.read_motion("a.amc", skeleton=wrong), "skeleton"),
    "write_motion": (lambda wrong: qf.write_motion(wrong, walk(seconds=1)), "path"),
    "MotionDatabase.open": (qf.MotionDatabase.open, "path"),
    "MotionDatabase.save": (lambda wrong: database().save(wrong), "path"),
    "MotionDatabase.from_folders": (qf.MotionDatabase.from_folders, "folders"),
    "MotionDatabase.from_folders, list": (lambda wrong: qf.MotionDatabase.from_folders([wrong]), "folders"),
    "MotionDatabase.from_folders, path": (lambda wrong: qf.MotionDatabase.from_folders(".", path=wrong), "path"),
    "Compressed.load": (qf.Compressed.load, "path"),
    "Compressed.save": (lambda wrong: compressed().save(wrong), "path"),
    "Report.write": (lambda wrong: qf.report(walk(seconds=1), walk(seconds=1)).write(wrong), "path"),
}  # fmt: skip


@pytest.mark.parametrize("wrong", [3, 2.5])
@pytest.mark.parametrize(("call", "name"), CALLS.values(), ids=CALLS)
def test_what_names_no_file_is_refused(call, name, wrong, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "a.amc").write_text("1\n")
    with pytest.raises(TypeError) as caught:
        call(wrong)
    assert str(caught.value) == f"{name}: expected a path, got {type(wrong).__name__}"


def test_bytes_name_no_file():
    with pytest.raises(TypeError, match="path: expected a path, got bytes"):
        qf.MotionDatabase.open(b"walks.qfdb")
