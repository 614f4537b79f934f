"""Databases of many poses: clips at several speeds, and their mirror images."""

import numpy as np
import quatfilt as qf
from quatfilt.evaluation.many_poses import many_poses
from quatfilt.evaluation.synthetic import walk


def test_clips_are_played_faster_and_slower(tmp_path):
    folder = tmp_path / "walks"
    folder.mkdir()
    for seed, name in enumerate("ab"):
        qf.write_motion(folder / f"{name}.npz", walk(seconds=2, seed=seed))
    done = []
    db = many_poses([folder], tmp_path / "db", times=3, progress=lambda *numbers: done.append(numbers))
    assert done == [(number, 6) for number in range(1, 7)]
    assert db.clip_names[::2] == ("a at 1", "b at 1", "a at 0.9", "b at 0.9", "a at 1.1", "b at 1.1")
    assert db.clip_names[1] == "a at 1 mirrored"
    lengths = np.diff(db.starts)[::4]
    np.testing.assert_allclose(lengths, [120, 120 / 0.9, 120 / 1.1], atol=1)
