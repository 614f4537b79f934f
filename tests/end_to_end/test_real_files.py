"""The command line on real motion capture."""

import json
import subprocess
import sys

import numpy as np
import pytest
import quatfilt as qf
from patience import PATIENCE
from quatfilt.filters import despike

COMMAND = [sys.executable, "-m", "quatfilt"]


def run(*arguments):
    done = subprocess.run(
        [*COMMAND, *map(str, arguments)],
        capture_output=True,
        text=True,
        encoding="utf-8",
        check=False,
        timeout=PATIENCE,
    )
    assert (done.returncode, done.stderr) == (0, "")
    return json.loads(done.stdout)


@pytest.mark.parametrize(
    "name",
    ["cmu/09/09_01.amc", "bvh/02_01.mb.bvh", "bvh/louise.bvh", "bvh/dab.bvh", "bvh/nan_row_sideskip.bvh"],
)
def test_info_denoise_and_compare(data_dir, tmp_path, name):
    source = data_dir / name
    output = tmp_path / "clean.bvh"
    described = run("info", source, "--json")
    report = run("denoise", source, "-o", output, "--json")
    assert report["frames"] == described["frames"]
    original, cleaned = qf.read_motion(source), qf.read_motion(output)
    assert cleaned.skeleton.names == original.skeleton.names
    assert len(cleaned) == len(original)
    assert np.isfinite(cleaned.rotations).all()
    compared = run("compare", source, output, "--json")
    # What is taken away is of the size of the noise that was found, and nothing becomes faster.
    assert compared["angle_mean"] < 5 * described["noise_degrees"]
    assert compared["position"] < 2
    assert 0.75 < compared["peak_kept"] < 1.02


@pytest.mark.parametrize(
    ("name", "joint", "frames"),
    [
        ("05/05_05", "ltoes", [549, 550]),
        ("05/05_06", "ltoes", [268, 269]),
        ("05/05_18", "ltoes", [78]),
        ("02/02_09", "rtoes", [412, 477, 620]),
        ("16/16_17", "root", [474]),
        ("09/09_10", "lradius", []),  # by 118 degrees from the fourth frame to the fifth: a jump, which stays
    ],
)
def test_spikes_of_recordings(data_dir, name, joint, frames):
    motion = qf.read_motion(data_dir / f"cmu/{name}.amc")
    index = motion.skeleton.names.index(joint)
    found = despike.spikes(motion.rotations)
    assert set(frames) <= set(np.flatnonzero(found[:, index]).tolist())
    assert found.mean() < 0.005
    result = qf.despike(motion.rotations)
    np.testing.assert_array_equal(abs(result[~found]), abs(motion.rotations[~found]))
    steps = np.degrees(qf.geodesic_distance(result[1:, index], result[:-1, index]))
    assert all(steps[frame - 1] < 15 for frame in frames)
    if not frames:
        assert steps.max() > 100


def test_noise_on_a_recording_is_taken_away(data_dir, tmp_path):
    truth = qf.read_motion(data_dir / "cmu/07/07_01.amc")
    noisy = truth.replace(rotations=qf.add_gaussian_noise(truth.rotations, sigma=0.03, rng=3))
    qf.write_motion(tmp_path / "truth.bvh", truth)
    qf.write_motion(tmp_path / "noisy.bvh", noisy)
    run("denoise", tmp_path / "noisy.bvh", "--json")
    before = run("compare", tmp_path / "truth.bvh", tmp_path / "noisy.bvh", "--json")
    after = run("compare", tmp_path / "truth.bvh", tmp_path / "noisy.clean.bvh", "--json")
    assert after["psnr"] > before["psnr"] + 5
    assert after["angle_mean"] < before["angle_mean"] / 2


def test_acclaim_and_its_bvh_are_compared_in_one_unit(data_dir, tmp_path):
    unchanged = ["--method", "nonlocal-pose-means", "--bandwidth", "1e-6"]
    run("denoise", data_dir / "cmu/07/07_01.amc", "-o", tmp_path / "same.bvh", *unchanged, "--json")
    compared = run("compare", data_dir / "cmu/07/07_01.amc", tmp_path / "same.bvh", "--json")
    assert compared["position"] < 1e-3
    assert compared["foot_slide"] == pytest.approx(compared["foot_slide_reference"], rel=1e-3)


def test_a_broken_file_is_refused_with_its_line(data_dir):
    done = subprocess.run(
        [*COMMAND, "info", str(data_dir / "bvh/output1_nohierarchy.bvh")],
        capture_output=True,
        text=True,
        encoding="utf-8",
        check=False,
        timeout=PATIENCE,
    )
    assert done.returncode == 2
    assert done.stderr.count("\n") == 1
    assert "output1_nohierarchy.bvh: line 1: " in done.stderr
