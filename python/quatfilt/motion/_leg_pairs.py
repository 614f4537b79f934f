"""Legs by topology: the pair of equal chains that leaves the body nearest to its root."""

import itertools
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

Joints: TypeAlias = tuple[int, int, int]
"""Hip, knee and ankle."""

_EQUAL = 0.04
"""Difference of the bones of a pair, at most, as a part of the limb."""

_SHORTEST_BONE = 0.1
"""Of the whole limb: a shorter bone is no thigh and no shank."""

_MOST_UNEQUAL = 2.0
"""Ratio of thigh and shank."""


def leg_pair(parents: NDArray[np.int64], offsets: NDArray[np.float64]) -> tuple[Joints, ...]:
    """Return hip, knee and ankle of the two legs, or nothing.

    Two children of a joint begin a pair of limbs if their chains have bones of the same lengths, among them two in sequence that are
    long and of similar length. Legs are the pair that forks nearest to the root; among pairs of the same depth the longest, unless another
    one is as long.
    """
    children: list[list[int]] = [[] for _ in parents]
    depth = np.zeros(len(parents), np.int64)
    for joint, parent in enumerate(parents):
        if parent >= 0:
            children[int(parent)].append(joint)
            depth[joint] = depth[parent] + 1
    bones = np.linalg.norm(offsets, axis=1)
    found: list[tuple[int, float, tuple[Joints, ...]]] = []
    for fork, below in enumerate(children):
        for one, other in itertools.combinations(below, 2):
            chains = [_chain(joint, children, bones) for joint in (one, other)]
            lengths = [bones[chain] for chain in chains]
            if len(chains[0]) != len(chains[1]) or not _equal(*lengths):
                continue
            limbs = [_limb(chain, bones) for chain in chains]
            if limbs[0] is not None and limbs[1] is not None:
                reach = float(lengths[0][1:].sum())
                found.append((int(depth[fork]), reach, (limbs[0], limbs[1])))
    if not found:
        return ()
    nearest = min(depth for depth, _, _ in found)
    rivals = sorted((pair for pair in found if pair[0] == nearest), key=lambda pair: -pair[1])
    if len(rivals) > 1 and rivals[1][1] > (1 - _EQUAL) * rivals[0][1]:
        return ()
    return rivals[0][2]


def _equal(one: NDArray[np.float64], other: NDArray[np.float64]) -> bool:
    return bool(np.abs(one - other).max() <= _EQUAL * max(one.sum(), other.sum()))


def _chain(joint: int, children: list[list[int]], bones: NDArray[np.float64]) -> list[int]:
    """Return the longest chain of joints from a joint down."""
    below = [_chain(child, children, bones) for child in children[joint]]
    return [joint, *max(below, key=lambda chain: bones[chain].sum(), default=[])]


def _limb(chain: list[int], bones: NDArray[np.float64]) -> Joints | None:
    """Return the first three joints of a chain with two long bones between them."""
    whole = float(bones[chain[1:]].sum())
    for hip, knee, ankle in zip(chain, chain[1:], chain[2:], strict=False):
        thigh, shank = float(bones[knee]), float(bones[ankle])
        alike = thigh <= _MOST_UNEQUAL * shank and shank <= _MOST_UNEQUAL * thigh
        if min(thigh, shank) > _SHORTEST_BONE * whole and alike:
            return hip, knee, ankle
    return None


__all__ = ["leg_pair"]
