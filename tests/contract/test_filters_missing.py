"""What filters make of missing samples: filled, kept or refused, and never spread."""

import clips
import numpy as np
import pytest
import quatfilt as qf
import tolerances
from contract.filters import FILTERS, FRAMES, clip, every_filter, refused

REACH = 15
"""Frames of the default window and patch together."""

MISSING = {
    "NaN": [np.nan] * 4,
    "zeros": [0.0] * 4,
    "one NaN": [0.5, 0.5, np.nan, 0.5],
    "infinite": [np.inf, 0, 0, 0],
}

exact_charts = pytest.mark.parametrize("chart", ["local", "identity"])
"""Charts that do not depend on the clip as a whole."""


def with_gap(q, kind, start=40, end=44, joint=1):
    other = q.copy()
    other[start:end, joint] = MISSING[kind]
    return other


@exact_charts
@pytest.mark.parametrize("kind", MISSING)
@pytest.mark.parametrize("max_gap", [None, 10.0])
def test_missing_samples_are_filled_and_do_not_spread(kind, max_gap, chart):
    q = clip()
    result = qf.nonlocal_pose_means(
        with_gap(q, kind), bandwidth=0.05, chart=chart, boundary="nearest", max_gap=max_gap
    )
    assert np.isfinite(result).all()
    whole = qf.nonlocal_pose_means(q, bandwidth=0.05, chart=chart, confidence=np.ones(FRAMES))
    for beyond in (slice(0, 40 - REACH), slice(44 + REACH, None)):
        np.testing.assert_array_equal(result[beyond], whole[beyond])
    assert clips.angles(result[40:44, 1], whole[40:44, 1]).max() < 0.2
    assert clips.angles(result, whole).max() > 0


@pytest.mark.parametrize("kind", MISSING)
@every_filter
def test_missing_samples_are_kept(name, kind):
    q = clip()
    filled = FILTERS[name](with_gap(q, kind))
    kept = FILTERS[name](with_gap(q, kind), gaps="keep")
    gone = np.zeros(q.shape[:2], bool)
    gone[40:44, 1] = True
    assert np.isnan(kept[gone]).all()
    np.testing.assert_array_equal(kept[~gone], filled[~gone])


@pytest.mark.parametrize("kind", MISSING)
@every_filter
def test_missing_samples_are_refused(name, kind):
    message = refused(ValueError, FILTERS[name], with_gap(clip(), kind), gaps="raise")
    assert message == "rotations: expected no missing samples with gaps='raise', got 4"


@every_filter
def test_nothing_is_refused_where_nothing_is_missing(name):
    q = clip()
    np.testing.assert_array_equal(FILTERS[name](q, gaps="raise"), FILTERS[name](q))


@exact_charts
@pytest.mark.parametrize(("max_gap", "fps"), [(3, 1), (0.02, 120)])
def test_sides_of_longer_gaps_are_filtered_apart(max_gap, fps, chart):
    q = clip()
    options = {"bandwidth": 0.05, "chart": chart}
    result = qf.nonlocal_pose_means(with_gap(q, "NaN"), max_gap=max_gap, fps=fps, **options)
    assert np.isnan(result[40:44, 1]).all()
    for side in (slice(0, 40), slice(44, None)):
        alone = qf.nonlocal_pose_means(q[side], confidence=np.ones(len(q[side])), **options)
        np.testing.assert_array_equal(result[side], alone)


NOT_FROM_THE_CLIP = {
    "denoise": {"bandwidth": 0.05, "chart": "local"},
    "kalman": {"process_noise": 0.01, "measurement_noise": 0.03},
    "nonlocal_pose_means": {"bandwidth": 0.05, "chart": "local"},
    "wavelet": {"threshold": 0.03},
}
"""Values for what is otherwise estimated from the whole clip."""


# The noise that `smooth` measures on the whole clip cannot be given: see its laws.
@pytest.mark.parametrize("name", sorted(FILTERS.keys() - {"smooth"}))
def test_sides_of_longer_gaps_do_not_know_each_other(name):
    q = clip()
    gap = q.copy()
    gap[40:44] = np.nan
    options = NOT_FROM_THE_CLIP.get(name, {})
    result = FILTERS[name](gap, max_gap=3, **options)
    assert np.isnan(result[40:44]).all()
    for side in (slice(0, 40), slice(44, None)):
        alone = FILTERS[name](q[side], **options)
        np.testing.assert_allclose(result[side], alone, rtol=0, atol=tolerances.ALGEBRA)


@pytest.mark.parametrize("kind", MISSING)
@every_filter
def test_missing_samples_are_hardly_noticed_far_away(name, kind):
    """Not at all where the filter's window ends; others forget them."""
    q = clip()
    options = NOT_FROM_THE_CLIP.get(name, {})
    result, whole = (FILTERS[name](x, **options) for x in (with_gap(q, kind, 70, 74), q))
    assert np.isfinite(result).all()
    recursive = name in ("butterworth", "kalman", "smooth", "wavelet")
    assert clips.angles(result[:40], whole[:40]).max() < (0.002 if recursive else tolerances.FLOAT64)


@pytest.mark.parametrize(("max_gap", "fps"), [(4, 1), (4 / 120, 120), (0.08, 50), (None, 60)])
@every_filter
def test_gaps_are_measured_in_seconds(name, max_gap, fps):
    """Four frames are filled, five are not."""
    q = with_gap(with_gap(clip(), "NaN", 20, 24, 0), "zeros", 50, 55, 2)
    options = {"cutoff": fps / 10} if name == "butterworth" else {}
    result = FILTERS[name](q, max_gap=max_gap, fps=fps, **options)
    missing = np.isnan(result).any(axis=-1)
    assert missing.sum() == (0 if max_gap is None else 5)
    assert missing[50:55, 2].all() == (max_gap is not None)


@every_filter
def test_a_joint_that_is_never_there(name):
    q = clip()
    q[:, 1] = np.nan
    result = FILTERS[name](q)
    assert np.isnan(result[:, 1]).all()
    assert np.isfinite(result[:, [0, 2]]).all()


@pytest.mark.parametrize("kind", ["NaN", "zeros"])
@every_filter
def test_a_clip_without_any_sample(name, kind):
    result = FILTERS[name](np.tile(MISSING[kind], (20, 2, 1)))
    assert np.isnan(result).all()


@pytest.mark.parametrize("end", ["start", "end"])
@every_filter
def test_a_gap_at_one_end_that_stays_does_not_spread(name, end):
    """All joints at once: what is left is one span, and not the whole clip."""
    q = clip()
    gap, rest = (slice(0, 20), slice(20, None)) if end == "start" else (slice(70, None), slice(0, 70))
    broken = q.copy()
    broken[gap] = np.nan
    result = FILTERS[name](broken, max_gap=5)
    assert np.isnan(result[gap]).all()
    assert clips.angles(result[rest], q[rest]).max() < 1


@pytest.mark.parametrize("name", sorted(FILTERS.keys() - {"denoise", "nonlocal_pose_means"}))
def test_long_gaps_of_a_joint_do_not_matter_to_others(name):
    """Of filters that look at one joint at a time."""
    q = clip()
    gaps = q.copy()
    gaps[np.arange(FRAMES) % 20 < 10, 1] = np.nan
    result, expected = FILTERS[name](gaps, max_gap=5), FILTERS[name](q)
    np.testing.assert_allclose(result[:, [0, 2]], expected[:, [0, 2]], rtol=0, atol=tolerances.FLOAT64)
