"""The command line, run as a process of its own, on synthetic files and on bad input."""

import json
import os
import re
import signal
import subprocess
import sys

import numpy as np
import pytest
import quatfilt as qf
from commands import COMMAND, refused, run
from patience import PATIENCE, opened
from quatfilt.cli import main
from quatfilt.evaluation.synthetic import walk

EVALUATIONS = ("nlpm-table1", "bilateral-figs", "smooth-goal", "robust-denoising", "compression")


@pytest.fixture(scope="module", name="folder")
def folder_of_clips(tmp_path_factory):
    folder = tmp_path_factory.mktemp("clips")
    truth = walk(seconds=1.5)
    noisy = truth.replace(rotations=qf.add_gaussian_noise(truth.rotations, sigma=0.02, rng=1))
    qf.write_motion(folder / "truth.bvh", truth)
    qf.write_motion(folder / "noisy.bvh", noisy)
    qf.write_motion(folder / "noisy.npz", noisy)
    qf.write_motion(folder / "short.bvh", walk(seconds=1))
    turned = truth.replace(
        skeleton=qf.Skeleton(["a", *truth.skeleton.names[1:]], truth.skeleton.parents, truth.skeleton.offsets)
    )
    qf.write_motion(folder / "renamed.npz", turned)
    (folder / "empty.bvh").touch()
    (folder / "cut.bvh").write_bytes((folder / "truth.bvh").read_bytes()[:900])
    (folder / "binary.bvh").write_bytes(bytes(range(256)) * 20)
    (folder / "notes.txt").write_text("nothing")
    (folder / "directory.bvh").mkdir()
    (folder / "alone.amc").write_text(":FULLY-SPECIFIED\n:DEGREES\n1\nroot 0 0 0 0 0 0\n")
    return folder


def error(truth, path):
    return float(np.degrees(qf.geodesic_distance(truth.rotations, qf.read_motion(path).rotations)).mean())


def test_denoise_writes_beside_the_input_and_cleans(folder, tmp_path):
    noisy = tmp_path / "noisy.bvh"
    noisy.write_bytes((folder / "noisy.bvh").read_bytes())
    done = run("denoise", noisy)
    assert f"{tmp_path / 'noisy.clean.bvh'}: written" in done.stdout
    truth = qf.read_motion(folder / "truth.bvh")
    assert error(truth, tmp_path / "noisy.clean.bvh") < 0.6 * error(truth, noisy)
    assert noisy.read_bytes() == (folder / "noisy.bvh").read_bytes()
    assert sorted(path.name for path in tmp_path.iterdir()) == ["noisy.bvh", "noisy.clean.bvh"]


@pytest.mark.parametrize("extension", ["bvh", "npz"])
def test_denoise_does_what_the_function_does(folder, tmp_path, extension):
    output = tmp_path / "out.npz"
    options = {
        "method": "nonlocal_pose_means",
        "search_radius": 6,
        "patch_radius": 2,
        "weights": "joint",
        "chart": "local",
        "boundary": "mirror",
        "neighbors": 5,
    }
    words = [word for name, value in options.items() for word in (f"--{name.replace('_', '-')}", value)]
    noisy = folder / f"noisy.{extension}"
    run("denoise", noisy, "-o", output, *words, "--bandwidth", "3.5", "--threads", "1")
    expected = qf.denoise(qf.read_motion(noisy), bandwidth=np.radians(3.5), **options)
    result = qf.read_motion(output)
    assert np.degrees(qf.geodesic_distance(result.rotations, expected.rotations)).max() < 1e-5
    assert result.translation == pytest.approx(expected.translation, abs=1e-6)


def test_denoise_leaves_the_root_alone_when_asked(folder, tmp_path):
    before = qf.read_motion(folder / "noisy.npz").translation
    run("denoise", folder / "noisy.npz", "-o", tmp_path / "kept.npz", "--no-translation")
    run("denoise", folder / "noisy.npz", "-o", tmp_path / "moved.npz")
    assert np.array_equal(qf.read_motion(tmp_path / "kept.npz").translation, before)
    assert not np.array_equal(qf.read_motion(tmp_path / "moved.npz").translation, before)


def test_denoise_as_json(folder, tmp_path):
    report = json.loads(run("denoise", folder / "noisy.npz", "-o", tmp_path / "o.bvh", "--json").stdout)
    assert report["output"] == str(tmp_path / "o.bvh")
    assert (report["frames"], report["joints"], report["fps"]) == (180, 21, 120)
    assert report["missing_samples"] == report["missing_samples_left"] == 0
    assert report["noise_degrees"] == pytest.approx(np.degrees(0.02), rel=0.1)
    assert 0.5 < report["change_degrees"] < 3


def test_denoise_reports_and_keeps_gaps(tmp_path):
    clip = walk(seconds=1)
    rotations = clip.rotations.copy()
    rotations[50:60, 3] = np.nan
    qf.write_motion(tmp_path / "gap.npz", clip.replace(rotations=rotations))
    filled = json.loads(run("denoise", tmp_path / "gap.npz", "--json").stdout)
    assert (filled["missing_samples"], filled["missing_samples_left"]) == (10, 0)
    kept = json.loads(run("denoise", tmp_path / "gap.npz", "--json", "--max-gap", 0.05).stdout)
    assert (kept["missing_samples"], kept["missing_samples_left"]) == (10, 10)
    assert "missing" in refused("denoise", tmp_path / "gap.npz", "--gaps", "raise")


def test_info(folder):
    done = run("info", folder / "noisy.npz")
    assert "180 frames of 21 joints, 120 frames per second, 1.5 s" in done.stdout
    report = json.loads(run("info", folder / "noisy.npz", "--json").stdout)
    assert report["noise_degrees"] == pytest.approx(np.degrees(0.02), rel=0.1)
    assert [joint["name"] for joint in report["joints"]] == list(walk(seconds=0).skeleton.names)
    assert report["spikes"] == report["jumps"] == report["missing_samples"] == 0


def test_info_finds_what_is_wrong(tmp_path):
    clip = walk(seconds=1)
    rotations = clip.rotations.copy()
    rotations[40, 4] = qf.multiply(rotations[40, 4], [np.cos(0.5), 0.0, np.sin(0.5), 0.0])
    rotations[70:, 6] = qf.multiply(rotations[70:, 6], [np.cos(0.4), np.sin(0.4), 0.0, 0.0])
    rotations[20:23, 8] = np.nan
    rotations[100] = rotations[99]
    translation = clip.translation.copy()
    translation[5] = np.nan
    qf.write_motion(tmp_path / "bad.npz", clip.replace(rotations=rotations, translation=translation))
    report = json.loads(run("info", tmp_path / "bad.npz", "--json").stdout)
    joints = report["joints"]
    assert report["spikes"] == joints[4]["spikes"] == 1
    assert report["jumps"] == joints[6]["jumps"] == 1
    assert report["missing_samples"] == joints[8]["missing_samples"] == 3
    assert report["missing_positions"] == 1
    assert report["frozen_frames"] == 1
    assert joints[4]["largest_step_degrees"] == pytest.approx(np.degrees(1), abs=5)
    assert (
        "3 missing samples, 1 missing root position, 1 spike, 1 jump, 1 frozen frame"
        in run("info", tmp_path / "bad.npz").stdout
    )


def test_compare(folder):
    done = run("compare", folder / "truth.bvh", folder / "noisy.bvh")
    assert "peak signal-to-noise ratio, dB" in done.stdout
    report = json.loads(run("compare", folder / "truth.bvh", folder / "noisy.bvh", "--json").stdout)
    truth, noisy = qf.read_motion(folder / "truth.bvh"), qf.read_motion(folder / "noisy.bvh")
    assert report["psnr"] == pytest.approx(qf.metrics.psnr(truth.rotations, noisy.rotations))
    assert report["angle_mean"] == pytest.approx(qf.metrics.angle_error(truth.rotations, noisy.rotations))
    assert report["position"] == pytest.approx(qf.metrics.position_error(truth, noisy))
    assert report["delay"] == pytest.approx(0, abs=0.1)
    assert len(report["joints"]) == 21


def test_compare_with_itself_has_no_infinity_in_json(folder):
    report = json.loads(run("compare", folder / "truth.bvh", folder / "truth.bvh", "--json").stdout)
    assert report["psnr"] is None
    assert report["angle_mean"] == 0
    assert "∞" in run("compare", folder / "truth.bvh", folder / "truth.bvh").stdout


def test_compare_refuses_other_clips(folder):
    truth = folder / "truth.bvh"
    assert "expected the same number of frames, got 180 and 120" in refused(
        "compare", truth, folder / "short.bvh"
    )
    message = refused("compare", truth, folder / "renamed.npz")
    assert "expected the same joints, got other joints; renamed.npz lacks Hips" in message


def test_demo(tmp_path):
    report = json.loads(run("demo", "-o", tmp_path / "d", "--seed", 3, "--seconds", 3, "--json").stdout)
    assert report["denoised"]["psnr"] > report["noisy"]["psnr"] + 4
    assert report["denoised"]["foot_slide"] < report["noisy"]["foot_slide"] / 4
    assert 0.8 < report["denoised"]["peak_kept"] < 1.2 < report["noisy"]["peak_kept"]
    names = ["denoise.png", "denoised.bvh", "noisy.bvh", "truth.bvh"]
    assert sorted(path.name for path in (tmp_path / "d").iterdir()) == names
    assert (tmp_path / "d" / "denoise.png").read_bytes().startswith(b"\x89PNG")
    again = json.loads(run("demo", "-o", tmp_path / "e", "--seed", 3, "--seconds", 3, "--json").stdout)
    assert again["denoised"] == report["denoised"]
    compared = json.loads(
        run("compare", tmp_path / "d/truth.bvh", tmp_path / "d/denoised.bvh", "--json").stdout
    )
    assert compared["psnr"] == pytest.approx(report["denoised"]["psnr"], abs=1e-3)


def test_demo_without_matplotlib_says_how_to_get_it(tmp_path):
    (tmp_path / "matplotlib").mkdir()
    (tmp_path / "matplotlib" / "__init__.py").write_text("raise ImportError('not here')\n")
    done = run("demo", "-o", tmp_path / "d", "--seconds", 2, PYTHONPATH=str(tmp_path))
    assert "no picture: pictures need matplotlib: pip install 'quatfilt[plot]'" in done.stdout
    assert not (tmp_path / "d" / "denoise.png").exists()
    assert (tmp_path / "d" / "denoised.bvh").exists()


@pytest.mark.parametrize(
    "verb",
    [
        [],
        ["denoise"],
        ["info"],
        ["compare"],
        ["segment"],
        ["demo"],
        ["evaluate"],
        *(["evaluate", verb] for verb in EVALUATIONS),
    ],
)
def test_help(verb):
    text = run(*verb, "--help").stdout
    assert text.startswith("Usage: quatfilt")


def test_help_is_shown_for_h_and_for_nothing():
    assert run("-h").stdout == run().stdout


def test_version():
    assert run("--version").stdout.startswith("quatfilt 0.")


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["denoise"], "Missing argument"),
        (["polish"], "No such command 'polish'"),
        (["denoise", "absent.bvh"], "absent.bvh: No such file or directory"),
        (["denoise", "empty.bvh"], "empty.bvh: the file is empty"),
        (["denoise", "cut.bvh"], "cut.bvh: line "),
        (["denoise", "binary.bvh"], "binary.bvh: "),
        (["denoise", "notes.txt"], "notes.txt: expected .bvh, .amc or .npz, got .txt"),
        (["denoise", "directory.bvh"], "directory.bvh: Is a directory"),
        (["denoise", "alone.amc"], "alone.amc"),
        (["denoise", "noisy.bvh", "-o", "noisy.bvh"], "noisy.bvh: this is the input"),
        (["denoise", "noisy.bvh", "-o", "there/is/none.bvh"], "none.bvh: No such directory"),
        (["denoise", "noisy.bvh", "-o", "out.amc"], "out.amc: AMC is read only"),
        (["denoise", "noisy.bvh", "--method", "magic"], "method: expected one of 'auto'"),
        (
            ["denoise", "noisy.bvh", "--method", "nonlocal-pose-means", "--bandwidth", "-1"],
            "--bandwidth: expected a number above 0, got -1",
        ),
        (
            ["denoise", "noisy.bvh", "--method", "nonlocal-pose-means", "--bandwidth", "nan"],
            "--bandwidth: expected a number above 0, got nan",
        ),
        (
            ["denoise", "noisy.bvh", "--method", "nonlocal-pose-means", "--bandwidth", "wide"],
            "bandwidth: expected 'auto', a number or one per joint, got 'wide'",
        ),
        (
            ["denoise", "noisy.bvh", "--method", "nonlocal-pose-means", "--search-radius", "0"],
            "search_radius: expected an integer of at least 1",
        ),
        (
            ["denoise", "noisy.bvh", "--method", "nonlocal-pose-means", "--search-radius", "far"],
            "--search-radius: expected a number of frames or all",
        ),
        (
            ["denoise", "noisy.bvh", "--method", "nonlocal-pose-means", "--patch-radius", "x"],
            "--patch-radius",
        ),
        (
            ["denoise", "noisy.bvh", "--method", "nonlocal-pose-means", "--patch-radius", "-1"],
            "patch_radius: expected an integer of at least 0",
        ),
        (
            ["denoise", "noisy.bvh", "--method", "nonlocal-pose-means", "--chart", "flat"],
            "chart: expected one of 'mean'",
        ),
        (["denoise", "noisy.bvh", "--fps", "0"], "fps: expected a number above 0, got 0"),
        (["denoise", "noisy.bvh", "--threads", "0"], "--threads: expected at least 1, got 0"),
        (["denoise", "noisy.bvh", "--first-frame", "burn"], "first_frame: expected one of 'auto'"),
        (["denoise", "noisy.bvh", "--wavelets"], "No such option"),
        (["info", "absent.bvh"], "absent.bvh: No such file or directory"),
        (["compare", "truth.bvh", "absent.bvh"], "absent.bvh: No such file or directory"),
        (["demo", "--sigma", "-1"], "--sigma: expected a number of at least 0, got -1"),
        (["demo", "--seconds", "0"], "--seconds: expected a number above 0"),
        (["demo", "-o", "truth.bvh"], "truth.bvh"),
    ],
)
def test_bad_input_is_one_line_and_nothing_is_written(folder, words, message, capsys, monkeypatch):
    monkeypatch.chdir(folder)
    before = sorted(folder.rglob("*"))
    assert main(words) == 2
    said = capsys.readouterr()
    assert said.out == ""
    assert said.err.startswith("quatfilt: ")
    assert said.err.count("\n") == 1
    assert message in said.err
    assert sorted(folder.rglob("*")) == before


@pytest.mark.parametrize(
    "words",
    [
        ["denoise", "noisy.bvh", "-o", "notes.txt/out.bvh"],
        ["denoise", "noisy.bvh", "-o", "nowhere/out.bvh"],
        ["denoise", "noisy.bvh", "-o", "out.bvh", "--report", "nowhere/out.png"],
        ["denoise", "noisy.bvh", "-o", "out.bvh", "--report", "nowhere/out.json"],
        ["pga", "truth.bvh", "-o", "nowhere/out.png"],
        ["pga", "truth.bvh", "-o", "notes.txt/out.svg"],
        ["segment", "truth.bvh", "--picture", "nowhere/out.png"],
        ["database", "build", "truth.bvh", "-o", "nowhere/out.db"],
        ["database", "build", "truth.bvh", "-o", "nowhere/out.db", "--graph"],
        ["evaluate", "pga-figs", "--seeds", "1", "-o", "notes.txt/out"],
        ["demo", "-o", "notes.txt/out"],
        ["batch", "truth.bvh", "-o", "notes.txt/out"],
    ],
)
def test_a_place_that_cannot_be_written_is_named(folder, words, tmp_path, capsys, monkeypatch):
    for name in ("noisy.bvh", "truth.bvh", "notes.txt"):
        (tmp_path / name).write_bytes((folder / name).read_bytes())
    monkeypatch.chdir(tmp_path)
    assert main(words) == 2
    said = capsys.readouterr().err
    place = re.escape(words[-1] if words[-1] != "--graph" else words[-2])
    assert re.fullmatch(
        rf"quatfilt: {place}(/\S+)?: (No such (file or )?directory|Not a directory)\n", said
    ), said


def test_bad_input_of_the_process(folder):
    assert refused("denoise", "absent.bvh", cwd=folder) == "absent.bvh: No such file or directory"
    assert refused("polish", cwd=folder).startswith("No such command")


def test_a_traceback_comes_only_when_asked_for(folder):
    done = run("denoise", folder / "absent.bvh", "--debug", status=1)
    assert "Traceback" in done.stderr
    assert "FileAccessError" in done.stderr


def test_a_pipe_that_closes_early_is_no_error(folder):
    command = [*COMMAND, "info", str(folder / "noisy.npz")]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        process.stdout.close()
        assert process.stderr.read() == b""
    assert process.returncode == 0


def test_an_output_that_cannot_say_degrees_does_not_fail(folder):
    done = run("info", folder / "noisy.npz", PYTHONIOENCODING="ascii")
    assert "21 joints" in done.stdout


@pytest.mark.skipif(os.name == "nt", reason="not on this platform: signals")
@pytest.mark.usefixtures("ctrl_c")
def test_an_interrupted_process_says_so(tmp_path):
    # The command is at work once it has opened the pipe, and then waits for what never comes.
    pipe, output = tmp_path / "pipe.bvh", tmp_path / "out.bvh"
    output.write_text("old")
    os.mkfifo(pipe)
    command = [*COMMAND, "denoise", str(pipe), "-o", str(output)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        writer = opened(pipe, process)
        process.send_signal(signal.SIGINT)
        _, said = process.communicate(timeout=PATIENCE)
        os.close(writer)
    assert process.returncode == 130
    assert said == "quatfilt: interrupted\n"
    assert output.read_text() == "old"


def test_an_interruption_while_writing_leaves_the_old_file(folder, tmp_path, capsys, monkeypatch):
    def interrupted(*_):
        raise KeyboardInterrupt

    output = tmp_path / "out.bvh"
    output.write_text("old")
    monkeypatch.setattr("quatfilt.formats.bvh.write", interrupted)
    assert main(["denoise", str(folder / "noisy.bvh"), "-o", str(output)]) == 130
    assert capsys.readouterr().err == "quatfilt: interrupted\n"
    assert output.read_text() == "old"
    assert list(tmp_path.iterdir()) == [output]


def test_errors_of_the_package_itself_are_not_the_users(folder, capsys, monkeypatch):
    def wrong(*_, **__):
        raise KeyError("surprise")

    monkeypatch.setattr(sys.modules["quatfilt.cli.info"], "describe", wrong)
    assert main(["info", str(folder / "noisy.bvh")]) == 1
    assert (
        capsys.readouterr().err
        == "quatfilt: internal error: KeyError('surprise'); --debug shows where it comes from\n"
    )


def test_too_little_memory_is_said_in_one_line(folder, capsys, monkeypatch):
    def too_much(*_, **__):
        raise MemoryError

    monkeypatch.setattr(sys.modules["quatfilt.cli.info"], "describe", too_much)
    assert main(["info", str(folder / "noisy.bvh")]) == 2
    assert capsys.readouterr().err == "quatfilt: not enough memory\n"
