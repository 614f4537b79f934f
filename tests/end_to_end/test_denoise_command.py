"""``quatfilt denoise``: chains, presets, options and reports."""

import json

import numpy as np
import pytest
import quatfilt as qf
from commands import refused, run
from quatfilt.cli import main
from quatfilt.evaluation.synthetic import walk
from quatfilt.methods import FILTERS
from quatfilt.presets import PRESETS


@pytest.fixture(scope="module", name="folder")
def folder_of_clips(tmp_path_factory):
    folder = tmp_path_factory.mktemp("clips")
    truth = walk(seconds=1.5)
    noisy = truth.replace(rotations=qf.add_gaussian_noise(truth.rotations, sigma=0.02, rng=1))
    qf.write_motion(folder / "truth.npz", truth)
    qf.write_motion(folder / "noisy.npz", noisy)
    qf.write_motion(folder / "short.npz", walk(seconds=1))
    np.save(folder / "trust.npy", np.linspace(0, 1, 180))
    np.savetxt(folder / "trust.csv", np.linspace(0, 1, 180))
    np.save(folder / "wrong.npy", np.ones(3))
    (folder / "words.txt").write_text("high low")
    return folder


def same(path, expected):
    result = qf.read_motion(path)
    assert np.degrees(qf.geodesic_distance(result.rotations, expected.rotations)).max() < 1e-5
    np.testing.assert_allclose(result.translation, expected.translation, atol=1e-6)


CHAIN = {
    "method": ["bilateral", "orientation_filter"],
    "bilateral": {"radius": 2, "sigma_angle": np.radians(8), "iterations": 2},
    "mask": [1, 2, 1],
    "boundary": "nearest",
}

WORDS = [
    "--option bilateral.radius=2 --option bilateral.sigma-angle=8 --option bilateral.iterations=2",
    "--option mask=1,2,1 --boundary nearest",
]


@pytest.mark.parametrize("methods", ["bilateral,orientation-filter", "bilateral, orientation_filter"])
def test_chains(folder, tmp_path, methods):
    output = tmp_path / "out.npz"
    words = " ".join(WORDS).split()
    done = run("denoise", folder / "noisy.npz", "-o", output, "--method", methods, *words, "--json")
    same(output, qf.denoise(qf.read_motion(folder / "noisy.npz"), **CHAIN))
    steps = json.loads(done.stdout)["steps"]
    assert [step["method"] for step in steps] == CHAIN["method"]
    assert steps[0] | {"sigma_angle": 0} == {
        "method": "bilateral",
        "boundary": "nearest",
        "radius": 2,
        "sigma_angle": 0,
        "iterations": 2,
    }
    assert steps[1]["mask"] == [1, 2, 1]


def test_methods_that_are_named_one_by_one(folder, tmp_path):
    output = tmp_path / "out.npz"
    words = ["--method", "bilateral", "--method", "orientation-filter", *" ".join(WORDS).split()]
    run("denoise", folder / "noisy.npz", "-o", output, *words)
    same(output, qf.denoise(qf.read_motion(folder / "noisy.npz"), **CHAIN))


@pytest.mark.parametrize("name", PRESETS)
def test_presets(folder, tmp_path, name):
    output = tmp_path / "out.npz"
    run("denoise", folder / "noisy.npz", "-o", output, "--preset", name, "--max-gap", "0.3")
    same(output, qf.denoise(qf.read_motion(folder / "noisy.npz"), preset=name, max_gap=0.3))


@pytest.mark.parametrize(
    "word", ["--bandwidth=3", "--option=bandwidth=3", "--option=nonlocal-pose-means.bandwidth=3"]
)
def test_angles_are_degrees(folder, tmp_path, word):
    output = tmp_path / "out.npz"
    run("denoise", folder / "noisy.npz", "-o", output, "--method", "nonlocal-pose-means", word)
    expected = qf.denoise(
        qf.read_motion(folder / "noisy.npz"), method="nonlocal_pose_means", bandwidth=np.radians(3)
    )
    same(output, expected)


def test_words_that_are_values(folder, tmp_path):
    output = tmp_path / "out.npz"
    words = ["--option", "search_radius=none", "--option", "neighbors=20", "--option", "chart=local"]
    run("denoise", folder / "noisy.npz", "-o", output, "--method", "nonlocal_pose_means", *words)
    expected = qf.denoise(
        qf.read_motion(folder / "noisy.npz"),
        method="nonlocal_pose_means",
        search_radius=None,
        neighbors=20,
        chart="local",
    )
    same(output, expected)


def test_a_library_comes_from_files(folder, tmp_path):
    output = tmp_path / "out.npz"
    words = ["--method", "nonlocal_pose_means", "--neighbors", "8"]
    words += ["--library", folder / "truth.npz", "--library", folder / "short.npz"]
    done = run("denoise", folder / "noisy.npz", "-o", output, *words, "--json")
    noisy, *clean = (qf.read_motion(folder / f"{name}.npz") for name in ("noisy", "truth", "short"))
    library = [motion.rotations for motion in clean]
    same(output, qf.denoise(noisy, method="nonlocal_pose_means", neighbors=8, library=library))
    record = json.loads(done.stdout)
    assert record["library"] == [str(folder / "truth.npz"), str(folder / "short.npz")]
    assert "library" not in record["steps"][0]


def test_a_library_at_another_rate_is_resampled(folder, tmp_path):
    output, slow = tmp_path / "out.npz", tmp_path / "slow.npz"
    noisy, truth = (qf.read_motion(folder / f"{name}.npz") for name in ("noisy", "truth"))
    qf.write_motion(
        slow, truth.replace(rotations=truth.rotations[::2], translation=truth.translation[::2], fps=60)
    )
    words = ["--method", "nonlocal_pose_means", "--library", slow]
    run("denoise", folder / "noisy.npz", "-o", output, *words)
    library = qf.resample(truth.rotations[::2], fps=60, new_fps=truth.fps)
    same(output, qf.denoise(noisy, method="nonlocal_pose_means", library=library))


@pytest.mark.parametrize("file", ["trust.npy", "trust.csv"])
def test_confidence_comes_from_a_file(folder, tmp_path, file):
    output = tmp_path / "out.npz"
    words = ["--method", "nonlocal_pose_means", "--confidence", folder / file]
    done = run("denoise", folder / "noisy.npz", "-o", output, *words, "--json")
    trust = np.linspace(0, 1, 180)
    noisy = qf.read_motion(folder / "noisy.npz")
    same(output, qf.denoise(noisy, method="nonlocal_pose_means", confidence=trust))
    assert "confidence" not in json.loads(done.stdout)["steps"][0]


def test_reports_as_files(folder, tmp_path):
    files = [tmp_path / f"report.{extension}" for extension in ("png", "json", "txt")]
    words = [word for file in files for word in ("--report", file)]
    done = run(
        "denoise", folder / "noisy.npz", "-o", tmp_path / "o.npz", *words, "--reference", folder / "truth.npz"
    )
    for file in files:
        assert f"{file}: written" in done.stdout
    assert files[0].read_bytes().startswith(b"\x89PNG")
    told = json.loads(files[1].read_text())
    noisy, truth = (qf.read_motion(folder / name) for name in ("noisy.npz", "truth.npz"))
    expected = qf.report(noisy, qf.read_motion(tmp_path / "o.npz"), reference=truth)
    assert told["overall"]["error_before"] == pytest.approx(expected.overall.error_before)
    assert told["overall"]["error_after"] == pytest.approx(expected.overall.error_after, rel=1e-4)
    assert files[2].read_text().startswith("180 frames of 21 joints: turned by ")


def test_the_report_on_the_terminal(folder, tmp_path):
    done = run("denoise", folder / "noisy.npz", "-o", tmp_path / "o.npz", "--report", "-")
    assert "estimated noise, °" in done.stdout
    assert "Joints that changed most" in done.stdout
    assert "foot slide, cm" in done.stdout
    assert not (tmp_path / "-").exists()


def test_json_has_the_report(folder, tmp_path):
    done = run(
        "denoise", folder / "noisy.npz", "-o", tmp_path / "o.npz", "--json", "--report", tmp_path / "r.json"
    )
    result = json.loads(done.stdout)
    assert result["report"] == json.loads((tmp_path / "r.json").read_text())
    assert result["report"]["overall"]["change_mean"] == pytest.approx(result["change_degrees"])
    again = run("denoise", folder / "noisy.npz", "-o", tmp_path / "o.npz", "--json", "--report", "-")
    assert json.loads(again.stdout)["report"] == result["report"]
    without = run("denoise", folder / "noisy.npz", "-o", tmp_path / "o.npz", "--json")
    assert "report" not in json.loads(without.stdout)


def test_help_names_every_filter_option_and_preset():
    for verb in ("denoise", "batch"):
        text = run(verb, "--help").stdout
        for name, method in FILTERS.items():
            line = next(
                line for line in text.splitlines() if line.startswith(f"    {name.replace('_', '-')}: ")
            )
            for option in method.options:
                told = option in ("confidence", "fps", "gaps", "max_gap", "scalar_first")
                assert told or option.replace("_", "-") in line
        for name, preset in PRESETS.items():
            assert f"    {name}: {preset.about}" in text


BAD = [
    (["--method", "bilateral,magic"], "method[1]: expected one of 'auto', "),
    (["--method", ","], "method[0]: expected one of 'auto', "),
    (["--preset", "film"], "preset: expected one of 'optical', 'inertial', 'video', got 'film'"),
    (["--method", "orientation-filter"], "orientation_filter needs a value of mask: pass mask=…"),
    (
        ["--method", "bilateral", "--bandwidth", "2"],
        "bandwidth: no filter of the chain has this option; it has bilateral (radius, ",
    ),
    (["--option", "radius"], "--option: expected [METHOD.]NAME=VALUE, got 'radius'"),
    (["--option", "=3"], "--option: expected [METHOD.]NAME=VALUE, got '=3'"),
    (["--option", ".radius=3"], "--option: expected [METHOD.]NAME=VALUE, got '.radius=3'"),
    (["--option", "bilateral.=3"], "--option: expected [METHOD.]NAME=VALUE, got 'bilateral.=3'"),
    (["--option", "magic.radius=3"], "magic: no filter of the chain has this option; it has "),
    (
        ["--option", "bilateral.radius=3"],
        "bilateral: the chain has no such filter, only despike, smooth; add it to method",
    ),
    (
        ["--method", "bilateral", "--option", "bilateral.raduis=3"],
        "bilateral has no option raduis; it has radius, ",
    ),
    (["--method", "bilateral", "--option", "radius=wide"], "radius: expected an integer of at least 0"),
    (
        ["--method", "bilateral", "--option", "sigma-angle=-2"],
        "--option sigma-angle: expected a number above 0, got -2",
    ),
    (
        ["--method", "orientation-filter", "--option", "mask=1,x,1"],
        "--option mask: expected numbers with commas",
    ),
    (
        ["--method", "bilateral,orientation-filter", "--option", "mask=1,2,1", "--option", "iterations=2"],
        "iterations: bilateral, orientation_filter have this option; name the filter, as in bilateral=",
    ),
    (["--report", "report.gif"], "--report: expected .png, .pdf, .svg, .json or .txt, got .gif, or -"),
    (["--reference", "short.npz"], "expected the same number of frames, got 120 and 180"),
    (["--reference", "absent.npz"], "absent.npz: No such file or directory"),
    (["--library", "short.npz"], "library: no filter of the chain has this option; it has despike ("),
    (["--method", "nonlocal_pose_means", "--library", "absent.npz"], "absent.npz: No such file or directory"),
    (["--confidence", "absent.npy"], "absent.npy: No such file or directory"),
    (["--confidence", "words.txt"], "words.txt: expected a table of numbers ("),
    (["--confidence", "noisy.npz"], "noisy.npz: expected a table of numbers ("),
    (["--confidence", "wrong.npy"], "confidence: expected shape (180,) or (180, 21), got (3,)"),
]


@pytest.mark.parametrize(("words", "message"), BAD)
def test_bad_input_is_one_line_and_nothing_is_written(folder, words, message, capsys, monkeypatch):
    monkeypatch.chdir(folder)
    before = sorted(folder.rglob("*"))
    assert main(["denoise", "noisy.npz", "-o", "out.npz", *words]) == 2
    said = capsys.readouterr()
    assert said.out == ""
    assert said.err.startswith("quatfilt: ")
    assert said.err.count("\n") == 1
    assert message in said.err
    assert sorted(folder.rglob("*")) == before


def test_a_picture_without_matplotlib_is_refused_before_any_work(folder, tmp_path):
    (tmp_path / "matplotlib").mkdir()
    (tmp_path / "matplotlib" / "__init__.py").write_text("raise ImportError('not here')\n")
    words = ["denoise", folder / "noisy.npz", "-o", tmp_path / "o.npz", "--report", tmp_path / "r.png"]
    done = run(*words, status=2, PYTHONPATH=str(tmp_path))
    assert done.stderr == "quatfilt: pictures need matplotlib: pip install 'quatfilt[plot]'\n"
    assert not (tmp_path / "o.npz").exists()


@pytest.mark.parametrize("feet", ["keep", "lock", "none"])
def test_feet(folder, tmp_path, feet):
    output = tmp_path / "out.npz"
    words = ("-o", output, "--method", "gaussian", "--option", "sigma=0.03", "--feet", feet)
    noisy = qf.read_motion(folder / "noisy.npz")
    placement = None if feet == "none" else feet
    told = json.loads(run("denoise", folder / "noisy.npz", *words, "--report", "-", "--json").stdout)
    same(output, qf.denoise(noisy, method="gaussian", sigma=0.03, feet=placement))
    if placement is None:
        assert told["feet"] is None
        assert told["report"]["placed"] is None
        return
    assert told["feet"]["placement"] == feet
    assert told["feet"]["slide_after"] < told["feet"]["slide_filtered"]
    assert 0 < told["feet"]["turned_max"] == told["report"]["placed"]["turned_max"]
    assert told["feet"]["joint"] in noisy.skeleton.names
    text = run("denoise", folder / "noisy.npz", *words, "--report", "-").stdout
    assert {"keep": "feet kept: slide ", "lock": "feet locked: slide "}[feet] in text
    assert "Feet: joints were turned in " in text


def test_other_words_for_feet_are_refused(folder, tmp_path):
    said = refused("denoise", folder / "noisy.npz", "-o", tmp_path / "out.npz", "--feet", "hold")
    assert "--feet: expected one of 'keep', 'lock', 'none', got 'hold'" in said
