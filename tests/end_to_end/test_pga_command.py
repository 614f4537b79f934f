"""``quatfilt pga``: what it prints, draws and refuses."""

import json

import numpy as np
import pytest
import quatfilt as qf
from quatfilt.cli import main
from quatfilt.evaluation.synthetic import walk


@pytest.fixture(name="file")
def a_walk(tmp_path):
    path = tmp_path / "walk.bvh"
    qf.write_motion(path, walk(seconds=2))
    return path


def test_a_table_and_a_picture(file, tmp_path, capsys):
    assert main(["pga", str(file), "-k", "3", "-o", str(tmp_path / "pga.png")]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].startswith(f"{file}: 240 frames, mean angle that k geodesics leave, degrees")
    assert lines[-1] == f"{tmp_path / 'pga.png'}: written"
    assert " ".join(lines[2].split()) == "joint k = 0 k = 1 k = 2 k = 3 greatest first direction"
    assert (tmp_path / "pga.png").read_bytes().startswith(b"\x89PNG")


def test_json_has_what_the_class_finds(file, capsys):
    assert main(["pga", str(file), "-k", "2", "--joints", "LeftAnkle, RightKnee", "--json"]) == 0
    said = json.loads(capsys.readouterr().out)
    motion = qf.read_motion(file)
    assert [joint["name"] for joint in said["joints"]] == ["LeftAnkle", "RightKnee"]
    for joint in said["joints"]:
        q = motion.rotations[:, motion.skeleton.index(joint["name"])]
        fitted = qf.PrincipalGeodesicAnalysis(n_components=2).fit(q)
        np.testing.assert_allclose(joint["residuals_degrees"], np.degrees(fitted.residuals_), atol=1e-9)
        np.testing.assert_allclose(joint["directions"], fitted.components_, atol=1e-9)
        np.testing.assert_allclose(
            joint["worst_degrees"][-1], np.degrees(fitted.reconstruction_error(q, 2).max()), atol=1e-9
        )


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["-k", "0"], "--components: expected an integer of at least 1 and at most 64, got 0"),
        (["--joints", "LeftWing"], "--joints: expected joints among"),
        (["--objective", "median"], "--objective: expected one of 'geodesic', 'squared', 'chordal'"),
    ],
)
def test_bad_input_is_one_line(file, words, message, capsys):
    assert main(["pga", str(file), *words]) == 2
    said = capsys.readouterr()
    assert said.out == ""
    assert message in said.err
    assert said.err.count("\n") == 1


def test_recordings(data_dir, capsys):
    assert main(["pga", str(data_dir / "cmu" / "07" / "07_01.amc"), "-k", "1", "--json"]) == 0
    joints = {joint["name"]: joint for joint in json.loads(capsys.readouterr().out)["joints"]}
    # The model has a hinge there: one axis, whatever the clip.
    assert joints["ltibia"]["spread_degrees"] > 10
    assert joints["ltibia"]["residuals_degrees"][0] < 1e-4
    assert joints["lhumerus"]["residuals_degrees"][0] > 1
