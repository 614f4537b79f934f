"""The reconstruction tables: who is in a database, what is measured, and what the page says of it."""

import json

import numpy as np
import pytest
import quatfilt as qf
from quatfilt.evaluation import reconstruction_tables as tables
from quatfilt.evaluation import reconstruction_tables_databases as databases
from quatfilt.evaluation import reconstruction_tables_page as page
from quatfilt.evaluation import reconstruction_tables_picture as picture
from quatfilt.evaluation._written import write
from quatfilt.evaluation.reconstruction_tables_conditions import CONTROL_POINTS, TESTS, TWICE, HeldOut

CLIPS = {"07": ("07_01", "07_02"), "08": ("08_01", "08_02"), "63or64_golf": ("golf_01",)}

FEW = (HeldOut("08_01", "walk"), HeldOut("golf_01", "golf", inside=True))

MODELS = ("mean_pose", "local_pcr", "local_regression")


@pytest.fixture(scope="module", name="folder")
def some_recordings(data_dir, tmp_path_factory):
    folder = tmp_path_factory.mktemp("recordings")
    for person, clips in CLIPS.items():
        (folder / person).mkdir()
        skeleton = next((data_dir / "cmu" / person).glob("*.asf"))
        for file in (skeleton, *(data_dir / "cmu" / person / f"{clip}.amc" for clip in clips)):
            (folder / person / file.name).symlink_to(file.resolve())
    (folder / "index.csv").write_text("path,action,description\ncmu/08/08_01.amc,walk,Walk\n", "utf-8")
    return folder


@pytest.fixture(scope="module", name="found")
def what_comes_out(folder):
    return tables.run(folder, tests=FEW, models=MODELS)


def test_nobody_is_tested_whom_the_defaults_were_chosen_on():
    assert {test.person for test in TESTS}.isdisjoint({"02", "07", "08"})
    assert {test.name for test in TESTS}.isdisjoint(TWICE)


def test_a_person_is_never_in_the_database_of_a_test(folder):
    made = databases.Databases(databases.Recordings(folder))
    assert set(made.without(FEW[0]).clip_names) == {"07_01", "07_02", "golf_01"}
    assert set(made.without(FEW[0], known=True).clip_names) == {"07_01", "07_02", "08_02", "golf_01"}
    assert set(made.without(FEW[1]).clip_names) == {"07_01", "07_02", "08_01", "08_02", "golf_01"}


def test_frames_between_are_other_frames(folder):
    recordings = databases.Recordings(folder)
    even, odd = recordings["golf_01"], recordings.between("golf_01")
    whole = qf.read_motion(recordings.paths["golf_01"])
    np.testing.assert_array_equal(even.rotations, whole.rotations[::2])
    np.testing.assert_array_equal(odd.rotations, whole.rotations[1::2])
    assert even.fps == odd.fps == 60


def test_errors_are_those_of_the_metrics(folder):
    truth = tables.cut(databases.Recordings(folder)["08_01"])
    assert tables.errors(truth, truth) == (0, 0)
    lifted = truth.replace(translation=truth.translation + np.array([0.0, 1.0, 0.0]))
    angle, position = tables.errors(truth, lifted)
    assert angle == 0
    assert position == pytest.approx(truth.skeleton.centimetres_per_unit)


def test_each_model_and_number_of_points_is_measured_once(found):
    walk = [one for one in found.results if one.clip == "08_01" and not one.known and one.share == 1]
    assert sorted((one.model, one.points) for one in walk) == sorted(
        (model, points) for model in MODELS for points in CONTROL_POINTS
    )
    assert all(one.known for one in found.of(clip="golf_01"))
    assert found.mean("angle", points=4, share=1, known=False) > 0


def test_page_numbers_and_picture(found, tmp_path):
    run = page.Run("1.2.3", "a command")
    numbers = tables.as_dict(found, vars(run))
    written, trouble = write(
        tmp_path,
        page.STEM,
        page=page.markdown(found, run),
        numbers=numbers,
        draw=lambda path: picture.draw(found, path),
    )
    assert trouble == ""
    text = written[0].read_text(encoding="utf-8")
    assert "Written by `a command`, version 1.2.3." in text
    own = found.mean("angle", model="local_regression", points=4, share=1, known=False)
    other = found.mean("angle", model="local_pcr", points=4, share=1, known=False)
    assert f"of the proposed model is {own / other:.2f} of that of local PCR" in text
    kept = json.loads(written[1].read_text(encoding="utf-8"))
    assert len(kept["results"]) == len(found.results)
    assert written[2].read_bytes().startswith(b"\x89PNG")


def test_a_folder_without_the_clips_is_refused(folder):
    with pytest.raises(qf.QuatfiltError, match=r"expected 16_15\.amc in this folder or below it"):
        tables.run(folder)
