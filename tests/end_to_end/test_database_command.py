"""``quatfilt database``: folders in, a database out, whatever happens in between."""

import json
import signal
import subprocess
import sys

import numpy as np
import pytest
import quatfilt as qf
from commands import refused, run
from patience import PATIENCE
from quatfilt.cli import main
from quatfilt.evaluation.synthetic import walk
from quatfilt.formats._atomic import folder_beside


@pytest.fixture(scope="module", name="takes")
def folder_of_takes(tmp_path_factory):
    folder = tmp_path_factory.mktemp("takes")
    (folder / "day").mkdir()
    for seed, name in enumerate(["two.bvh", "day/one.npz", "day/three.bvh"]):
        qf.write_motion(folder / name, walk(seconds=1, seed=seed))
    (folder / "day" / "notes.txt").write_text("nothing")
    return folder


def names(folder):
    """What a folder holds, hidden files too."""
    return sorted(path.name for path in folder.iterdir())


def test_folders_in_and_a_database_out(takes, tmp_path):
    out = tmp_path / "walks.db"
    done = run("database", "build", takes, "-o", out, "--mirror")
    assert done.stdout.splitlines()[-1].startswith(
        f"{out}: 360 poses of 21 joints, 6 clips of 2 skeletons, 60 frames per second, 0.1 min, "
    )
    db = qf.MotionDatabase.open(out, verify=True)
    assert db.clip_names[::2] == ("day/one", "day/three", "two")
    motions = [qf.read_motion(takes / name) for name in ("day/one.npz", "day/three.bvh", "two.bvh")]
    expected = qf.MotionDatabase.from_motions(motions, mirror=True, clip_names=db.clip_names[::2])
    np.testing.assert_array_equal(db.rotations, expected.rotations)
    np.testing.assert_array_equal(db.features, expected.features)
    assert names(tmp_path) == ["walks.db"]
    # The same bytes again, from any number of readers, and as `save` writes them.
    before = out.read_bytes()
    run("database", "build", takes, "-o", out, "--mirror", "--workers", 3)
    assert out.read_bytes() == before
    expected.save(out)
    assert out.read_bytes() == before
    assert len(qf.MotionDatabase.from_folders(takes / "day", workers=1)) == 120


def test_options_and_json(takes, tmp_path):
    out = tmp_path / "db"
    options = ["--fps", 30, "--source-fps", 60, "--min-length", 0, "--up", "y", "--max-gap", 0]
    told = json.loads(run("database", "build", takes / "two.bvh", "-o", out, *options, "--json").stdout)
    assert (told["poses"], told["fps"], told["seconds"], told["up"]) == (60, 30, 2, "y")
    assert told["bytes"] == out.stat().st_size
    assert [clip["name"] for clip in told["clips"]] == ["two"]
    assert json.loads(run("database", "info", out, "--json", "--verify").stdout) == told


def test_a_graph_is_built_on_request(takes, tmp_path):
    out = tmp_path / "db"
    run("database", "build", takes, "-o", out, "--graph")
    db = qf.MotionDatabase.open(out, verify=True)
    expected, _ = qf.neighbor_graph(db.features, db.starts, degree=16, exclusion=15)
    np.testing.assert_array_equal(db.graph, expected)
    assert "  graph: 16 neighbors of each pose" in run("database", "info", out).stdout.splitlines()


def test_a_graph_that_is_interrupted_leaves_the_older_file(takes, tmp_path, monkeypatch):
    out = tmp_path / "db"
    out.write_bytes(b"older")

    def interrupted(_db, **_options):
        raise KeyboardInterrupt

    monkeypatch.setattr(qf.MotionDatabase, "build_graph", interrupted)
    assert main(["database", "build", str(takes), "-o", str(out), "--graph"]) == 130
    assert out.read_bytes() == b"older"
    assert names(tmp_path) == ["db"]


def test_info(takes, tmp_path):
    out = tmp_path / "db"
    run("database", "build", takes, "-o", out)
    said = run("database", "info", out).stdout.splitlines()
    assert said[0].startswith(f"{out}: 180 poses of 21 joints, 3 clips of ")
    assert said[1:3] == ["  y is up", "  graph: none"]
    assert any(line.split() == ["day/one", "60", "1.0"] for line in said)
    assert "build" in run("database").stdout


def test_clips_that_are_left_out_are_told(tmp_path):
    folder = tmp_path / "mixed"
    folder.mkdir()
    qf.write_motion(folder / "a.npz", walk(seconds=1))
    qf.write_motion(folder / "b.npz", walk(seconds=0.2))
    (folder / "c.bvh").write_text("HIERARCHY\nROOT")
    (folder / "d.npz").write_bytes(b"nothing")
    said = run("database", "build", folder, "-o", tmp_path / "db").stdout.splitlines()
    assert said[:-1] == [
        "b: left out: 0.2 s, shorter than 0.5 s",
        f"left out: {folder / 'c.bvh'}: line 2: a joint without a name",
        f"left out: {folder / 'd.npz'}: not an .npz archive",
    ]


def other_joints(name):
    skeleton = qf.Skeleton(["hips", "spine"], [-1, 0], [[0.0, 90, 0], [0, 30, 0]])
    turns = qf.exp(np.full((60, 2, 3), 0.1) * np.linspace(0, 1, 60)[:, None, None])
    qf.write_motion(name, qf.Motion(turns, fps=60, skeleton=skeleton))


def test_other_joints(tmp_path):
    folder = tmp_path / "mixed"
    folder.mkdir()
    other_joints(folder / "a.npz")
    for name in "bc":
        qf.write_motion(folder / f"{name}.npz", walk(seconds=1))
    out = tmp_path / "db"
    message = refused("database", "build", folder, "-o", out)
    assert message.startswith("b: expected the joints of a, got none named hips, spine and others, Hips, ")
    assert message.endswith("; --skip-others leaves out files of other joints than most")
    assert not out.exists()
    said = run("database", "build", folder, "-o", out, "--skip-others").stdout.splitlines()
    assert said[0].startswith("a: left out: other joints: none named Hips, ")
    assert qf.MotionDatabase.open(out).clip_names == ("b", "c")


def test_bad_input(takes, tmp_path, capsys):
    out, empty = tmp_path / "db", tmp_path / "empty"
    empty.mkdir()
    expected = {
        (empty,): f"{empty}: no motion files (.bvh, .amc or .npz) found",
        (tmp_path / "none",): f"{tmp_path / 'none'}: No such file or directory",
        (
            takes / "day" / "notes.txt",
        ): f"{takes / 'day' / 'notes.txt'}: expected .bvh, .amc or .npz, or a folder, got .txt",
        (takes, "--fps", 0): "fps: expected a number above 0, got 0.0",
        (takes, "--source-fps", 0): "--source-fps: expected a number above 0, got 0.0",
        (takes, "--workers", 0): "--workers: expected an integer of at least 1, got 0",
        (takes, "--up", "w"): "up: expected one of 'x', 'y', 'z', got 'w'",
        (
            takes,
            "--min-length",
            9,
        ): "motions: expected clips that can be used, got none: two: left out: 1 s, shorter than 9 s",
    }
    for arguments, message in expected.items():
        assert main(["database", "build", *map(str, arguments), "-o", str(out)]) == 2
        assert capsys.readouterr() == ("", f"quatfilt: {message}\n")
        assert names(tmp_path) == ["empty"]
    nowhere = tmp_path / "no" / "db"
    assert refused("database", "build", takes, "-o", nowhere) == f"{nowhere}: No such directory"
    assert refused("database", "build", takes, "-o", empty, "--graph") == f"{empty}: Is a directory"
    script = takes / "two.bvh"
    assert refused("database", "info", script) == f"{script}: not a motion database"


STOPPED = """
import os, signal, sys
from importlib import import_module
from quatfilt.cli import main

module, _, name = "{where}".rpartition(":")
owner, _, function = name.rpartition(".")
place = import_module(module)
for word in filter(None, owner.split(".")):
    place = getattr(place, word)
calls = []

def stop(*arguments, exact=getattr(place, function), **options):
    calls.append(function)
    if len(calls) == {call}:
        os.kill(os.getpid(), signal.{signal})
    return exact(*arguments, **options)

setattr(place, function, stop)
sys.exit(main(sys.argv[1:]))
"""
"""The command in a process that sends itself a signal where a function is called for the n-th time."""

WRITER = "quatfilt.reconstruction.database.writer:"

MOMENTS = {
    "empty": (WRITER + "Writer.append", 1),
    "some of the clips": (WRITER + "Writer.append", 3),
    "all rotations": (WRITER + "Writer.mapped", 1),
    "all but its end": (WRITER + "Writer.finish", 1),
    "before it has its name": ("pathlib:Path.replace", 1),
}
"""How far the file is when the process is stopped."""


def stopped(where, call, number, *words):
    """Run the command until it sends itself a signal, and return its status and what it said."""
    program = STOPPED.format(where=where, call=call, signal=number.name)
    done = subprocess.run(
        [sys.executable, "-c", program, *map(str, words)],
        capture_output=True,
        text=True,
        timeout=PATIENCE,
        check=False,
    )
    return done.returncode, done.stderr


@pytest.fixture(name="many")
def folder_of_many(tmp_path):
    folder = tmp_path / "many"
    folder.mkdir()
    qf.write_motion(folder / "0.npz", walk(seconds=2))
    data = (folder / "0.npz").read_bytes()
    for number in range(1, 6):
        (folder / f"{number}.npz").write_bytes(data)
    (tmp_path / "out").mkdir()
    return folder


def test_a_killed_build_leaves_the_old_file_or_none(many, tmp_path):
    out = tmp_path / "out" / "db"
    build = ("database", "build", many, "-o", out)
    old = None
    for with_old_file in (False, True):
        if with_old_file:
            run("database", "build", many / "0.npz", "-o", out)
            old = out.read_bytes()
            assert len(names(out.parent)) == 1, "what was killed is still there"
        for moment in MOMENTS.values() if with_old_file else [MOMENTS["all but its end"]]:
            assert stopped(*moment, signal.SIGKILL, *build) == (-signal.SIGKILL, "")
            assert out.exists() == with_old_file
            assert not with_old_file or out.read_bytes() == old
            # One at most: each build removes what the one before left.
            assert len(list(out.parent.glob(".*.unfinished"))) == 1
    run("database", "build", many / "0.npz", "-o", out)
    assert out.read_bytes() == old
    assert names(out.parent) == ["db"]


def test_what_a_killed_build_with_a_graph_left_is_removed_by_the_next(takes, tmp_path):
    out = tmp_path / "db"
    build = ("database", "build", takes, "-o", out)
    graph = "quatfilt.reconstruction.database.database:MotionDatabase.build_graph"
    with folder_beside(str(out)) as busy:
        (busy / "db").touch()
        assert stopped(graph, 1, signal.SIGKILL, *build, "--graph") == (-signal.SIGKILL, "")
        assert len(names(tmp_path)) == 2, "a folder of each"
        assert not out.exists()
        run(*build)
        # What somebody else is at work in stays.
        assert names(tmp_path) == sorted([busy.name, "db"])
    assert names(tmp_path) == ["db"]


@pytest.mark.usefixtures("ctrl_c")
@pytest.mark.parametrize("moment", ["some of the clips", "all rotations"])
def test_an_interrupted_build_cleans_up(many, tmp_path, moment):
    out = tmp_path / "out" / "db"
    ended = stopped(*MOMENTS[moment], signal.SIGINT, "database", "build", many, "-o", out)
    assert ended == (130, "quatfilt: interrupted\n")
    assert list(out.parent.iterdir()) == []


def test_recordings(data_dir, tmp_path):
    out = tmp_path / "cmu.db"
    told = json.loads(run("database", "build", data_dir / "cmu", "-o", out, "--mirror", "--json").stdout)
    assert len(told["clips"]) == 2 * 167
    assert told["poses"] == 185_490
    assert told["skeletons"] == 22
    assert told["notes"] == [
        "167 clips: AMC has no frame rate: 120 fps assumed",
        "07/07_12: line 7324: last frame 245 is cut short (bone `ltoes` is missing): dropped",
        "63or64_golf/golf_01: line 13294: last frame 444 is cut short (bone `lfemur` is missing): dropped",
    ]
    db = qf.MotionDatabase.open(out)
    # A person leans, but hardly ever more than a right angle: headings do not jump.
    inside = np.ones(len(db) - 1, bool)
    inside[db.starts[1:-1] - 1] = False
    steps = np.abs(np.diff(db.heading))[inside]
    assert np.quantile(steps, 0.9999) < 0.3
    source = qf.read_motion(data_dir / "cmu" / "02" / "02_01.amc")
    expected = qf.resample(source.rotations, fps=120, new_fps=60)
    clip = db.motion(db.clip_names.index("02/02_01"))
    assert qf.geodesic_distance(clip.rotations.astype(float), expected).max() < 1e-6
    message = refused("database", "build", data_dir / "bvh", "-o", tmp_path / "bvh.db")
    assert message.startswith("02_01.daz: expected the joints of 0005_Walking001, got none named Hips, ")
