"""How `denoise` is told what to run, and in which words it refuses."""

import inspect

import chains
import clips
import numpy as np
import pytest
import quatfilt as qf
from quatfilt.chain import OF_THE_CLIP
from quatfilt.methods import METHODS
from quatfilt.presets import PRESETS

FRAMES = 90


def clip(joints=3, frames=FRAMES, seed=0):
    """A noisy clip, continuous in sign."""
    rng = np.random.default_rng(seed)
    return qf.continuous(clips.noisy(rng, clips.smooth(rng, frames, joints), 0.03))


def with_gap(q, start=40, end=44, joint=1):
    other = q.copy()
    other[start:end, joint] = np.nan
    return other


def refused(kind, **options):
    """Return the message with which `denoise` refuses options."""
    with pytest.raises(kind) as caught:
        qf.denoise(clip(), **options)
    return str(caught.value)


def skeleton(joints=3):
    return qf.Skeleton([f"joint{i}" for i in range(joints)], range(-1, joints - 1), np.ones((joints, 3)))


def motion(q=None, path=None, fps=120.0):
    q = clip() if q is None else q
    path = clips.path(np.random.default_rng(2), len(q)) if path is None else path
    return qf.Motion(q, path, fps=fps, skeleton=skeleton(q.shape[1]))


# ---- which steps run


@pytest.mark.parametrize("method", ["gauss", "", None, 1, b"auto", {"auto"}])
def test_unknown_methods(method):
    assert (
        refused(ValueError, method=method)
        == f"method: expected one of {', '.join(map(repr, METHODS))}, got {method!r}"
    )


@pytest.mark.parametrize("name", ["gauss", None, ("bilateral", {"radius": 2})])
def test_unknown_methods_in_a_list(name):
    message = refused(ValueError, method=["bilateral", name])
    assert message == f"method[1]: expected one of {', '.join(map(repr, METHODS))}, got {name!r}"


@pytest.mark.parametrize("method", [[], ()])
def test_no_method(method):
    assert refused(ValueError, method=method) == "method: expected at least one filter, got an empty list"


@pytest.mark.parametrize("preset", ["film", "", 1, ["video"]])
def test_unknown_presets(preset):
    assert (
        refused(ValueError, preset=preset)
        == f"preset: expected one of {', '.join(map(repr, PRESETS))}, got {preset!r}"
    )


@pytest.mark.parametrize("value", [None, "no", 0])
def test_translation_is_a_switch(value):
    message = refused(TypeError, translation=value)
    assert message == f"translation: expected True or False, got {type(value).__name__}"


# ---- which step an option is for


def options(function, *, without=()):
    """The options of a filter as messages list them."""
    return ", ".join(name for name in list(inspect.signature(function).parameters)[1:] if name not in without)


def test_unknown_options():
    assert refused(TypeError, radius=3, method="nonlocal_pose_means") == (
        "radius: no filter of the chain has this option; "
        f"it has nonlocal_pose_means ({options(qf.nonlocal_pose_means)})"
    )
    assert refused(TypeError, sigma=3, method=["bilateral", "orientation_filter", "bilateral"]) == (
        f"sigma: no filter of the chain has this option; it has bilateral ({options(qf.bilateral)}); "
        "orientation_filter (mask, iterations, boundary, confidence, gaps, max_gap, fps, scalar_first)"
    )


def test_options_of_a_step_that_it_does_not_have():
    message = refused(TypeError, method="bilateral", bilateral={"sigma": 3})
    own = options(qf.bilateral, without=OF_THE_CLIP)
    assert message == f"bilateral has no option sigma; it has {own}"
    assert own.startswith("radius, sigma_time, sigma_angle, kernel, iterations, boundary")


@pytest.mark.parametrize("option", ["gaps", "max_gap", "fps", "confidence", "scalar_first"])
def test_options_of_the_clip_are_no_steps_own(option):
    message = refused(TypeError, method="nonlocal_pose_means", nonlocal_pose_means={option: 1})
    assert message.startswith(f"nonlocal_pose_means has no option {option}; it has ")


def test_options_of_a_step_that_does_not_run():
    message = refused(
        TypeError, method=["nonlocal_pose_means", "orientation_filter"], bilateral={"radius": 2}
    )
    assert message == (
        "bilateral: the chain has no such filter, only nonlocal_pose_means, orientation_filter; add it to method"
    )


def test_options_of_a_step_are_a_dict():
    message = refused(TypeError, method="bilateral", bilateral=3)
    assert message == "bilateral: expected a dict of options of the filter bilateral, got int"


def test_an_option_with_the_name_of_a_filter():
    message = refused(TypeError, method="kalman", smooth=False)
    assert (
        message
        == "smooth: this is the name of a filter; for the option of kalman pass kalman={'smooth': False}"
    )


def test_options_that_several_steps_have():
    message = refused(TypeError, method=["bilateral", "orientation_filter"], mask=[1, 1, 1], iterations=2)
    assert message == (
        "iterations: bilateral, orientation_filter have this option; name the filter, as in bilateral={'iterations': …}"
    )


def test_options_without_a_default():
    message = "orientation_filter needs a value of mask: pass mask=…"
    assert refused(TypeError, method="orientation_filter") == message
    assert refused(TypeError, method=["bilateral", "orientation_filter"], orientation_filter={}) == message


def test_options_reach_the_filter():
    q = clip()
    options = {"strength": 0.5, "joints": "apart"}
    expected = qf.smooth(qf.despike(q), **options)
    np.testing.assert_array_equal(qf.denoise(q, **options), expected)
    options = {"search_radius": 4, "patch_radius": 2, "bandwidth": 0.1, "chart": "local"}
    expected = qf.nonlocal_pose_means(q, **options)
    np.testing.assert_array_equal(qf.denoise(q, method="nonlocal_pose_means", **options), expected)
    options = {"radius": 2, "sigma_angle": 0.1, "kernel": "classic", "iterations": 3}
    expected = qf.bilateral(q, **options)
    np.testing.assert_array_equal(qf.denoise(q, method="bilateral", **options), expected)
    np.testing.assert_array_equal(qf.denoise(q, method="bilateral", bilateral=options), expected)
    expected = qf.orientation_filter(q, [1, 2, 1], boundary="linear")
    result = qf.denoise(q, method="orientation_filter", mask=[1, 2, 1], boundary="linear")
    np.testing.assert_array_equal(result, expected)


def test_options_find_their_step():
    q = clip()
    first = qf.bilateral(q, radius=2, iterations=3, boundary="linear")
    expected = qf.orientation_filter(first, [1, 2, 1], boundary="nearest")
    chain = ["bilateral", "orientation_filter"]
    for options in [
        {"bilateral": {"radius": 2, "iterations": 3}, "orientation_filter": {"boundary": "nearest"}},
        {"orientation_filter": {"boundary": "nearest"}, "bilateral": {"iterations": 3}, "radius": 2},
    ]:
        result = qf.denoise(q, method=chain, mask=[1, 2, 1], boundary="linear", **options)
        np.testing.assert_array_equal(result, expected)


def test_a_step_that_runs_twice_has_one_set_of_options():
    q = clip()
    once = qf.bilateral(q, radius=2)
    result = qf.denoise(q, method=("bilateral", "bilateral"), radius=2)
    np.testing.assert_array_equal(result, qf.bilateral(once, radius=2))


def test_dicts_are_not_written():
    options = {"radius": 2}
    qf.denoise(clip(), method="bilateral", bilateral=options, boundary="linear")
    assert options == {"radius": 2}


@pytest.mark.parametrize(
    ("options", "kind", "message"),
    [
        ({"patch_radius": -1}, ValueError, "patch_radius: expected an integer of at least 0"),
        ({"gaps": "drop"}, ValueError, "gaps: expected one of 'fill', 'keep', 'raise', got 'drop'"),
        ({"fps": 0}, ValueError, "fps: expected a number above 0, got 0"),
        ({"confidence": np.ones(7)}, ValueError, "confidence: expected shape (90,) or (90, 3), got (7,)"),
        ({"bandwidth": [0.1]}, ValueError, "bandwidth: expected a number or one per joint, shape (3,)"),
    ],
)
def test_later_steps_refuse_before_the_first_one_runs(options, kind, message, monkeypatch):
    computed = []
    monkeypatch.setattr("quatfilt._reference.bilateral", lambda *_: computed.append(1))
    with qf.use_backend("numpy"):
        said = refused(kind, method=["bilateral", "nonlocal_pose_means"], **options)
    assert said.startswith(message)
    assert not computed


@pytest.mark.parametrize("shape", [(), (0,), (5, 3), (4,), (2, 5, 3, 4)])
def test_chains_refuse_arrays_in_the_words_of_their_steps(shape):
    with pytest.raises(ValueError, match="rotations: ") as alone:
        qf.bilateral(np.ones(shape) / 2)
    with pytest.raises(ValueError, match="rotations: ") as chained:
        qf.denoise(np.ones(shape) / 2, method=["bilateral", "bilateral"])
    assert str(chained.value) == str(alone.value)


# ---- motions


@pytest.mark.parametrize("name", chains.SINGLE)
def test_every_method_filters_motions_and_their_translation(name):
    path = clips.path(np.random.default_rng(2), FRAMES)
    path[30] += 2
    noisy = motion(path=path)
    before = noisy.rotations.tobytes(), noisy.translation.tobytes()
    result = qf.denoise(noisy, method=name, **chains.SINGLE[name])
    expected = qf.denoise(noisy.rotations, method=name, fps=120, **chains.SINGLE[name])
    np.testing.assert_array_equal(result.rotations, expected)
    assert (result.fps, result.skeleton) == (120, noisy.skeleton)
    jerk = [np.abs(np.diff(x.translation, n=3, axis=0)).mean() for x in (noisy, result)]
    assert 0 < jerk[1] < jerk[0]
    still = qf.denoise(noisy, method=name, translation=False, **chains.SINGLE[name])
    np.testing.assert_array_equal(still.translation, noisy.translation)
    assert (noisy.rotations.tobytes(), noisy.translation.tobytes()) == before


@pytest.mark.parametrize("name", chains.SINGLE)
def test_every_method_takes_float32_and_fills_gaps(name):
    q = with_gap(clip()).astype(np.float32)
    path = clips.path(np.random.default_rng(2), FRAMES).astype(np.float32)
    path[50:53] = np.nan
    result = qf.denoise(motion(q, path), method=name, **chains.SINGLE[name])
    assert result.rotations.dtype == result.translation.dtype == np.float32
    assert np.isfinite(result.rotations).all()
    assert np.isfinite(result.translation).all()


def test_motions_are_scalar_first():
    with pytest.raises(TypeError) as caught:
        qf.denoise(motion(), scalar_first=False)
    assert str(caught.value) == "scalar_first applies to arrays only; a Motion has its own convention"


def test_a_motion_knows_its_frame_rate():
    noisy = motion(with_gap(clip()))
    for method in ("nonlocal_pose_means", ["bilateral", "nonlocal_pose_means"]):
        options = {"method": method}
        assert np.isfinite(qf.denoise(noisy, max_gap=4 / 120, **options).rotations).all()
        assert np.isnan(qf.denoise(noisy, max_gap=3 / 120, **options).rotations[40:44, 1]).all()
        assert np.isnan(qf.denoise(noisy, max_gap=4 / 120, fps=60, **options).rotations[40:44, 1]).all()


@pytest.mark.parametrize("method", ["nonlocal_pose_means", ["bilateral", "nonlocal_pose_means"]])
@pytest.mark.parametrize("gaps", ["fill", "keep"])
def test_gaps_in_the_translation(gaps, method):
    path = np.linspace([0.0, 0, 0], [9, 0, -9], FRAMES)
    path[50:53] = np.nan
    result = qf.denoise(motion(path=path, fps=1), gaps=gaps, method=method).translation
    np.testing.assert_array_equal(np.isnan(result).any(axis=1), np.isnan(path[:, 0]) & (gaps == "keep"))


def test_a_translation_that_is_missing_stays_so():
    path = np.full((FRAMES, 3), np.nan)
    result = qf.denoise(motion(path=path), method=["bilateral", "nonlocal_pose_means"])
    assert np.isnan(result.translation).all()
    assert np.isfinite(result.rotations).all()


def test_the_whole_clip_leaves_the_translation_alone():
    rng = np.random.default_rng(3)
    rotations = qf.exp(0.1 * rng.standard_normal((60, 2, 3)))
    noisy = motion(rotations, rng.standard_normal((60, 3)), fps=30)
    local = qf.denoise(noisy, bandwidth=1.0, method="nonlocal_pose_means")
    anywhere = qf.denoise(noisy, bandwidth=1.0, search_radius=None, method="nonlocal_pose_means")
    assert not np.allclose(local.translation, noisy.translation)
    np.testing.assert_array_equal(anywhere.translation, noisy.translation)
    assert not np.allclose(anywhere.rotations, noisy.rotations)
    chained = qf.denoise(
        noisy, method=["nonlocal_pose_means", "bilateral"], search_radius=None, bandwidth=1.0
    )
    expected = qf.denoise(anywhere, method="bilateral")
    np.testing.assert_array_equal(chained.translation, expected.translation)
