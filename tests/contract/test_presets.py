"""Presets run, say why, and what is given goes before them."""

from pathlib import Path

import clips
import numpy as np
import pytest
import quatfilt as qf
from quatfilt.chain import OF_THE_CLIP
from quatfilt.methods import FILTERS
from quatfilt.presets import BEST, PRESETS

every_preset = pytest.mark.parametrize("name", PRESETS)

OTHERS = {
    "despike": {"radius": 2, "threshold": 0.5, "smallest": 0.0},
    "smooth": {"strength": 2.0},
}
"""Values that no preset has."""

PAGE = Path(__file__).parents[2] / "docs" / "denoise.md"


def motion(frames=120, fps=60.0):
    rng = np.random.default_rng(0)
    q = qf.continuous(clips.noisy(rng, clips.walk(rng, frames, 3), 0.03))
    skeleton = qf.Skeleton(["a", "b", "c"], [-1, 0, 1], np.ones((3, 3)))
    return qf.Motion(q, clips.path(rng, frames), fps=fps, skeleton=skeleton)


def values(preset):
    """Names of all that a preset sets, as in its reasons."""
    own = [f"{step}.{option}" for step, options in preset.steps.items() for option in options]
    return [*own, *preset.shared, "jitter"]


@every_preset
def test_every_value_has_an_option_and_a_reason(name):
    preset = PRESETS[name]
    for step, options in preset.steps.items():
        assert set(options) <= set(FILTERS[step].options) - set(OF_THE_CLIP)
    assert set(preset.shared) <= {"max_gap", "gaps", "boundary"}
    assert set(values(preset)) <= set(preset.reasons)
    assert set(preset.reasons) <= {*values(preset), *preset.steps}


@every_preset
def test_the_page_says_the_same(name):
    page = PAGE.read_text(encoding="utf-8")
    preset = PRESETS[name]
    steps = ", ".join(f"`{step}`" for step in preset.steps)
    assert f'| `"{name}"` | {preset.about} | {steps} |' in page
    rows = page.partition(f'\n| `"{name}"` | `')[2]
    rows = f"| `{rows}"
    for key, reason in preset.reasons.items():
        row = next(row for row in rows.split("\n") if f"| `{key}" in row)
        assert row.endswith(f"| {reason} |")
        step, _, option = key.rpartition(".")
        value = preset.steps[step][option] if step else {**preset.shared, "jitter": preset.jitter}.get(key)
        if isinstance(value, str):
            assert f'`{key} = "{value}"`' in row
        elif value is not None:
            assert f"`{key} = {value:.3g}`" in row


@every_preset
def test_presets_are_their_chains(name):
    """Of clips in which no jitter is found: two seconds are too short for that."""
    noisy, preset = motion(), PRESETS[name]
    result = qf.denoise(noisy, preset=name)
    chain = list(preset.steps)
    expected = qf.denoise(noisy, method=chain, **preset.steps, **preset.shared)
    np.testing.assert_array_equal(result.rotations, expected.rotations)
    np.testing.assert_array_equal(result.translation, expected.translation)
    again = qf.denoise(noisy, preset=name, method=chain)
    np.testing.assert_array_equal(again.rotations, expected.rotations)
    array = qf.denoise(noisy.rotations, preset=name, fps=60)
    np.testing.assert_array_equal(array, expected.rotations)


def test_auto_is_the_best_chain():
    noisy = motion()
    expected = qf.denoise(noisy, method=list(BEST.steps), **BEST.steps, **BEST.shared)
    np.testing.assert_array_equal(qf.denoise(noisy).rotations, expected.rotations)
    first = qf.denoise(noisy, method="bilateral")
    expected = qf.denoise(first, method=list(BEST.steps), **BEST.steps, **BEST.shared)
    chained = qf.denoise(noisy, method=["bilateral", "auto"])
    np.testing.assert_array_equal(chained.rotations, expected.rotations)


@every_preset
def test_what_is_given_goes_before_the_preset(name):
    noisy = motion()
    rotations = noisy.rotations.copy()
    rotations[30:60, 1] = np.nan
    gappy = noisy.replace(rotations=rotations)
    seconds = PRESETS[name].shared["max_gap"]
    left = np.isnan(qf.denoise(gappy, preset=name).rotations[30:60, 1]).all()
    assert left == (seconds < 0.5)
    assert np.isfinite(qf.denoise(gappy, preset=name, max_gap=0.5).rotations).all()
    assert np.isnan(qf.denoise(gappy, preset=name, max_gap=0.4).rotations[30:60, 1]).all()
    for step, options in PRESETS[name].steps.items():
        own = {step: OTHERS[step]}
        result = qf.denoise(noisy, preset=name, **own)
        assert not np.array_equal(result.rotations, qf.denoise(noisy, preset=name).rotations)
        assert options == PRESETS[name].steps[step], "the preset was written"


@every_preset
@pytest.mark.parametrize("fps", [24.0, 60.0, 120.0, 240.0])
def test_presets_take_noise_away_at_every_frame_rate(name, fps):
    rng = np.random.default_rng(1)
    seconds = np.arange(round(4 * fps))[:, None, None] / fps
    vectors = 0.5 * np.sin(2 * np.pi * np.array([0.7, 0.4, 0.9])[:, None] * seconds) * np.eye(3)
    truth = clips.from_vectors(vectors)
    noisy = clips.noisy(rng, truth, 0.03)
    result = qf.denoise(noisy, preset=name, fps=fps)
    assert clips.angles(truth, result).mean() < 0.75 * clips.angles(truth, noisy).mean()
