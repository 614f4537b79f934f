"""What a report says of a filter, and in which words it refuses."""

import json
import math
from dataclasses import asdict

import clips
import numpy as np
import pytest
import quatfilt as qf
from quatfilt.evaluation.synthetic import walk
from quatfilt.motion.report import picture

SIGMA = 0.02
SPIKES = ((40, 3), (90, 5), (91, 7))


@pytest.fixture(scope="module", name="motions")
def walk_with_noise_gaps_and_spikes():
    truth = walk(seconds=2)
    rotations = qf.add_gaussian_noise(truth.rotations, sigma=SIGMA, rng=1)
    for frame, joint in SPIKES:
        rotations[frame, joint] = qf.multiply(rotations[frame, joint], [np.cos(0.5), np.sin(0.5), 0.0, 0.0])
    rotations[60:70, 4] = np.nan
    rotations[10, 6] = 0
    noisy = truth.replace(rotations=rotations)
    return noisy, qf.denoise(truth.replace(rotations=truth.rotations)), truth


@pytest.fixture(scope="module", name="report")
def report_of_a_walk(motions):
    return qf.report(motions[0], motions[1], reference=motions[2])


def test_noise_gaps_and_spikes_are_counted(report):
    overall = report.overall
    assert overall.noise_before == pytest.approx(np.degrees(SIGMA), rel=0.1)
    assert overall.noise_after < 0.1 * overall.noise_before
    assert (overall.missing, overall.filled) == (11, 11)
    assert (overall.spikes, overall.spikes_replaced) == (3, 3)
    for number, joint in enumerate(report.joints):
        assert joint.spikes == sum(place == number for _, place in SPIKES)
        assert joint.missing == {4: 10, 6: 1}.get(number, 0)


def test_what_is_left_is_told_apart(motions):
    """Nothing is filled and no spike replaced where the filter does nothing."""
    overall = qf.report(motions[0], motions[0]).overall
    assert (overall.missing, overall.filled, overall.spikes, overall.spikes_replaced) == (11, 0, 3, 0)
    assert overall.change_mean == overall.change_max == 0
    assert overall.peak_kept == 1
    assert overall.jerk_before == overall.jerk_after
    assert math.isnan(overall.error_before)


def test_numbers_are_those_of_the_measures(motions, report):
    before, after, truth = (motion.rotations for motion in motions)
    each = {
        "change_mean": qf.metrics.angle_error(before, after, per="joint"),
        "jerk_before": qf.metrics.jerk(before, fps=120, per="joint"),
        "jerk_reference": qf.metrics.jerk(truth, fps=120, per="joint"),
        "peak_kept": qf.metrics.peak_velocity_kept(before, after, per="joint"),
        "peak_before": qf.metrics.peak_velocity_kept(truth, before, per="joint"),
        "error_after": qf.metrics.angle_error(truth, after, per="joint"),
        "psnr_before": qf.metrics.psnr(truth, before, per="joint"),
    }
    for name, expected in each.items():
        np.testing.assert_allclose([getattr(joint, name) for joint in report.joints], expected, rtol=1e-12)
    assert report.overall.change_mean == pytest.approx(qf.metrics.angle_error(before, after))
    assert report.overall.psnr_before == pytest.approx(qf.metrics.psnr(truth, before))
    angles = qf.metrics.angle_error(before, after, per="sample")
    assert report.overall.change_p95 == pytest.approx(np.nanpercentile(angles, 95))
    np.testing.assert_allclose([joint.change_max for joint in report.joints], np.nanmax(angles, axis=0))


def test_feet_slide_while_the_reference_stands(motions, report):
    before, after, truth = motions
    names = [foot.name for foot in report.feet]
    assert names == [name for name in truth.skeleton.names if "Toe" in name or "Ankle" in name]
    for name, motion in (("before", before), ("after", after), ("reference", truth)):
        expected = qf.metrics.foot_slide(motion, reference=truth, per="joint")
        np.testing.assert_allclose([getattr(foot, f"slide_{name}") for foot in report.feet], expected)
    alone = qf.report(before, after)
    expected = qf.metrics.foot_slide(before, reference=after, per="joint")
    np.testing.assert_allclose([foot.slide_before for foot in alone.feet], expected)
    assert all(math.isnan(foot.slide_reference) for foot in alone.feet)


def test_arrays_have_no_feet_and_frames_for_seconds(motions):
    before, after, truth = (motion.rotations for motion in motions)
    by_frames = qf.report(before, after, reference=truth)
    assert by_frames.feet == ()
    assert by_frames.fps == 1
    assert by_frames.joints[3].name == "joint 3"
    assert by_frames.overall.jerk_after == pytest.approx(qf.metrics.jerk(after))
    # Spikes are those of 120 frames per second, as for the motion.
    assert by_frames.overall.spikes == 3
    by_seconds = qf.report(before, after, reference=truth, fps=120)
    assert by_seconds.overall.jerk_after == pytest.approx(qf.metrics.jerk(after, fps=120))
    last = [np.roll(q, -1, axis=-1) for q in (before, after)]
    assert asdict(qf.report(*last, fps=120, scalar_first=False).overall) == pytest.approx(
        asdict(qf.report(before, after, fps=120).overall), nan_ok=True
    )


def test_one_series():
    rng = np.random.default_rng(0)
    q = clips.noisy(rng, clips.smooth(rng, 60, 1), 0.03)[:, 0]
    report = qf.report(q, qf.denoise(q))
    assert len(report.joints) == 1
    assert report.joints[0].change_mean == report.overall.change_mean > 0


def test_the_dictionary_is_json(motions, report):
    loaded = json.loads(json.dumps(report.as_dict(), allow_nan=False))
    assert loaded["overall"]["psnr_after"] == pytest.approx(report.overall.psnr_after)
    assert len(loaded["joints"]) == 21
    without = qf.report(motions[0], motions[1]).as_dict()
    assert without["overall"]["error_after"] is None
    assert without["feet"][0]["slide_reference"] is None
    itself = qf.report(motions[2], motions[2], reference=motions[2]).as_dict()
    assert itself["overall"]["psnr_after"] is None


def test_the_text_has_the_numbers(motions, report):
    text = str(report)
    assert text.startswith("240 frames of 21 joints: turned by ")
    assert f"{report.overall.noise_before:.3f}" in text
    assert "missing samples" in text
    assert "reference" in text
    most = max(report.joints, key=lambda joint: joint.change_mean).name
    assert text.index(most) < text.index(report.feet[0].name, text.index("foot slide, cm"))
    assert not any(line.endswith(" ") for line in text.splitlines())
    alone = str(qf.report(motions[0], motions[1]))
    assert "reference" not in alone
    assert "error" not in alone
    assert repr(report).startswith("Report(240 frames of 21 joints, changed by ")


@pytest.mark.parametrize("extension", ["png", "pdf", "svg", "json", "txt"])
@pytest.mark.parametrize("reference", [True, False])
def test_files(motions, tmp_path, extension, reference):
    report = qf.report(motions[0], motions[1], reference=motions[2] if reference else None)
    path = tmp_path / f"report.{extension}"
    report.write(path)
    content = path.read_bytes()
    begins = {"png": b"\x89PNG", "pdf": b"%PDF", "svg": b"<?xml", "json": b"{", "txt": b"240 frames"}
    assert content.startswith(begins[extension])
    assert list(tmp_path.iterdir()) == [path]
    if extension == "json":
        assert json.loads(content) == json.loads(json.dumps(report.as_dict()))


@pytest.mark.parametrize("frames", [0, 1, 2, 5])
@pytest.mark.parametrize("missing", [True, False])
def test_the_shortest_clips(tmp_path, frames, missing):
    clip = walk(seconds=1)
    rotations = clip.rotations[:frames].copy()
    if missing:
        rotations[:, 2] = np.nan
    short = qf.Motion(rotations, clip.translation[:frames], fps=120, skeleton=clip.skeleton)
    report = qf.report(short, short, reference=short)
    assert report.frames == frames
    assert str(report)
    for name in ("report.png", "report.json"):
        report.write(tmp_path / name)


def test_without_joints(tmp_path):
    report = qf.report(np.zeros((5, 0, 4)), np.zeros((5, 0, 4)))
    assert report.joints == ()
    assert str(report)
    report.write(tmp_path / "report.png")


def test_the_axis_of_the_jerk_has_no_room_for_rounding():
    """A joint that does not move has a jerk of its rounding: the others would be dots in a corner."""
    assert picture._moving([3e3, 4e2, 5e-10, 1e-30, 0.0, math.nan]) == [3e3, 4e2]
    assert picture._moving([0.0, math.nan]) == []


def test_pictures_need_matplotlib(report, tmp_path, monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "matplotlib.figure", None)
    with pytest.raises(ImportError) as caught:
        report.write(tmp_path / "report.png")
    assert str(caught.value) == "pictures need matplotlib: pip install 'quatfilt[plot]'"
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(("name", "got"), [("report.gif", ".gif"), ("report", "no extension")])
def test_other_extensions(report, tmp_path, name, got):
    with pytest.raises(ValueError, match="path: ") as caught:
        report.write(tmp_path / name)
    assert str(caught.value) == f"path: expected .png, .pdf, .svg, .json or .txt, got {got}"


def test_a_folder_that_is_not_there(report, tmp_path):
    with pytest.raises(qf.FileAccessError):
        report.write(tmp_path / "nowhere" / "report.json")


def refused(kind, *arguments, **options):
    with pytest.raises(kind) as caught:
        qf.report(*arguments, **options)
    return str(caught.value)


def test_clips_that_do_not_fit(motions):
    noisy, clean, truth = motions
    q = noisy.rotations
    assert refused(TypeError, noisy, clean.rotations) == "after: expected a Motion as before, got ndarray"
    assert refused(TypeError, q, q, reference=truth) == "reference: expected rotations as before, got Motion"
    assert refused(ValueError, q, q[:9]) == (
        "after: expected the shape of before, (240, 21, 4), got (9, 21, 4)"
    )
    assert refused(ValueError, noisy, clean, reference=walk(seconds=1)) == (
        "reference: expected the shape of before, (240, 21, 4), got (120, 21, 4)"
    )
    assert refused(ValueError, noisy, clean.replace(fps=60)) == (
        "after: expected the frame rate of before, 120, got 60"
    )
    skeleton = truth.skeleton
    renamed = truth.replace(
        skeleton=qf.Skeleton(["Pelvis", *skeleton.names[1:]], skeleton.parents, skeleton.offsets)
    )
    assert (
        refused(ValueError, noisy, renamed) == "after: expected the joints of before, got none called 'Hips'"
    )
    assert refused(ValueError, noisy, clean, fps=0) == "fps: expected a number above 0, got 0"
    assert refused(ValueError, q, np.ones((3, 3))) == "after: expected shape (..., 4), got (3, 3)"


def test_nothing_is_written(motions):
    before = [motion.rotations.tobytes() for motion in motions]
    qf.report(motions[0], motions[1], reference=motions[2])
    assert [motion.rotations.tobytes() for motion in motions] == before


def test_what_held_the_feet_is_told(motions):
    noisy, _, truth = motions
    filtered = qf.denoise(noisy, method="gaussian", sigma=0.03, feet=None)
    kept = qf.denoise(noisy, method="gaussian", sigma=0.03)
    told = qf.report(noisy, kept, filtered=filtered, reference=truth).placed
    turned = np.asarray(qf.metrics.angle_error(filtered.rotations, kept.rotations, per="sample"))
    frame, joint = np.unravel_index(np.argmax(turned), turned.shape)
    assert (told.joint, told.frame, told.turned_max) == (truth.skeleton.names[joint], frame, turned.max())
    assert told.frames == (turned > 0).any(axis=1).sum()
    assert f"by at most {told.turned_max:.2f}°" in str(qf.report(noisy, kept, filtered=filtered))
    assert "no joint was turned" in str(qf.report(noisy, filtered, filtered=filtered))
    assert qf.report(noisy, kept).placed is None
    with pytest.raises(ValueError, match="filtered: expected the shape of"):
        qf.report(
            noisy,
            kept,
            filtered=truth.replace(rotations=truth.rotations[:5], translation=truth.translation[:5]),
        )
    with pytest.raises(TypeError, match="filtered: expected None with rotations"):
        qf.report(noisy.rotations, kept.rotations, filtered=filtered)


def test_the_noise_before_is_named():
    truth = walk(seconds=4)
    vectors = np.random.default_rng(3).normal(0, 0.015, (*truth.rotations.shape[:2], 3))
    vectors[:240] *= 4
    noisy = truth.replace(rotations=qf.multiply(truth.rotations, qf.exp(vectors)))
    result = qf.report(noisy, truth)
    assert "colour: white" in result.noise
    assert "along time: unsteady" in result.noise
    assert "repeats: none" in result.noise
    assert result.as_dict()["noise"] == result.noise
    assert f"Noise before: {result.noise}." in str(result)
