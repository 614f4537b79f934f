"""``quatfilt batch``: many files, some of them bad, again and again."""

import contextlib
import json
import os
import shutil
import signal
import subprocess

import numpy as np
import pytest
import quatfilt as qf
from commands import COMMAND, run
from patience import PATIENCE, opened
from quatfilt.cli import main
from quatfilt.evaluation.synthetic import walk


@pytest.fixture(scope="module", name="takes")
def folder_of_takes(tmp_path_factory):
    folder = tmp_path_factory.mktemp("takes")
    (folder / "day").mkdir()
    for seed, name in enumerate(["one.bvh", "day/two.npz", "day/three.BVH"]):
        truth = walk(seconds=1, seed=seed)
        noisy = truth.replace(rotations=qf.add_gaussian_noise(truth.rotations, sigma=0.02, rng=seed))
        qf.write_motion(folder / name.lower(), noisy)
        if name != name.lower():
            (folder / name.lower()).rename(folder / name)
    (folder / "day" / "notes.txt").write_text("nothing")
    return folder


def tree(folder):
    """All files and what they hold."""
    return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def lines(text):
    return [json.loads(line) for line in text.splitlines()]


@pytest.mark.parametrize("workers", [1, 2])
def test_folders_in_and_folders_out(takes, tmp_path, workers):
    before = tree(takes)
    done = run(
        "batch", takes, "-o", tmp_path / "out", "--workers", workers, "--preset", "video", "--max-gap", 1
    )
    assert done.stdout.splitlines()[-1] == "3 written, 0 kept, 0 failed"
    written = {"one.bvh", "day/two.npz", "day/three.BVH"}
    assert set(tree(tmp_path / "out")) == {*written, "quatfilt-batch.jsonl"}
    assert tree(takes) == before
    for name in written:
        assert f"{tmp_path / 'out' / name}: written" in done.stdout
        expected = qf.denoise(qf.read_motion(takes / name), preset="video", max_gap=1)
        result = qf.read_motion(tmp_path / "out" / name)
        assert np.degrees(qf.geodesic_distance(result.rotations, expected.rotations)).max() < 1e-5
    log = lines((tmp_path / "out" / "quatfilt-batch.jsonl").read_text())
    assert {line["status"] for line in log} == {"written"}
    assert {line["input"] for line in log} == {str(takes / name) for name in written}
    assert all(line["frames"] == 120 and line["steps"] and line["change_degrees"] > 0 for line in log)


def test_finished_outputs_are_kept(takes, tmp_path):
    out = tmp_path / "out"
    run("batch", takes, "-o", out)
    (out / "one.bvh").write_text("mine")
    (out / "day" / "two.npz").unlink()
    again = lines(run("batch", takes, "-o", out, "--json").stdout)
    assert {line["input"]: line["status"] for line in again} == {
        str(takes / "one.bvh"): "kept",
        str(takes / "day" / "two.npz"): "written",
        str(takes / "day" / "three.BVH"): "kept",
    }
    assert (out / "one.bvh").read_text() == "mine"
    assert len(lines((out / "quatfilt-batch.jsonl").read_text())) == 6
    forced = lines(run("batch", takes, "-o", out, "--force", "--json").stdout)
    assert [line["status"] for line in forced] == ["written"] * 3
    assert len(qf.read_motion(out / "one.bvh")) == 120


@pytest.mark.parametrize("workers", [1, 2])
def test_files_that_fail_do_not_stop_the_others(takes, tmp_path, workers):
    bad = tmp_path / "takes"
    shutil.copytree(takes, bad)
    (bad / "cut.bvh").write_bytes((takes / "one.bvh").read_bytes()[:900])
    (bad / "empty.npz").touch()
    out = tmp_path / "out"
    done = run("batch", bad, "-o", out, "--workers", workers, status=2)
    assert done.stdout.splitlines()[-1] == "3 written, 0 kept, 2 failed"
    said = sorted(done.stderr.splitlines())
    assert len(said) == 2
    assert said[0].startswith(f"quatfilt: {bad / 'cut.bvh'}: line ")
    assert said[1] == f"quatfilt: {bad / 'empty.npz'}: the file is empty"
    assert set(tree(out)) == {"one.bvh", "day/two.npz", "day/three.BVH", "quatfilt-batch.jsonl"}
    failed = [
        line for line in lines((out / "quatfilt-batch.jsonl").read_text()) if line["status"] == "failed"
    ]
    assert {line["error"] for line in failed} == {line.removeprefix("quatfilt: ") for line in said}
    # What failed is tried again, what was written is not.
    again = run("batch", bad, "-o", out, "--workers", workers, status=2)
    assert again.stdout.splitlines()[-1] == "0 written, 3 kept, 2 failed"


def test_options_that_no_clip_can_take_fail_for_each_file(takes, tmp_path):
    words = ["--method", "nonlocal-pose-means", "--option", "patch-radius=-1"]
    done = run("batch", takes, "-o", tmp_path / "out", *words, status=2)
    assert done.stderr.count("patch_radius: expected an integer of at least 0") == 3
    assert done.stderr.count("\n") == 3


def test_files_other_formats_and_logs(takes, tmp_path):
    words = ["--to", "bvh", "--log", tmp_path / "log.jsonl"]
    run("batch", takes / "one.bvh", takes / "day", "-o", tmp_path / "out", *words)
    assert set(tree(tmp_path / "out")) == {"one.bvh", "two.bvh", "three.bvh"}
    assert len(lines((tmp_path / "log.jsonl").read_text())) == 3


def test_outputs_are_no_inputs(takes, tmp_path):
    inside = tmp_path / "takes"
    shutil.copytree(takes, inside)
    for _ in range(2):
        run("batch", inside, "-o", inside / "clean")
    assert len([name for name in tree(inside) if name.startswith("clean")]) == 4


def test_files_are_not_cleaned_in_place(takes, tmp_path):
    """Without a word, an input would look like an output that is there."""
    inside = tmp_path / "takes"
    shutil.copytree(takes, inside)
    before = tree(inside)
    for force in ([], ["--force"]):
        done = run("batch", inside, "-o", inside, "--log", tmp_path / "log.jsonl", *force, status=2)
        assert done.stdout.splitlines()[-1] == "0 written, 0 kept, 3 failed"
        assert done.stderr.count("this is the input: write to another file") == 3
    assert tree(inside) == before


def test_acclaim_becomes_bvh(data_dir, tmp_path):
    for name in ("07.asf", "07_01.amc", "07_02.amc"):
        shutil.copy(data_dir / "cmu" / "07" / name, tmp_path / name)
    run("batch", tmp_path, "-o", tmp_path / "out", "--to", "npz")
    source, result = qf.read_motion(tmp_path / "07_01.amc"), qf.read_motion(tmp_path / "out" / "07_01.npz")
    assert result.skeleton.names == source.skeleton.names
    np.testing.assert_allclose(result.rotations, qf.denoise(source).rotations, atol=1e-12)
    run("batch", tmp_path / "07_02.amc", "-o", tmp_path / "out")
    assert len(qf.read_motion(tmp_path / "out" / "07_02.bvh")) == len(qf.read_motion(tmp_path / "07_02.amc"))


def test_a_folder_of_recordings(data_dir, tmp_path):
    done = run("batch", data_dir / "bvh", "-o", tmp_path, status=2)
    files = sorted((data_dir / "bvh").glob("*.bvh"))
    assert f"{len(files) - 1} written, 0 kept, 1 failed" in done.stdout
    assert "output1_nohierarchy.bvh: line 1: " in done.stderr
    assert done.stderr.count("\n") == 1
    assert len(list(tmp_path.glob("*.bvh"))) == len(files) - 1


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["absent"], "absent: No such file or directory"),
        (["day/notes.txt"], "notes.txt: expected .bvh, .amc or .npz, or a folder, got .txt"),
        (["none"], "none: no motion files (.bvh, .amc or .npz) found"),
        (
            ["one.bvh", "again"],
            "again/one.bvh and one.bvh: both would be written to out/one.bvh; clean them into different folders",
        ),
        ([".", "--to", "fbx"], "--to: expected one of 'bvh', 'npz', got 'fbx'"),
        ([".", "--workers", "0"], "--workers: expected an integer of at least 1, got 0"),
        ([".", "--method", "magic"], "method: expected one of 'auto', "),
        ([".", "--preset", "film"], "preset: expected one of 'optical', "),
        ([".", "--option", "radius"], "--option: expected [METHOD.]NAME=VALUE, got 'radius'"),
    ],
)
def test_bad_input_is_one_line_and_nothing_is_written(takes, tmp_path, words, message, capsys, monkeypatch):
    folder = tmp_path / "takes"
    shutil.copytree(takes, folder)
    (folder / "none").mkdir()
    if "again" in words:
        (folder / "again").mkdir()
        shutil.copy(folder / "one.bvh", folder / "again" / "one.bvh")
    monkeypatch.chdir(folder)
    before = tree(folder)
    assert main(["batch", *words, "-o", "out"]) == 2
    said = capsys.readouterr()
    assert said.out == ""
    assert said.err.count("\n") == 1
    assert message in said.err
    assert tree(folder) == before


@pytest.mark.skipif(os.name == "nt", reason="not on this platform: signals")
def test_a_batch_in_the_background_does_not_hear_ctrl_c(takes, tmp_path):
    """As a shell starts it with `&`: Ctrl-C, which all processes of the terminal get, is meant for others."""
    out, pipes = tmp_path / "out", [tmp_path / f"{number}.bvh" for number in range(2)]
    for pipe in pipes:
        os.mkfifo(pipe)
    command = [*COMMAND, "batch", *map(str, pipes), "-o", str(out), "--workers", "2"]
    with subprocess.Popen(
        ["sh", "-c", "trap '' INT; exec \"$@\"", "sh", *command],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    ) as process:
        try:
            writers = [opened(pipe, process) for pipe in pipes]
            os.killpg(process.pid, signal.SIGINT)
            for pipe, writer in zip(pipes, writers, strict=True):
                pipe.write_bytes((takes / "one.bvh").read_bytes())
                os.close(writer)
            process.communicate(timeout=PATIENCE)
        finally:
            with contextlib.suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGKILL)
    assert process.returncode == 0
    assert set(tree(out)) == {"0.bvh", "1.bvh", "quatfilt-batch.jsonl"}


@pytest.mark.skipif(os.name == "nt", reason="not on this platform: signals")
@pytest.mark.usefixtures("ctrl_c")
@pytest.mark.parametrize("workers", [1, 2])
@pytest.mark.parametrize("everybody", [True, False])
def test_an_interrupted_batch_goes_on_where_it_was(takes, tmp_path, workers, everybody):
    """Each process is done with a file or waits for one that never ends, and there are more of these."""
    out, pipes = tmp_path / "out", [tmp_path / f"{number}.bvh" for number in range(9)]
    for pipe in pipes:
        os.mkfifo(pipe)
    command = [*COMMAND, "batch", str(takes / "one.bvh"), *map(str, pipes), "-o", str(out)]
    with subprocess.Popen(
        [*command, "--workers", str(workers)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    ) as process:
        try:
            writers = [opened(pipe, process) for pipe in pipes[:workers]]
            # A terminal tells all of its processes.
            (os.killpg if everybody else os.kill)(process.pid, signal.SIGINT)
            _, said = process.communicate(timeout=PATIENCE)
        finally:
            with contextlib.suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGKILL)
    for writer in writers:
        os.close(writer)
    assert (process.returncode, said) == (130, "quatfilt: interrupted\n")
    assert set(tree(out)) == {"one.bvh", "quatfilt-batch.jsonl"}, "a temporary file was left"
    assert len(qf.read_motion(out / "one.bvh")) == 120
    for pipe in pipes:
        pipe.unlink()
        shutil.copy(takes / "one.bvh", pipe)
    done = run(*command[len(COMMAND) :])
    assert done.stdout.splitlines()[-1] == "9 written, 1 kept, 0 failed"
