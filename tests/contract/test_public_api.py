"""The public face: names, signatures and documentation."""

import ast
import inspect
import types

import pytest
import quatfilt as qf

FIXED = """
log(q)
exp(v)
multiply(a, b)
conjugate(q)
normalize(q)
geodesic_distance(a, b)
continuous(q)
mean(q, *, axis=0, weights=None)
slerp(q, times, new_times)
resample(q, *, fps, new_fps)
nonlocal_pose_means(q, *, search_radius=10, patch_radius=5, bandwidth="auto", distance="mean", weights="pose", neighbors=None, library=None, chart="mean", boundary="nearest", lookahead=None)
bilateral(q, *, radius=4, sigma_time=1.0, sigma_angle=0.2, kernel="gaussian", iterations=1, boundary="mirror")
orientation_filter(q, mask, *, iterations=1, boundary="mirror")
gaussian(q, *, sigma, fps=1.0, boundary="mirror")
butterworth(q, *, cutoff, fps=1.0, order=4)
savgol(q, *, window_length, polyorder=3, deriv=0, fps=1.0)
weighted_moving_mean(q, *, iterations=1)
wavelet(q, *, wavelet="sym8", threshold="auto")
kalman(q, *, fps=1.0, process_noise="auto", measurement_noise="auto", smooth=True)
despike(q, *, radius=3, threshold=4.0)
one_euro(q, *, fps=1.0, min_cutoff=1.0, beta=0.0)
smooth(q, *, strength=1.0)
denoise(motion_or_rotations, *, method="auto")
fill_gaps(q, *, max_gap=None, fps=1.0)
noise_level(q)
add_gaussian_noise(q, *, sigma, rng)
add_impulse_noise(q, *, probability, magnitude=(0.17453292519943295, 1.0471975511965976), rng)
compress(q, *, tolerance)
segment(q, *, n_components=1, threshold="auto", fps=1.0)
read_motion(path)
write_motion(path, motion)
patch_neighbors(q, *, patch_radius=5, k=16, exclusion=None, library=None)
set_num_threads(n)
get_num_threads()
simd_level()
"""
"""Signatures that people's scripts call. Options may be added to them, and names to the module; nothing goes away.

Where a script would pass rotations by position, `q` stands for `q` or `rotations`.
"""

SIGNATURES = {text.partition("(")[0]: text for text in FIXED.split("\n") if text}


def test_all_is_sorted_and_complete():
    assert qf.__all__ == sorted(qf.__all__)
    public = {
        name
        for name, value in vars(qf).items()
        if not name.startswith("_") and not isinstance(value, types.ModuleType) and value is not qf.warnings
    }
    modules = {name for name in qf.__all__ if isinstance(getattr(qf, name), types.ModuleType)}
    assert public == set(qf.__all__) - modules


@pytest.mark.parametrize("name", [name for name in qf.__all__ if name in SIGNATURES])
def test_fixed_signatures(name):
    fixed = ast.parse(f"def {SIGNATURES[name]}: ...").body[0].args
    parameters = inspect.signature(getattr(qf, name)).parameters
    positional = [p.name for p in parameters.values() if p.kind == p.POSITIONAL_OR_KEYWORD]
    expected = [arg.arg for arg in fixed.args]
    if positional[:1] == ["rotations"] and expected[:1] == ["q"]:
        expected[0] = "rotations"
    assert positional == expected
    for option, default in zip(fixed.kwonlyargs, fixed.kw_defaults, strict=True):
        parameter = parameters[option.arg]
        assert parameter.kind == parameter.KEYWORD_ONLY
        value = inspect.Parameter.empty if default is None else ast.literal_eval(default)
        assert parameter.default == value, option.arg
    for parameter in parameters.values():
        added = parameter.name not in expected + [option.arg for option in fixed.kwonlyargs]
        if added and parameter.kind == parameter.KEYWORD_ONLY:
            assert parameter.default is not parameter.empty, f"{parameter.name}: fixed calls would lack it"


def is_documented(value):
    return callable(value) and not isinstance(value, types.ModuleType)


@pytest.mark.parametrize("name", [name for name in qf.__all__ if is_documented(getattr(qf, name))])
def test_every_name_is_documented_with_an_example(name):
    value = getattr(qf, name)
    text = inspect.getdoc(value)
    summary = text.split("\n")[0]
    assert summary.endswith(".")
    assert "\nExamples\n--------\n" in text
    assert f"{name}" in text.partition("\nExamples\n--------\n")[2]
    if isinstance(value, type) and issubclass(value, Exception):
        return
    documented = text.partition("\nParameters\n----------\n")[2]
    for parameter in inspect.signature(value).parameters.values():
        if parameter.kind not in (parameter.VAR_KEYWORD, parameter.VAR_POSITIONAL):
            assert any(
                parameter.name in line.partition(" : ")[0].split(", ")
                for line in documented.split("\n")
                if " : " in line
            ), f"{parameter.name} is not documented"
    if not isinstance(value, type) and inspect.signature(value).return_annotation is not None:
        assert "\nReturns\n-------\n" in text or summary.startswith("Return ")
