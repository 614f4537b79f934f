"""Defects of recordings: where they are, and how what is left of them is measured."""

import clips
import numpy as np
import pytest
import quatfilt as qf
from quatfilt.evaluation import real_jitter
from quatfilt.evaluation.clips import find
from quatfilt.evaluation.methods import NOISY
from quatfilt.evaluation.real_jitter import BRIDGE, DEFECTS, Defect, bridged


def test_a_bridge_leads_from_the_last_good_frame_to_the_next():
    truth = clips.smooth(np.random.default_rng(0), 40, 2, swing=0.1)
    broken = truth.copy()
    broken[20:23] = clips.random_rotations(np.random.default_rng(1), 3, 2)
    bridge = bridged(broken, Defect("", "", 20, 22, ""))
    good = np.r_[0:20, 23:40]
    assert np.array_equal(bridge[good], broken[good])
    steps = clips.angles(bridge[19:23], bridge[20:24])
    assert steps == pytest.approx(np.broadcast_to(clips.angles(truth[19], truth[23]) / 4, (4, 2)), abs=1e-9)


@pytest.mark.parametrize(("first", "last", "held"), [(0, 3, 4), (36, 39, 35)])
def test_at_an_end_the_good_frame_is_held(first, last, held):
    q = clips.smooth(np.random.default_rng(0), 40, 2)
    bridge = bridged(q, Defect("", "", first, last, ""))
    assert np.array_equal(bridge[first : last + 1], np.repeat(q[held : held + 1], last - first + 1, axis=0))


def test_the_recordings_have_these_defects(data_dir):
    by_clip = {}
    for one in real_jitter.run(data_dir, rows=[NOISY, "Butterworth"]):
        by_clip.setdefault(one.clip, {})[one.row] = one
    assert list(by_clip) == [defect.clip for defect in DEFECTS]
    for clip, least in (("05_05", 110), ("05_06", 95), ("05_18", 65), ("09_10", 115), ("03_02", 3)):
        recorded, bridge, filtered = (by_clip[clip][row] for row in (NOISY, BRIDGE, "Butterworth"))
        assert recorded.off > least
        assert recorded.step > least
        assert recorded.around < 1e-12
        assert bridge.off < 1e-12
        assert bridge.step < recorded.step / 5
        assert filtered.step < recorded.step
        assert filtered.around > 0.1


def test_frozen_frames_repeat_the_one_before(data_dir):
    for defect in DEFECTS:
        if defect.joint is None or defect.first == 0:
            q = qf.read_motion(find(data_dir, defect.clip)).rotations
            for frame in range(max(defect.first, 1), defect.last + 1):
                assert np.array_equal(q[frame], q[frame - 1])
            assert not np.array_equal(q[defect.last + 1], q[defect.last])
