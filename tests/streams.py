"""Streams fed with clips, and what a clip looks like to them."""

import numpy as np


def run(stream, q, confidence=None):
    """Push a clip pose by pose and return all that comes out; each pose comes `latency` frames later."""
    poses = []
    for frame, pose in enumerate(q):
        came = stream.push(pose) if confidence is None else stream.push(pose, confidence[frame])
        assert (came is not None) == (frame >= stream.latency)
        if came is not None:
            assert came.shape == pose.shape
            assert came.dtype == q.dtype
            poses.append(came)
    rest = stream.flush()
    assert len(poses) + len(rest) == len(q)
    return np.array([*poses, *rest], q.dtype).reshape(q.shape)


def held(q):
    """Hold missing samples at the last one before them, or else at the first.

    Returns
    -------
    clip : array (frames, joints, 4)
        Identities where a joint is never there.
    there : array (frames, joints) of bool
        Which samples were there.
    since : array (frames, joints) of bool
        Where a sample was there, or one before it.
    """
    there = np.isfinite(q).all(axis=-1) & (q != 0).any(axis=-1)
    frame = np.where(there, np.arange(len(q))[:, None], -1)
    last = np.maximum.accumulate(frame, axis=0)
    source = np.where(last < 0, np.argmax(there, axis=0), last)
    clip = np.take_along_axis(q, source[..., None], axis=0)
    clip[:, ~there.any(axis=0)] = [1, 0, 0, 0]
    return clip, there, last >= 0
