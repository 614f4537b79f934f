"""A database of built-in walks, and a walk that is not in it, with its control points."""

import functools

import numpy as np
import quatfilt as qf
from quatfilt.evaluation.synthetic import walk

JOINTS = ("LeftWrist", "RightWrist", "LeftAnkle", "RightAnkle")

FPS = 60.0


@functools.cache
def database(seeds=(1, 2, 3), seconds=3.0):
    """Return a database of some walks."""
    return walks(seeds, seconds)


def walks(seeds=(1, 2, 3), seconds=3.0):
    """Make a database of some walks."""
    return qf.MotionDatabase.from_motions(
        [walk(seconds=seconds, fps=FPS, seed=seed) for seed in seeds], fps=FPS
    )


def with_graph(degree):
    """Return the same database with neighbours of its poses."""
    database = walks()
    database.build_graph(degree=degree)
    return database


@functools.cache
def walker(frames=40, seed=9):
    """Return a walk that is not in the database."""
    return part(walk(seconds=2, fps=FPS, seed=seed), slice(30, 30 + frames))


def part(motion, which):
    """Return some frames of a motion."""
    return qf.Motion(
        motion.rotations[which], motion.translation[which], fps=motion.fps, skeleton=motion.skeleton
    )


def seen(motion, joints=JOINTS):
    """Return the trajectories of some joints."""
    return np.ascontiguousarray(motion.positions()[:, [motion.skeleton.index(name) for name in joints]])


def turned(x, angle, away):
    """Turn points about y, and move them."""
    q = np.array([np.cos(angle / 2), 0, np.sin(angle / 2), 0])
    return turn(q, x) + away


def turn(q, x):
    """Turn vectors by one quaternion."""
    w, v = q[0], q[1:]
    return x + 2 * w * np.cross(v, x) + 2 * np.cross(v, np.cross(v, x))
