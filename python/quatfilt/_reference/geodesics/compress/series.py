"""Integers in time: every 32nd first, then always the one in the middle, predicted from those on both sides.

Numbers are in 1/64 of a step. What is coded is by how many whole steps a number differs from its prediction, so that what comes
back is at most half a step off, whatever the prediction was, and smooth motion between costs next to nothing.
"""

import numpy as np
from numpy.typing import NDArray

from quatfilt._reference.geodesics.compress.bits import Reader, Writer
from quatfilt._reference.geodesics.compress.numbers import Numbers

Integers = NDArray[np.int64]

STEP = 64
"""Parts of a step that predictions are computed in."""

LEVELS = 5
"""Most halvings: numbers 2⁵ frames apart hardly know of each other."""

KERNELS = (((1, 1), 1), ((-1, 9, 9, -1), 4), ((3, -25, 150, 150, -25, 3), 8))
"""Interpolation at the middle: linear, cubic, quintic; weights, and the power of 2 that they are divided by."""

REACH = 3
"""Neighbours on each side that the widest kernel looks at."""

FAR = 1 << 8
"""Stands for the neighbourhood of the first number, of which nothing is known."""


def differences(numbers: Integers) -> tuple[Integers, list[int], Integers]:
    """Predict `(n,)` numbers: differences in steps, the kernel of each level, coarse levels first, and the decoded values."""
    n, levels = len(numbers), halvings(len(numbers))
    back, steps, kernels = np.zeros(n, np.int64), np.zeros(n, np.int64), []
    before = 0
    for i in range(0, n, 1 << levels):
        steps[i] = (numbers[i] - before + STEP // 2) // STEP
        back[i] = before = before + steps[i] * STEP
    for level in range(levels - 1, -1, -1):
        middle = slice(1 << level, None, 2 << level)
        trials = [predictions(back, level, kernel) for kernel in range(len(KERNELS))]
        found = [(numbers[middle] - trial + STEP // 2) // STEP for trial in trials]
        kernel = int(np.argmin([np.abs(one).sum() for one in found]))
        kernels.append(kernel)
        steps[middle] = found[kernel]
        back[middle] = trials[kernel] + found[kernel] * STEP
    return steps, kernels, back


def restored(steps: Integers, kernels: list[int]) -> Integers:
    """Return the numbers that come back."""
    levels, back = len(kernels), np.zeros(len(steps), np.int64)
    back[:: 1 << levels] = np.cumsum(steps[:: 1 << levels]) * STEP
    for level, kernel in zip(range(levels - 1, -1, -1), kernels, strict=True):
        middle = slice(1 << level, None, 2 << level)
        back[middle] = predictions(back, level, kernel) + steps[middle] * STEP
    return back


def write(writer: Writer, steps: Integers, kernels: list[int], ahead: Numbers, between: Numbers) -> None:
    """Code a series; `ahead` holds the contexts of the numbers that come first, `between` those of the others."""
    sizes, top, usual = np.abs(steps).tolist(), 1 << len(kernels), Usual()
    for i in range(0, len(steps), top):
        ahead.write(writer, int(steps[i]), size_before(sizes, i, top))
    for level, kernel in zip(range(len(kernels) - 1, -1, -1), kernels, strict=True):
        writer.plain(kernel, 2)
        for i in range(1 << level, len(steps), 2 << level):
            between.write(writer, int(steps[i]), sizes_nearby(sizes, i, 1 << level) + usual.size())
            usual.learn(sizes[i])


def read(reader: Reader, n: int, ahead: Numbers, between: Numbers) -> tuple[Integers, list[int]]:
    """Decode a series of `n` numbers."""
    levels = halvings(n)
    steps, sizes, kernels, top, usual = [0] * n, [0] * n, [], 1 << levels, Usual()
    for i in range(0, n, top):
        steps[i] = ahead.read(reader, size_before(sizes, i, top))
        sizes[i] = abs(steps[i])
    for level in range(levels - 1, -1, -1):
        kernels.append(reader.plain(2) % len(KERNELS))
        for i in range(1 << level, n, 2 << level):
            steps[i] = between.read(reader, sizes_nearby(sizes, i, 1 << level) + usual.size())
            sizes[i] = abs(steps[i])
            usual.learn(sizes[i])
    return np.array(steps, np.int64), kernels


def halvings(n: int) -> int:
    """Return how often the distance of the numbers that come first is halved."""
    return min(max(n - 1, 0).bit_length() - 1, LEVELS) if n > 2 else 0


def predictions(back: Integers, level: int, kernel: int) -> Integers:
    """Interpolate at the middle of the numbers that are there, which lie `2 · 2^level` apart; straight on beyond the ends."""
    weights, shift = KERNELS[kernel]
    known = back[:: 2 << level]
    middles = len(range(1 << level, len(back), 2 << level))
    out = np.arange(1, REACH + 1)
    first, last = (known[0] - known[1], known[-1] - known[-2]) if len(known) > 1 else (0, 0)
    padded = np.concatenate([(known[0] + out * first)[::-1], known, known[-1] + out * last])
    half = len(weights) // 2
    start = REACH - half + 1
    total = sum(weight * padded[start + j : start + j + middles] for j, weight in enumerate(weights))
    return np.asarray((total + (1 << shift - 1)) >> shift)


class Usual:
    """Running mean of the magnitudes, over about the last 16 values."""

    def __init__(self) -> None:
        self.sum = 512  # as if all had been 2

    def learn(self, size: int) -> None:
        """Take in another magnitude."""
        self.sum += 16 * size - (self.sum >> 4)

    def size(self) -> int:
        """Return 16 times the mean."""
        return self.sum >> 4


def size_before(sizes: list[int], i: int, top: int) -> int:
    """Four times the magnitude before, among the numbers that come first."""
    return FAR if i < 2 * top else 4 * sizes[i - top]  # the first number is no difference


def sizes_nearby(sizes: list[int], i: int, apart: int) -> int:
    """Sum four magnitudes that both sides know: two of this level before, and those of coarser levels on both sides."""
    before = sizes[i - 2 * apart] if i >= 2 * apart else 0
    earlier = sizes[i - 4 * apart] if i >= 4 * apart else 0
    last = sizes[i - apart] if i > apart else 0
    after = sizes[i + apart] if i + apart < len(sizes) else 0
    return 2 * before + earlier + last + after
