"""Clips drawn by Hypothesis: every length around the borders of kernels, signs, missing samples, both dtypes."""

import clips
import numpy as np
from hypothesis import strategies as st

dtypes = st.sampled_from([np.float32, np.float64])
lengths = st.one_of(st.integers(0, 5), st.integers(6, 40), st.sampled_from([63, 64, 65, 127, 128, 200, 1000]))
joints = st.sampled_from([1, 2, 3, 5, 17, 70])
missing = st.sampled_from([0.0, 0.02, 0.5, 0.97, 1.0])
"""Shares of missing samples."""
seeds = st.integers(0, 2**32 - 1)


def spoil(rng, q, share):
    """Make a share of the samples missing, in all the ways there are."""
    ways = np.array([[np.nan] * 4, [0.0] * 4, [0.0, np.nan, 0, 1], [np.inf, 0, 0, 0], [1, 0, 0, -np.inf]])
    hit = rng.random(q.shape[:-1]) < share
    q[hit] = ways[rng.integers(0, len(ways), hit.sum())]
    return q


@st.composite
def spoilt_clips(draw, lengths=lengths, joints=joints, missing=missing):
    """Smooth motion with some noise, random signs and missing samples, and lengths that differ from 1 by roundings."""
    rng = np.random.default_rng(draw(seeds))
    q = clips.noisy(rng, clips.smooth(rng, draw(lengths), draw(joints)), 0.01)
    q = clips.flipped(rng, q * rng.uniform(0.99, 1.01, (*q.shape[:-1], 1)))
    return spoil(rng, q, draw(missing)).astype(draw(dtypes))


def same_samples(result, expected, tolerance):
    """Ask for the same missing samples, and for equal quaternions, signs included, elsewhere."""
    assert result.dtype == expected.dtype
    assert result.shape == expected.shape
    usable = np.isfinite(expected).all(axis=-1)
    np.testing.assert_array_equal(np.isfinite(result).all(axis=-1), usable)
    # The angle of a rotation is twice that of its quaternion.
    np.testing.assert_allclose(result[usable], expected[usable], rtol=0, atol=tolerance / 2)
