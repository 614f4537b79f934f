"""``quatfilt segment``, on a walk that becomes something else."""

import json
import sys

import numpy as np
import pytest
import quatfilt as qf
from commands import run
from quatfilt.cli import main
from quatfilt.evaluation.synthetic import walk


@pytest.fixture(scope="module", name="path")
def wave_then_walk(tmp_path_factory):
    motion = walk(seconds=8)
    half = len(motion) // 2
    rotations = motion.rotations.copy()
    swing = 0.6 * np.sin(np.arange(half) / 10)[:, None]
    rotations[:half] = rotations[half]
    rotations[:half, 1:4] = qf.multiply(rotations[:half, 1:4], qf.exp(swing * [0.3, 1.0, 0.2])[:, None])
    path = tmp_path_factory.mktemp("clips") / "both.bvh"
    qf.write_motion(path, motion.replace(rotations=rotations))
    return path


def test_cuts_are_printed_in_frames_and_seconds(path):
    motion = qf.read_motion(path)
    cuts = qf.segment(motion.rotations, fps=motion.fps)
    assert len(cuts) == 1
    assert abs(cuts[0] - len(motion) // 2) < 40
    lines = run("segment", path).stdout.splitlines()
    assert lines[0] == f"{path}: {len(motion)} frames, {motion.fps:g} per second, 1 cut"
    assert [line.split()[1:3] for line in lines[-2:]] == [
        ["0", str(cuts[0] - 1)],
        [str(cuts[0]), str(len(motion) - 1)],
    ]
    told = json.loads(run("segment", path, "--json").stdout)
    assert told["cuts"] == cuts.tolist()
    assert told["cuts_seconds"] == pytest.approx((cuts / motion.fps).tolist())


def test_options_are_those_of_the_function(path):
    motion = qf.read_motion(path)
    expected = qf.segment(
        motion.rotations, window=0.5, min_length=0.25, threshold=1.5, n_components=2, fps=motion.fps
    )
    words = ["--window", "0.5", "--min-length", "0.25", "--threshold", "1.5", "--components", "2"]
    assert json.loads(run("segment", path, *words, "--json").stdout)["cuts"] == expected.tolist()


def test_a_picture_is_drawn(path, tmp_path, capsys, monkeypatch):
    picture = tmp_path / "cuts.png"
    assert main(["segment", str(path), "--picture", str(picture)]) == 0
    assert f"{picture}: written" in capsys.readouterr().out
    assert picture.read_bytes().startswith(b"\x89PNG")
    monkeypatch.setitem(sys.modules, "matplotlib.figure", None)
    assert main(["segment", str(path), "--picture", str(picture)]) == 2
    assert capsys.readouterr().err == "quatfilt: pictures need matplotlib: pip install 'quatfilt[plot]'\n"


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--window", "0"], "window: expected a number above 0, got 0"),
        (
            ["--window", "0.01"],
            "window: expected at least 0.0166667 seconds, 2 frames at fps = 120, got 0.01",
        ),
        (["--threshold", "-1"], "threshold: expected a number of at least 0, got -1"),
        (["--components", "3"], "--components: expected an integer of at least 1 and at most 2, got 3"),
    ],
)
def test_bad_input_is_one_line(path, words, message, capsys):
    assert main(["segment", str(path), *words]) == 2
    assert capsys.readouterr().err.startswith(f"quatfilt: {message}")
