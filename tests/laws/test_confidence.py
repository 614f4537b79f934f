"""What must hold where samples give way as far as they are not trusted."""

import clips
import numpy as np
import pytest
import quatfilt as qf
import tolerances
from drawn import dtypes, seeds
from hypothesis import given
from hypothesis import strategies as st

FRAMES = 40

FILTERS = {
    "bilateral": qf.bilateral,
    "orientation_filter": lambda q, **options: qf.orientation_filter(q, [1, 4, 6, 4, 1], **options),
}
"""Filters that have no weights of their own."""

every_filter = pytest.mark.parametrize("name", FILTERS)


def sample(seed, joints=3):
    """Return a clip and confidences: some of them 0, some 1."""
    rng = np.random.default_rng(seed)
    q = clips.noisy(rng, clips.smooth(rng, FRAMES, joints, swing=2), 0.05)
    trust = np.where(rng.random((FRAMES, joints)) < 0.3, 1.0, clips.confidences(rng, FRAMES, joints))
    return q, trust, rng


def mean_of(q, trust, frame):
    """Weighted mean of the samples of one joint around a frame, with mirrored ends."""
    around = np.arange(frame - 8, frame + 9)
    source = np.abs(around)
    source = np.where(source < len(q), source, 2 * (len(q) - 1) - source)
    weights = np.exp(-((around - frame) ** 2) / 8) * trust[source]
    path = q[source] * np.where(q[source] @ q[frame] < 0, -1, 1)[:, None]
    total = weights @ path
    return total / np.linalg.norm(total)


@given(seed=seeds, dtype=dtypes)
def test_trusted_samples_stay(backend, seed, dtype):
    q, trust, rng = sample(seed)
    q = clips.flipped(rng, q).astype(dtype)
    result = backend.pulled_by_confidence(q, trust.astype(dtype))
    assert result.dtype == dtype
    np.testing.assert_array_equal(np.abs(result[trust == 1]), np.abs(q[trust == 1]))
    np.testing.assert_allclose(np.linalg.norm(result, axis=-1), 1, atol=tolerances.algebra(dtype))
    assert (np.sum(result[1:] * result[:-1], axis=-1) >= 0).all()
    np.testing.assert_array_equal(
        backend.pulled_by_confidence(q, np.ones_like(trust, dtype)), qf.continuous(q)
    )


@given(seed=seeds)
def test_what_is_not_trusted_does_not_matter(backend, seed):
    q, trust, rng = sample(seed)
    wild = np.where(trust[..., None] == 0, clips.random_rotations(rng, *trust.shape), q)
    first, second = (backend.pulled_by_confidence(np.ascontiguousarray(x), trust) for x in (q, wild))
    usable = (trust > 0).any(axis=0)
    np.testing.assert_array_equal(first[:, usable], second[:, usable])


@given(seed=seeds)
def test_samples_without_confidence_are_filled_in(backend, seed):
    q, trust, _ = sample(seed)
    trust = np.where(trust == 0, 0.0, 1.0)
    gaps = np.where(trust[..., None] == 0, np.nan, q)
    np.testing.assert_array_equal(
        backend.pulled_by_confidence(q, trust), backend.fill_gaps(gaps, -1, "slerp")[0]
    )


@pytest.mark.parametrize("frame", [0, 3, 20, FRAMES - 1])
@pytest.mark.parametrize("part", [0.1, 0.5, 0.9])
def test_doubtful_samples_go_that_part_of_the_way(backend, frame, part):
    q, _, rng = sample(1, joints=1)
    q = qf.continuous(clips.smooth(rng, FRAMES, 1))
    q[frame] = clips.product(q[frame], clips.from_vectors(np.array([0.8, -0.3, 0])))
    trust = np.ones((FRAMES, 1))
    trust[frame] = part
    result = backend.pulled_by_confidence(q, trust)
    mean = mean_of(q[:, 0], trust[:, 0], frame)
    whole = clips.angles(q[frame], mean[None])[0]
    assert clips.angles(result[frame], mean[None])[0] == pytest.approx(part * whole, abs=tolerances.FLOAT64)
    assert clips.angles(result[frame], q[frame])[0] == pytest.approx(
        (1 - part) * whole, abs=tolerances.FLOAT64
    )
    np.testing.assert_array_equal(np.delete(result, frame, axis=0), np.delete(q, frame, axis=0))


@given(seed=seeds)
def test_constant_rotations_on_either_side_and_signs_do_not_matter(backend, seed):
    q, trust, rng = sample(seed)
    a, b = clips.random_rotations(rng, 2)
    moved = clips.flipped(rng, clips.product(a, clips.product(q, b)))
    expected = clips.product(a, clips.product(backend.pulled_by_confidence(q, trust), b))
    assert clips.angles(backend.pulled_by_confidence(moved, trust), expected).max() < tolerances.FLOAT64


@given(seed=seeds)
def test_time_may_run_backwards(backend, seed):
    q, trust, _ = sample(seed)
    result = backend.pulled_by_confidence(q, trust)
    backwards = backend.pulled_by_confidence(np.ascontiguousarray(q[::-1]), np.ascontiguousarray(trust[::-1]))
    assert clips.angles(result, backwards[::-1]).max() < tolerances.FLOAT64


@given(trust=st.sampled_from([0.0, 0.01, 0.5, 1.0]))
def test_constant_clips_and_steady_turns_stay(backend, trust):
    still = np.repeat(clips.random_rotations(np.random.default_rng(2), 1, 2), FRAMES, axis=0)
    result = backend.pulled_by_confidence(still, np.full((FRAMES, 2), trust))
    assert clips.angles(result, still).max() < tolerances.ALGEBRA
    steady = clips.from_vectors(0.1 * np.arange(FRAMES)[:, None, None] * np.array([0.6, 0, 0.8]))
    inside = slice(8, -8)
    result = backend.pulled_by_confidence(steady, np.full((FRAMES, 1), trust))
    assert clips.angles(result[inside], steady[inside]).max() < tolerances.FLOAT64


# ---- in filters


@every_filter
@pytest.mark.usefixtures("backend")
@given(seed=seeds, dtype=dtypes)
def test_full_confidence_changes_nothing(name, seed, dtype):
    q, _, rng = sample(seed)
    q = clips.flipped(rng, q).astype(dtype)
    expected = FILTERS[name](q)
    for trust in (np.ones(FRAMES), np.ones((FRAMES, 3))):
        np.testing.assert_array_equal(FILTERS[name](q, confidence=trust), expected)


@every_filter
@pytest.mark.usefixtures("backend")
@given(seed=seeds, kind=st.sampled_from(["rotated", "missing"]))
def test_wild_samples_without_confidence_do_not_matter(name, seed, kind):
    q, trust, rng = sample(seed)
    trust[5, :] = 1
    wild = q.copy()
    wild[trust == 0] = clips.random_rotations(rng, (trust == 0).sum()) if kind == "rotated" else np.nan
    first, second = (FILTERS[name](x, confidence=trust) for x in (q, wild))
    # The first sample chooses the hemisphere of the result, whatever its confidence.
    first, second = (x * np.sign(x[:1, :, :1]) for x in (first, second))
    np.testing.assert_array_equal(first, second)


@every_filter
@pytest.mark.usefixtures("backend")
def test_doubt_takes_a_spike_away(name):
    clean = qf.continuous(clips.smooth(np.random.default_rng(3), FRAMES, 1, swing=0.2))
    q = clean.copy()
    q[20] = clips.product(q[20], clips.from_vectors(np.array([1.0, 0, 0])))
    trust = np.ones(FRAMES)
    errors = []
    for doubt in (0.0, 0.5, 0.9, 1.0):
        trust[20] = 1 - doubt
        errors.append(clips.angles(FILTERS[name](q, confidence=trust), clean).max())
    assert errors == sorted(errors, reverse=True)
    assert errors[-1] < 0.1 * errors[0]


@every_filter
@pytest.mark.usefixtures("backend")
def test_confidence_beside_gaps(name):
    q, _, _ = sample(4)
    q[10:14, 1] = np.nan
    q[14, 1] = clips.random_rotations(np.random.default_rng(5), 1)[0]
    trust = np.ones((FRAMES, 3))
    trust[14, 1] = 0
    other = q.copy()
    other[14, 1] = np.nan
    result = FILTERS[name](q, confidence=trust)
    np.testing.assert_array_equal(result, FILTERS[name](other, confidence=np.ones(FRAMES)))
    kept = FILTERS[name](q, confidence=trust, gaps="keep")
    assert np.isnan(kept).any(axis=-1).sum() == 4
    apart = FILTERS[name](q, confidence=trust, max_gap=2)
    assert np.isnan(apart[10:14, 1]).all()
    assert np.isfinite(apart[14:]).all()
