"""Recordings of consumer trackers: acceptance without truth."""

import json

import numpy as np
import pytest
import quatfilt as qf
from quatfilt.cli import main
from quatfilt.cli.info import describe
from quatfilt.evaluation import trackers, trackers_page

JITTERING = ("azure", "mediapipe")
FILTERED = ("xsens", "mocapnet")
"""Takes that are clean already."""


@pytest.fixture(scope="module", name="takes")
def all_takes(data_dir):
    return {take.name: take for take in trackers.run(data_dir)}


def of(takes, names):
    found = [take for name, take in takes.items() if name.startswith(names)]
    assert found
    return found


def test_jerk_of_kinect_and_mediapipe_goes(takes):
    assert np.median([take.jerk_left for take in of(takes, JITTERING)]) <= 0.45


def test_the_slow_path_stays(takes):
    found = of(takes, JITTERING)
    assert np.median([take.slow_moved for take in found]) <= 0.3
    assert all(take.masked < 0.6 for take in found)


def test_the_preset_for_video(takes):
    found = [take.presets["video"] for take in of(takes, JITTERING)]
    assert np.median([one["jerk_left"] for one in found]) <= 0.45
    assert np.median([one["slow_moved"] for one in found]) <= 0.3


@pytest.mark.parametrize("preset", ["optical", "inertial", "video"])
def test_presets_hardly_change_takes_that_are_clean(takes, preset):
    for take in of(takes, FILTERED):
        assert take.presets[preset]["change"] < 0.02
        assert take.presets[preset]["jerk_left"] > 0.95


def test_peaks_stay(takes):
    assert np.mean([take.peaks_kept for take in takes.values()]) >= 0.95
    assert min(take.peaks_kept for take in takes.values()) >= 0.93


def test_withheld_measurements_are_no_worse_than_straight_lines(takes):
    """In degrees; a tenth is the scatter of the few measurements that are withheld."""
    for take in takes.values():
        assert take.withheld <= take.withheld_plain + 0.1


def test_takes_that_are_clean_are_hardly_changed(takes):
    for take in of(takes, FILTERED):
        assert take.change < 0.02
        assert take.jerk_left > 0.95
    assert takes["mediapipe_dance7"].change < 0.1


def test_results_move_as_people_do_where_the_source_is_mended(takes):
    azure = takes["azure_kinect_a"]
    assert azure.speed < 8
    assert azure.acceleration < 210


def test_sources_are_named(takes):
    assert takes["azure_kinect_a"].source.startswith(
        "interpolated source: measured every 6.97 frames (14.4 per second)"
    )
    assert "frozen frames: 146 in 12" in takes["mediapipe_dance"].source
    assert takes["shadermotion_vr"].source.startswith("held source")
    assert takes["mediapipe_flips"].flips > 5
    for name in ("xsens_boxlift", "mocapnet_push", "mediapipe_dance1"):
        assert takes[name].source == ""


def test_info_and_the_report_say_the_same(takes):
    take = takes["azure_kinect_a"]
    assert describe(take.before)["source"]["says"] == take.source
    assert describe(takes["mediapipe_flips"].before)["flips"] == takes["mediapipe_flips"].flips
    report = qf.report(take.before, take.after)
    assert report.source == take.source
    assert take.source in str(report)


def test_clean_recordings_are_regular_and_do_not_jitter(data_dir):
    """At three frame rates; 05_16 has the quickest joints of the collection."""
    from quatfilt import sampling
    from quatfilt._backend import ops
    from quatfilt.evaluation.clips import load

    names = dict.fromkeys(("05_16", "09_01", "14_02", "16_29", "16_41", "86_01"), "")
    for clip in load(data_dir, names, longest=1500):
        for every in (1, 2, 4):
            q = np.ascontiguousarray(clip.motion.rotations[::every])
            source = sampling.recognised(q, 120 / every)
            assert source.kind == "regular"
            assert not source.frozen.any()
            assert ops().tracker_noise(q, 120 / every)[0] == 0


def test_the_page_the_numbers_and_the_picture(takes, tmp_path):
    report = trackers_page.Report(list(takes.values()), "0.0", "the command")
    page, numbers = trackers_page.markdown(report), trackers_page.as_dict(report)
    json.dumps(numbers)
    first = numbers["takes"][0]
    assert f"| {first['name']} |" in page
    assert f"{first['slow_moved']:.3f}" in page
    assert f"{first['presets']['video']['jerk_left']:.2f} / " in page
    trackers_page.draw(report, tmp_path / "trackers.png")
    assert (tmp_path / "trackers.png").read_bytes().startswith(b"\x89PNG")


def test_a_folder_without_recordings_is_refused(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert main(["evaluate", "trackers", "--data", "."]) == 2
    assert "expected recordings of trackers" in capsys.readouterr().err
