"""``quatfilt evaluate`` on the built-in walk: what each verb prints and writes."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from patience import PATIENCE
from quatfilt.cli import main
from quatfilt.evaluation.synthetic import walk


@pytest.fixture(name="one_second")
def the_walk_takes_one_second(monkeypatch):
    monkeypatch.setattr("quatfilt.evaluation.clips.walk", lambda seconds: walk(seconds=seconds / 8))


def check(verb, said, folder):
    """Look at what a verb printed and wrote into ``results``; return its lines."""
    lines = said.splitlines()
    assert [line for line in lines if line.endswith(": written")] == [
        f"{Path('results', f'{verb}.{extension}')}: written" for extension in ("md", "json", "png")
    ]
    page = (folder / "results" / f"{verb}.md").read_text(encoding="utf-8")
    numbers = json.loads((folder / "results" / f"{verb}.json").read_text(encoding="utf-8"))
    assert f"`quatfilt evaluate {verb} --seeds 1`" in page
    assert numbers["command"] == f"quatfilt evaluate {verb} --seeds 1"
    assert numbers["seeds"] == 1
    assert f"({verb}.png)" in page
    assert (folder / "results" / f"{verb}.png").read_bytes().startswith(b"\x89PNG")
    return lines


@pytest.mark.usefixtures("one_second")
@pytest.mark.parametrize(
    ("verb", "says", "row"),
    [
        ("nlpm-table1", "Mean PSNR over the clips, dB", "NLPM, per joint, oracle"),
        ("smooth-goal", "PSNR less that of the best classical filter, dB", "30"),
    ],
)
def test_a_table_is_written(verb, says, row, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert main(["evaluate", verb, "--seeds", "1", "-o", "results", "--workers", "1"]) == 0
    lines = check(verb, capsys.readouterr().out, tmp_path)
    assert lines[0] == says
    assert any(line.strip().startswith(row) for line in lines)


@pytest.mark.parametrize(
    ("verb", "says"),
    [
        ("bilateral-figs", "MSE of RightShoulder by passes"),
        ("pga-figs", "Mean angle that k geodesics leave, degrees"),
    ],
)
def test_figures_are_drawn_by_a_process_of_its_own(verb, says, tmp_path):
    words = ["evaluate", verb, "--seeds", "1"]
    for more, folder in ((["-o", "results"], "results"), (["--json"], "docs/results")):
        done = subprocess.run(
            [sys.executable, "-m", "quatfilt", *words, *more],
            capture_output=True,
            text=True,
            encoding="utf-8",
            cwd=tmp_path,
            env={**os.environ, "PYTHONIOENCODING": "utf-8"},
            check=False,
            timeout=PATIENCE,
        )
        assert done.returncode == 0, done.stderr
        assert done.stderr == ""
        if folder == "results":
            assert check(verb, done.stdout, tmp_path)[0].startswith(says)
        else:
            file = tmp_path / folder / f"{verb}.json"
            assert json.loads(done.stdout) == json.loads(file.read_text(encoding="utf-8"))


@pytest.mark.usefixtures("one_second")
def test_compression_is_measured(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert main(["evaluate", "compression", "-o", "results"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0] == "All clips together"
    assert any(line.startswith("quatfilt.compress, 0.1°") for line in lines)
    assert "`quatfilt evaluate compression`" in (tmp_path / "results" / "compression.md").read_text("utf-8")
    numbers = json.loads((tmp_path / "results" / "compression.json").read_text("utf-8"))
    assert main(["evaluate", "compression", "-o", "results", "--json"]) == 0
    again = json.loads(capsys.readouterr().out)
    assert again["ratios_by_tolerance_radians"] == numbers["ratios_by_tolerance_radians"]
    assert (tmp_path / "results" / "compression.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize("verb", ["nlpm-table1", "smooth-goal", "robust-denoising"])
def test_without_pywavelets_a_verb_says_what_to_install(verb, tmp_path, capsys, monkeypatch):
    monkeypatch.setitem(sys.modules, "pywt", None)
    monkeypatch.chdir(tmp_path)
    assert main(["evaluate", verb]) == 2
    assert capsys.readouterr().err == "quatfilt: wavelets need PyWavelets: pip install 'quatfilt[wavelet]'\n"
    assert not any(tmp_path.iterdir())


@pytest.mark.parametrize(
    "verb", ["nlpm-table1", "bilateral-figs", "pga-figs", "smooth-goal", "robust-denoising"]
)
@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--data", "nowhere"], "nowhere: expected a folder of motion capture"),
        (["--data", "."], "in this folder or below it"),
        (["--seeds", "0"], "--seeds: expected an integer of at least 1, got 0"),
    ],
)
def test_bad_input_is_one_line_and_nothing_is_written(verb, words, message, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert main(["evaluate", verb, *words]) == 2
    said = capsys.readouterr()
    assert said.out == ""
    assert said.err.startswith("quatfilt: ")
    assert said.err.count("\n") == 1
    assert message in said.err
    assert not any(tmp_path.iterdir())


def test_the_goal_is_measured_for_methods_that_there_are(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert main(["evaluate", "smooth-goal", "--method", "magic"]) == 2
    assert "--method: expected one of 'auto'" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--kinds", "white,pink"], "--kinds: expected one of 'white', 'ar5'"),
        (["--clips", "02_06,99_99"], "--clips: expected one of '02_06'"),
    ],
)
def test_the_noise_of_trackers_has_kinds_and_clips_that_there_are(
    words, message, tmp_path, capsys, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    assert main(["evaluate", "robust-denoising", *words]) == 2
    assert message in capsys.readouterr().err
    assert not any(tmp_path.iterdir())


@pytest.mark.usefixtures("one_second")
def test_kinds_of_noise_can_be_chosen(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    words = ["evaluate", "robust-denoising", "--seeds", "1", "--workers", "1", "--kinds", "steps,held"]
    assert main([*words, "-o", "results"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0] == "PSNR less that of the better of kalman and a 6 Hz Butterworth filter, dB"
    assert [line.split()[0] for line in lines if line.strip().startswith(("held", "steps"))] == [
        "held",
        "steps",
    ]
    numbers = json.loads((tmp_path / "results" / "robust-denoising.json").read_text("utf-8"))
    assert list(numbers["kinds"]) == ["held", "steps"]
    assert numbers["command"] == "quatfilt evaluate robust-denoising --seeds 1 --kinds steps,held"
    assert numbers["command"] in (tmp_path / "results" / "robust-denoising.md").read_text("utf-8")
    assert (tmp_path / "results" / "robust-denoising.png").read_bytes().startswith(b"\x89PNG")
