"""Scripts as users have them, run as programs in a folder of their own."""

import shutil
import subprocess
import sys
import textwrap

import clips
import numpy as np
import quatfilt as qf

FPS = 120
SIGMA = 0.03


def run(folder, script):
    """Run a script in a folder and return what it prints."""
    path = folder / "script.py"
    path.write_text(textwrap.dedent(script), encoding="utf-8")
    done = subprocess.run(
        [sys.executable, "-W", "error", path.name], cwd=folder, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


def error(truth, estimate):
    """Root mean square angle between two arrays of quaternions, scalar first."""
    return float(np.sqrt(np.mean(clips.angles(truth, estimate) ** 2)))


def truth_and_noise(joints=3, frames=360, seed=0):
    rng = np.random.default_rng(seed)
    truth = clips.walk(rng, frames, joints)
    return truth, clips.noisy(rng, truth, SIGMA)


HOME_MADE = """
    from scipy.ndimage import gaussian_filter1d
    from scipy.spatial.transform import Rotation

    def denoise(quaternions, scalar_first):
        vectors = Rotation.from_quat(quaternions, scalar_first=scalar_first).as_rotvec()
        smooth = gaussian_filter1d(vectors, 2, axis=0)
        return Rotation.from_rotvec(smooth).as_quat(scalar_first=scalar_first)
"""

WITH_A_FILTER = """
    import numpy as np
    from {module} import denoise

    quaternions = np.load("noisy.npy")  # (frames, 4), scalar last
    clean = denoise(quaternions, scalar_first=False)
    np.save("clean.npy", clean)
    print(clean.shape, clean.dtype)
"""


def test_only_the_import_changes(tmp_path):
    """A Gaussian over rotation vectors jumps where they leave the ball of radius π; the same script here does not."""
    rng = np.random.default_rng(0)
    turn = np.linspace(0, 2 * np.pi, 360)[:, None] * np.array([0.0, 0.6, 0.8])
    truth = clips.from_vectors(turn)
    np.save(tmp_path / "noisy.npy", np.roll(clips.noisy(rng, truth, SIGMA), -1, axis=-1))
    (tmp_path / "home_made.py").write_text(textwrap.dedent(HOME_MADE), encoding="utf-8")
    errors = {}
    for module in ("home_made", "quatfilt"):
        assert run(tmp_path, WITH_A_FILTER.format(module=module)) == "(360, 4) float64\n"
        clean = np.roll(np.load(tmp_path / "clean.npy"), 1, axis=-1)
        errors[module] = clips.angles(truth, clean).max()
    assert errors["home_made"] > 1
    assert errors["quatfilt"] < 5 * SIGMA


def test_from_scipy_to_scipy(tmp_path):
    truth, noisy = truth_and_noise(joints=1)
    np.save(tmp_path / "noisy.npy", noisy[:, 0])
    run(
        tmp_path,
        """
        import numpy as np
        import quatfilt as qf
        from scipy.spatial.transform import Rotation

        measured = Rotation.from_quat(np.load("noisy.npy"), scalar_first=True)
        clean = Rotation.from_quat(qf.nonlocal_pose_means(measured, scalar_first=False))
        np.save("clean.npy", clean.as_quat(scalar_first=True))
        np.save("matrices.npy", (clean * clean.inv()).as_matrix())
        """,
    )
    assert error(truth[:, 0], np.load(tmp_path / "clean.npy")) < 0.8 * error(truth, noisy)
    np.testing.assert_allclose(
        np.load(tmp_path / "matrices.npy"), np.tile(np.eye(3), (360, 1, 1)), atol=1e-12
    )


FOLDER = """
    from pathlib import Path

    import quatfilt as qf

    Path("clean").mkdir()
    for path in sorted(Path("takes").glob("*.bvh")):
        motion = qf.read_motion(path)
        qf.write_motion(Path("clean") / path.name, qf.denoise(motion))
        print(path.name, len(motion))
"""


def test_a_folder_of_files(tmp_path):
    takes = tmp_path / "takes"
    takes.mkdir()
    arm = qf.Skeleton(["hips", "arm", "hand"], [-1, 0, 1], [[0, 90, 0], [0, 40, 0], [0, 30, 0]])
    truths = {}
    for seed in range(3):
        truths[f"take{seed}.bvh"], noisy = truth_and_noise(seed=seed)
        path = clips.path(np.random.default_rng(seed), len(noisy))
        motion = qf.Motion(noisy, path, fps=FPS, skeleton=arm)
        qf.write_motion(takes / f"take{seed}.bvh", motion)
    before = {path.name: path.read_bytes() for path in takes.iterdir()}
    assert run(tmp_path, FOLDER) == "".join(f"take{seed}.bvh 360\n" for seed in range(3))
    assert {path.name: path.read_bytes() for path in takes.iterdir()} == before
    for name, truth in truths.items():
        noisy, clean = (qf.read_motion(tmp_path / folder / name) for folder in ("takes", "clean"))
        assert error(truth, clean.rotations) < 0.8 * error(truth, noisy.rotations)
        assert clean.fps == noisy.fps
        assert clean.skeleton.names == noisy.skeleton.names
        np.testing.assert_array_equal(clean.skeleton.offsets, noisy.skeleton.offsets)


REPORTED = """
    import json
    from pathlib import Path

    import quatfilt as qf

    for path in sorted(Path("takes").glob("*.bvh")):
        take = qf.read_motion(path)
        clean = qf.denoise(
            take, method=["bilateral", "nonlocal_pose_means"], bilateral={"radius": 1}, max_gap=0.5
        )
        told = qf.report(take, clean)
        told.write(path.with_suffix(".png"))
        told.write(path.with_suffix(".json"))
        overall = json.loads(path.with_suffix(".json").read_text(encoding="utf-8"))["overall"]
        print(path.name, overall["noise_after"] < 0.5 * overall["noise_before"], overall["filled"])
"""


def test_a_chain_and_its_report_for_each_file_of_a_folder(tmp_path):
    takes = tmp_path / "takes"
    takes.mkdir()
    arm = qf.Skeleton(["hips", "arm", "foot"], [-1, 0, 1], [[0, 90, 0], [0, -40, 0], [0, -30, 0]])
    for seed in range(2):
        _, noisy = truth_and_noise(seed=seed)
        path = clips.path(np.random.default_rng(seed), len(noisy))
        qf.write_motion(takes / f"take{seed}.bvh", qf.Motion(noisy, path, fps=FPS, skeleton=arm))
    text = (takes / "take0.bvh").read_text(encoding="utf-8").splitlines()
    text[-20:-10] = [" ".join(["nan"] * len(line.split())) for line in text[-20:-10]]
    (takes / "take0.bvh").write_text("\n".join(text), encoding="utf-8")
    assert run(tmp_path, REPORTED) == "take0.bvh True 30\ntake1.bvh True 0\n"
    assert {path.suffix for path in takes.iterdir()} == {".bvh", ".png", ".json"}


def test_a_folder_of_real_files(tmp_path, data_dir):
    takes = tmp_path / "takes"
    takes.mkdir()
    smallest = sorted((data_dir / "bvh").rglob("*.bvh"), key=lambda path: (path.stat().st_size, path.name))
    readable = [path for path in smallest if path.stat().st_size > 10_000][:4]
    for path in readable:
        shutil.copy(path, takes / path.name)
    assert len(run(tmp_path, FOLDER).splitlines()) == len({path.name for path in readable})
    for path in takes.iterdir():
        noisy, clean = qf.read_motion(path), qf.read_motion(tmp_path / "clean" / path.name)
        assert clean.rotations.shape == noisy.rotations.shape
        assert clean.fps == noisy.fps
        assert np.isfinite(clean.rotations).all()
        assert 0 < error(noisy.rotations, clean.rotations) < np.radians(20)
