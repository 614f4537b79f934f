"""The measures of compression: points beside bones, and the plain formats it is compared with."""

import clips
import numpy as np
import pytest
import quatfilt as qf
from quatfilt.evaluation import compression
from quatfilt.evaluation.clips import load

ARM = qf.Skeleton(
    ["shoulder", "elbow", "wrist"],
    [-1, 0, 1],
    [[0.0, 0, 0], [0, -30, 0], [0, -25, 0]],
    centimetres_per_unit=2.0,
)


def test_reach_is_the_longest_chain_below():
    np.testing.assert_allclose(compression.reach(ARM), [110, 50, 0])


@pytest.mark.parametrize("joint", [0, 1, 2])
def test_points_move_by_the_arc(joint):
    q = clips.smooth(np.random.default_rng(0), 20, 3)
    axis = np.zeros((3, 3))
    axis[joint] = [0.0, 0.0, 1e-4]
    turned = qf.multiply(q, qf.exp(np.broadcast_to(axis, (20, 3, 3))))
    errors = compression.vertex_errors(ARM, q, turned)
    assert errors.shape == (20, 3, 3)
    np.testing.assert_allclose(errors[:, joint], np.tile([6e-4, 6e-4, 0], (20, 1)), atol=1e-9)
    np.testing.assert_array_equal(errors[:, :joint], 0)
    if joint < 2:
        # A child's points move with the end of the bone too, by 2e-4 for each unit of it.
        bone = np.linalg.norm(ARM.offsets[joint + 1]) * 2
        assert (errors[:, joint + 1] <= 2e-4 * (bone + 3) + 1e-9).all()
        assert errors[:, joint + 1].max() > 1.5e-4 * bone


def test_the_plain_formats_are_as_exact_as_their_bits():
    q = clips.random_rotations(np.random.default_rng(1), 500, 4).astype(np.float32)
    for way, size, most in ((compression.SMALLEST, 6, 1.5e-4), (compression.FLOAT16, 8, 2e-3)):
        stored, back, _, _ = compression.WAYS[way](q)
        assert stored == size * 2000
        angles = qf.geodesic_distance(q.astype(np.float64), back.astype(np.float64))
        assert angles.max() <= most
        assert angles.max() > most / 20


def test_outcomes_of_the_built_in_walk():
    outcomes, as_acl, ratios = compression.run(load(None, longest=240))
    assert [one.way for one in outcomes] == list(compression.WAYS)
    ours = outcomes[0]
    assert ours.angle_max <= 0.1
    assert ours.ratio > 10 * outcomes[1].ratio
    assert as_acl[0].vertex_max <= compression.VERTEX_ERROR
    assert list(ratios.values()) == sorted(ratios.values())
