"""``quatfilt reconstruct``: a table or a motion file in, a whole body out."""

import json

import numpy as np
import pytest
import quatfilt as qf
import walkers
from commands import refused, run

JOINTS = ",".join(walkers.JOINTS)


@pytest.fixture(scope="module", name="files")
def database_motion_and_table(tmp_path_factory):
    folder = tmp_path_factory.mktemp("reconstruct")
    walkers.database().save(folder / "walks.qfdb")
    walk = walkers.walker(30)
    qf.write_motion(folder / "walk.bvh", walk)
    header = [f"{joint}.{axis}" for joint in walkers.JOINTS for axis in "xyz"]
    rows = walkers.seen(walk).reshape(30, -1)
    cells = [[f"{frame / 60:.4f}", *(f"{x:.6f}" for x in row)] for frame, row in enumerate(rows)]
    cells[4][1:4] = ["", "nan", ""]
    lines = [",".join(["time", *header]), *(",".join(row) for row in cells)]
    (folder / "points.csv").write_text("\n".join(lines) + "\n")
    return folder


def test_of_a_table(files, tmp_path):
    out = tmp_path / "out.bvh"
    done = run("reconstruct", "-d", files / "walks.qfdb", "--points", files / "points.csv", "-o", out)
    assert done.stdout.startswith("30 frames from 4 control points, ")
    assert done.stdout.endswith(f"{out}: written\n")
    result = qf.read_motion(out)
    assert len(result) == 30
    assert abs(result.fps - 60) < 0.1
    # A file may have its joints in another order.
    truth, names = walkers.walker(30), result.skeleton.names
    order = [names.index(name) for name in truth.skeleton.names]
    error = np.linalg.norm(result.positions()[:, order] - truth.positions(), axis=2)
    assert error.mean() < 3


def test_of_a_motion_with_its_error(files, tmp_path):
    arguments = (
        "reconstruct",
        "-d",
        files / "walks.qfdb",
        "--motion",
        files / "walk.bvh",
        "--joints",
        JOINTS,
    )
    told = json.loads(run(*arguments, "--json", "--model", "local_pca", "--neighbors", 16).stdout)
    assert told["frames"] == 30
    assert told["control_points"] == list(walkers.JOINTS)
    assert told["output"] is None
    assert 0 < told["position_error_cm"] < 3
    assert 0 < told["angle_error_degrees"] < 10
    assert 0 < told["energy_of_prediction"] < 30
    spoken = run(*arguments, "-o", tmp_path / "out.npz").stdout
    assert "error: " in spoken
    assert (tmp_path / "out.npz").exists()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ([], "pass either --points or --motion"),
        (["--points", "points.csv", "--motion", "walk.bvh"], "pass either --points or --motion"),
        (["--motion", "walk.bvh"], "--motion needs the control points: pass --joints NAME,NAME…"),
        (
            ["--motion", "walk.bvh", "--joints", "LeftWirst"],
            "--joints: the database has no joint 'LeftWirst'; similar names: LeftWrist, ",
        ),
        (["--points", "points.csv", "--joints", "Head"], "--joints is for --motion only"),
        (["--points", "points.csv", "--fps", 0], "fps: expected a number above 0, got 0.0"),
        (
            ["--points", "points.csv", "--fps", 0.001],
            "fps: expected 0.6 to 6000 hertz, because the database has 60, got 0.001",
        ),
        (["--points", "none.csv"], "none.csv: No such file or directory"),
        (["--points", "points.csv", "--model", "magic"], "model: expected one of 'local_regression'"),
    ],
)
def test_bad_options(files, arguments, message):
    assert refused("reconstruct", "-d", "walks.qfdb", *arguments, cwd=files).startswith(message)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "bad.csv: expected a header and rows, got an empty file"),
        ("Head.x,Head.y,Head.z\n", "bad.csv: expected rows below the header, got none"),
        ("Head.x,Head.y\n1,2\n", "bad.csv: expected a column Head.z beside those of Head"),
        ("frame\n1\n", "bad.csv: expected columns joint.x, joint.y, joint.z, got none"),
        ("Head.x,Head.x\n1,2\n", "bad.csv: two columns are named 'Head.x'; name each column once"),
        (
            "Head,Head.x\n1,2\n",
            "bad.csv: expected columns joint.x, joint.y, joint.z, time or frame, got 'Head'",
        ),
        ("Head.x,Head.y,Head.z\n1,2,3\n1,2\n", "bad.csv: line 3: expected 3 cells as in the header, got 2"),
        ("Head.x,Head.y,Head.z\n1,2,three\n", "bad.csv: line 2: expected a number, got 'three'"),
        (
            "\nHead.x,Head.y,Head.z\n1,2,3\n\n,,\n1,2\n",
            "bad.csv: line 6: expected 3 cells as in the header, got 2",
        ),
        ("Head.x,Head.y,Head.z\n1,2,inf\n", "bad.csv: line 2: expected a number, got 'inf'"),
        (f"Head.x,Head.y,Head.z\n1,2,{'3' * 200_000}\n", "bad.csv: line 2: field larger than field limit"),
        (
            "Head.x,Head.y,Head.z\n1,2,3\n",
            "bad.csv: the frame rate is missing; add a column time in seconds, or pass --fps",
        ),
        (
            "time,Head.x,Head.y,Head.z\n0,1,2,3\n1,1,2,3\n5,1,2,3\n",
            "bad.csv: the column time must have seconds at a constant frame rate",
        ),
    ],
)
def test_bad_tables(files, text, message):
    (files / "bad.csv").write_text(text)
    assert refused("reconstruct", "-d", "walks.qfdb", "--points", "bad.csv", cwd=files).startswith(message)


def test_a_table_in_metres(files):
    table = (files / "points.csv").read_text().splitlines()
    rows = [row.split(",") for row in table[5:]]
    scaled = [
        ",".join([row[0], *(f"{float(x) / 100:.8f}" for x in row[1:])]) for row in rows if "" not in row
    ]
    (files / "metres.csv").write_text("\n".join([table[0], *scaled]))
    told = refused("reconstruct", "-d", "walks.qfdb", "--points", "metres.csv", cwd=files)
    assert "multiplied by 100, they would fit" in told


def test_signs_and_frames_of_the_table_are_kept(files, tmp_path):
    """The frame rate of the option counts before that of the table."""
    out = tmp_path / "out.npz"
    run("reconstruct", "-d", files / "walks.qfdb", "--points", files / "points.csv", "--fps", 30, "-o", out)
    result = qf.read_motion(out)
    assert result.fps == 30
    assert len(result) == 30
    assert np.isfinite(result.rotations).all()
