"""Motion from trajectories: the core against the reference."""

import clips
import numpy as np
import pytest
import quatfilt as qf
import tolerances
import walkers


def both(
    positions,
    *,
    database=None,
    fps=walkers.FPS,
    initial=None,
    orientations=None,
    confidence=None,
    **options,
):
    database = walkers.database() if database is None else database
    options = {"control_points": walkers.JOINTS, "neighbors": 24, **options}
    results = []
    for backend in ("rust", "numpy"):
        with qf.use_backend(backend):
            reconstructor = qf.MotionReconstructor(database, **options)
            motion = reconstructor.reconstruct(
                positions, fps=fps, initial=initial, orientations=orientations, confidence=confidence
            )
            results.append((motion, reconstructor.energies_))
    (ours, energies), (theirs, expected) = results
    assert clips.angles(theirs.rotations, ours.rotations).max() <= tolerances.SOLUTION
    np.testing.assert_allclose(ours.translation, theirs.translation, rtol=0, atol=tolerances.TRACK)
    np.testing.assert_allclose(energies, expected, rtol=tolerances.TRACK, atol=tolerances.TRACK)
    return ours


@pytest.mark.parametrize("model", ["local_regression", "local_pca", "local_pcr", "nearest", "mean_pose"])
def test_models(model):
    both(walkers.seen(walkers.walker(12)), model=model)


@pytest.mark.parametrize("order", [1, 5])
@pytest.mark.parametrize("scale", [None, np.inf])
def test_orders_and_searches(order, scale):
    both(walkers.seen(walkers.walker(25)), order=order, control_scale=scale)


def test_missing_points_frames_and_a_new_start():
    positions = walkers.seen(walkers.walker(40)).copy()
    positions[3:6, 0] = np.nan
    positions[8:10] = np.nan
    positions[12:30] = np.nan
    both(positions, order=2)


def test_orientations_confidence_and_a_past():
    walk = walkers.walker(12)
    rng = np.random.default_rng(0)
    orientations = rng.normal(size=(12, 4, 4))
    orientations /= np.linalg.norm(orientations, axis=2, keepdims=True)
    orientations[:, 1] = np.nan
    confidence = rng.random((12, 4))
    confidence[:, 2] = 0
    both(
        walkers.seen(walk),
        orientations=orientations,
        confidence=confidence,
        orientation_noise=1.0,
        initial=walkers.part(walk, slice(0, 2)),
    )


def test_another_frame_rate():
    both(walkers.seen(walkers.walker(30))[::3], fps=20.0)


def test_more_neighbors_than_poses():
    both(walkers.seen(walkers.walker(3)), neighbors=1024)


@pytest.mark.parametrize("scale", [None, np.inf])
def test_along_a_graph(scale):
    # Few neighbours, so that it shows whether both look at the same candidates.
    positions = walkers.seen(walkers.walker(40)).copy()
    positions[15:32] = np.nan
    along = both(positions, database=walkers.with_graph(degree=2), neighbors=8, control_scale=scale)
    everywhere = qf.MotionReconstructor(
        walkers.database(), control_points=walkers.JOINTS, neighbors=8, control_scale=scale
    ).reconstruct(positions, fps=walkers.FPS)
    assert not np.array_equal(along.rotations, everywhere.rotations)


def test_along_a_graph_of_nobody():
    database = walkers.with_graph(degree=1)
    database.graph = np.full((len(database), 1), -1, np.int32)
    both(walkers.seen(walkers.walker(30)), database=database, neighbors=4)
