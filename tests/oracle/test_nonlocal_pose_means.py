import itertools

import clips
import nlpm
import numpy as np
import pytest
import tolerances
from oracle.direct_nonlocal_pose_means import direct_nonlocal_pose_means

OPTIONS = {
    "search_radius": [-1, 0, 2, 5],
    "patch_radius": [0, 2],
    "distance": ["mean", "sum"],
    "weights": ["pose", "joint"],
    "neighbors": [-1, 2],
    "chart": ["mean", "identity", "local"],
    "boundary": ["mirror", "linear", "nearest"],
    "lookahead": [-1, 0, 1, 3],
}

COMBINATIONS = [dict(zip(OPTIONS, values, strict=True)) for values in itertools.product(*OPTIONS.values())]
SHARE = 24
"""Each test takes every 24th of the shuffled combinations: 96 of them, in which every pair of values occurs."""

MOSTLY_CLEAR = 0.1
"""Share of samples whose candidates may tie, as they do beyond linear ends, and where few samples can be trusted."""

SHUFFLED = [COMBINATIONS[i] for i in np.random.default_rng(0).permutation(len(COMBINATIONS))]


def compare(backend, q, options, *, translation=None, confidence=None):
    arguments = nlpm.arguments(
        q, bandwidth=[0.3, 0.4], translation=translation, confidence=confidence, **options
    )
    rotations, positions = backend.nonlocal_pose_means(*arguments)
    expected, expected_positions, ambiguous = direct_nonlocal_pose_means(*arguments[:-2])
    error = (clips.rotation(rotations).inv() * expected).magnitude().reshape(ambiguous.shape)
    assert error[~ambiguous].max(initial=0) < tolerances.FLOAT64
    if translation is not None:
        clear = ~ambiguous[:, 0]
        np.testing.assert_allclose(
            positions[clear], expected_positions[clear], rtol=0, atol=tolerances.FLOAT64
        )
    return ambiguous.mean()


@pytest.mark.parametrize("frames", [2, 9])
def test_every_combination_of_options(backend, frames):
    ambiguous = []
    for seed, options in enumerate(SHUFFLED[::SHARE]):
        rng = np.random.default_rng(seed)
        q = clips.flipped(rng, clips.noisy(rng, clips.smooth(rng, frames, 2, swing=3), 0.1))
        ambiguous.append(compare(backend, q, options, translation=clips.path(rng, frames)))
    assert np.mean(ambiguous) < MOSTLY_CLEAR


def test_confidence_with_every_combination_of_options(backend):
    ambiguous = []
    for seed, options in enumerate(SHUFFLED[1::SHARE]):
        rng = np.random.default_rng(seed)
        q = clips.noisy(rng, clips.smooth(rng, 9, 2, swing=3), 0.1)
        confidence = clips.confidences(rng, 9, 2)
        ambiguous.append(compare(backend, q, options, translation=clips.path(rng, 9), confidence=confidence))
    assert np.mean(ambiguous) < MOSTLY_CLEAR


@pytest.mark.parametrize("chart", ["mean", "identity", "local"])
@pytest.mark.parametrize("turns", [0.4, 0.7, 0.8, 1.6])
def test_a_root_that_turns(backend, chart, turns):
    rng = np.random.default_rng(4)
    q = clips.noisy(rng, clips.turning(rng, 24, 2, turns=turns), 0.05)
    compare(backend, q, {"chart": chart}, translation=clips.path(rng, 24))
