"""Variable-length code for integers; the code length adapts to the values nearby."""

from quatfilt._reference.geodesics.compress.bits import Context, Reader, Writer

CLASSES = 24
"""Number of size classes of the neighbourhood."""

WIDEST = 48
"""Bits of the largest magnitude."""


class Numbers:
    """Contexts for integers: the length of the magnitude in bits, one by one; its second bit; the rest and the sign are plain.

    The contexts depend on the magnitudes nearby, since large numbers lie beside large ones.
    """

    def __init__(self) -> None:
        self.lengths = [[Context() for _ in range(WIDEST)] for _ in range(CLASSES)]
        self.seconds = [Context() for _ in range(WIDEST + 1)]

    def write(self, writer: Writer, value: int, nearby: int) -> None:
        """Code a number; `nearby` says how large others in its neighbourhood are, together."""
        size, lengths = abs(value), self.lengths[size_class(nearby)]
        length = size.bit_length()
        for i in range(length):
            writer.bit(1, lengths[i])
        if length < WIDEST:
            writer.bit(0, lengths[length])
        if length > 1:
            writer.bit(size >> length - 2 & 1, self.seconds[length])
        if length > 2:
            writer.plain(size & (1 << length - 2) - 1, length - 2)
        if length > 0:
            writer.plain(int(value < 0), 1)

    def read(self, reader: Reader, nearby: int) -> int:
        """Decode a number."""
        lengths, length = self.lengths[size_class(nearby)], 0
        while length < WIDEST and reader.bit(lengths[length]):
            length += 1
        if length == 0:
            return 0
        size = 1
        if length > 1:
            size = 2 | reader.bit(self.seconds[length])
        if length > 2:
            size = size << length - 2 | reader.plain(length - 2)
        return -size if reader.plain(1) else size


def size_class(size: int) -> int:
    """Return which of the classes a size belongs to: two for each power of 2."""
    if size < 2:
        return size
    length = size.bit_length()
    return min(2 * (length - 1) + (size >> length - 2 & 1), CLASSES - 1)
