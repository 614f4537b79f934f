"""Bodies, priors and targets drawn by chance, for reconstruction."""

import numpy as np
from quatfilt._reference.motion.skeleton import rotate
from quatfilt._reference.reconstruction.kinematics import ROOT, Base, Body
from quatfilt._reference.reconstruction.solver import Prior, Targets
from quatfilt._reference.rotations.quaternion import multiply


def quaternions(rng, *shape):
    """Draw rotations evenly."""
    q = rng.normal(size=(*shape, 4))
    return q / np.linalg.norm(q, axis=-1, keepdims=True)


def body(rng, joints, points, up=1):
    """Draw a tree, and control points on it."""
    parents = np.array([-1, *(int(rng.integers(0, joint)) for joint in range(1, joints))], np.int64)
    chosen = rng.choice(joints, points, replace=False).astype(np.int64)
    return Body(parents, rng.normal(size=(joints, 3)), chosen, up)


def base(rng, joints):
    """Draw an origin of coordinates."""
    return Base(quaternions(rng, joints), rng.normal(size=3), float(rng.uniform(-3, 3)))


def prior(rng, joints, axes=0, spread=0.3):
    """Draw what is expected."""
    n = 3 * joints + ROOT
    return Prior(
        spread * rng.normal(size=n),
        spread * rng.uniform(0.2, 1, n),
        spread * rng.normal(size=(n, axes)),
    )


def targets(rng, points, *, deviation=0.3, orientations=True):
    """Draw where control points are seen; some are not."""
    inf = np.full(points, np.inf)
    places = np.where(rng.random(points) < 0.8, deviation, np.inf)
    turns = np.where(rng.random(points) < 0.5, deviation, np.inf) if orientations else inf
    return Targets(rng.normal(size=(points, 3)), places, quaternions(rng, points), turns)


def arguments(body, base, prior, targets, start, most=30):
    """Return what `solve_pose` takes."""
    return (*body, *base, *prior, *targets, start, most)


def product(a, b):
    """Hamilton product of one quaternion with many."""
    return np.asarray(multiply(np.broadcast_to(a, b.shape).copy(), b))


def rotated(q, x):
    """Turn vectors by one quaternion."""
    return (
        np.asarray(rotate(np.broadcast_to(q, (*x.shape[:-1], 4)), x))
        if x.ndim > 1
        else rotate(q[None], x[None])[0]
    )
