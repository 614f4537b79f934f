"""A chain of filters is its steps, one after the other."""

import itertools

import chains
import clips
import numpy as np
import pytest
import quatfilt as qf
from quatfilt.methods import FILTERS

every_pair = pytest.mark.parametrize("names", list(itertools.product(chains.SINGLE, repeat=2)), ids="-".join)


def sample(seed=0, frames=60):
    rng = np.random.default_rng(seed)
    q = qf.continuous(clips.noisy(rng, clips.smooth(rng, frames, 3), 0.05))
    skeleton = qf.Skeleton(["a", "b", "c"], [-1, 0, 1], np.ones((3, 3)))
    return qf.Motion(q, clips.path(rng, frames), fps=60, skeleton=skeleton)


def with_gaps(motion):
    """The same with short gaps, a long one, and some in the translation."""
    rotations, translation = motion.rotations.copy(), motion.translation.copy()
    rotations[5:8, 0] = np.nan
    rotations[20:40, 1] = 0
    rotations[-2:, 2] = np.nan
    translation[10:13] = np.nan
    return motion.replace(rotations=rotations, translation=translation)


def options(*names):
    return {name: value for one in names for name, value in chains.SINGLE[one].items()}


def same(result, expected):
    np.testing.assert_array_equal(result.rotations, expected.rotations)
    np.testing.assert_array_equal(result.translation, expected.translation)


@pytest.mark.parametrize("name", chains.SINGLE)
def test_one_step_is_the_filter(backend, name):
    del backend
    q = sample().rotations
    needed = chains.NEEDED.get(name, {})
    np.testing.assert_array_equal(
        qf.denoise(q, method=name, **options(name)), FILTERS[name].filter(q, **needed)
    )


@every_pair
def test_two_steps_without_gaps(backend, names):
    del backend
    first, second = names
    noisy = sample()
    between = qf.denoise(noisy, method=first, **options(first))
    expected = qf.denoise(between, method=second, **options(second))
    same(qf.denoise(noisy, method=list(names), **options(*names)), expected)


@every_pair
@pytest.mark.parametrize("gaps", ["fill", "keep"])
@pytest.mark.parametrize("max_gap", [None, 0.1])
def test_two_steps_with_gaps(names, gaps, max_gap):
    """Between the steps, missing samples are missing again."""
    first, second = names
    noisy = with_gaps(sample())
    between = qf.denoise(noisy, method=first, gaps="keep", max_gap=max_gap, **options(first))
    expected = qf.denoise(between, method=second, gaps=gaps, max_gap=max_gap, **options(second))
    same(qf.denoise(noisy, method=list(names), gaps=gaps, max_gap=max_gap, **options(*names)), expected)


@every_pair
def test_missing_samples_are_the_same_after_every_chain(names):
    noisy = with_gaps(sample())
    missing = ~np.isfinite(noisy.rotations).all(axis=-1) | (noisy.rotations == 0).all(axis=-1)
    kept = qf.denoise(noisy, method=list(names), gaps="keep", **options(*names))
    np.testing.assert_array_equal(np.isnan(kept.rotations).any(axis=-1), missing)
    filled = qf.denoise(noisy, method=list(names), **options(*names))
    np.testing.assert_array_equal(kept.rotations[~missing], filled.rotations[~missing])
    long = qf.denoise(noisy, method=list(names), max_gap=0.1, **options(*names))
    np.testing.assert_array_equal(np.isnan(long.rotations).any(axis=-1)[20:40, 1], np.ones(20, bool))
    assert np.isfinite(long.rotations[5:8, 0]).all()


def test_confidence_reaches_the_steps_that_know_it():
    noisy = sample()
    trust = clips.confidences(np.random.default_rng(1), 60, 3)
    chain = ["bilateral", "nonlocal_pose_means"]
    result = qf.denoise(noisy.rotations, method=chain, confidence=trust)
    expected = qf.nonlocal_pose_means(qf.bilateral(noisy.rotations, confidence=trust), confidence=trust)
    np.testing.assert_array_equal(result, expected)


def test_filled_samples_have_no_say_in_later_steps():
    """What stands in a gap does not matter: neither the NaN nor what the first step made of it."""
    q = sample().rotations
    gone = np.zeros((60, 3), bool)
    gone[20:26, 1] = True
    q[gone] = np.nan
    chain = ["bilateral", "nonlocal_pose_means"]
    result = qf.denoise(q, method=chain, bandwidth=0.1)
    filled, _ = qf.fill_gaps(qf.bilateral(q, gaps="keep"))
    expected = qf.nonlocal_pose_means(filled, bandwidth=0.1, confidence=np.where(gone, 0.0, 1.0))
    np.testing.assert_allclose(result, expected, rtol=0, atol=1e-12)
