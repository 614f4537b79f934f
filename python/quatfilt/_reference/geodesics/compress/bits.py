"""Bits in and out: an adaptive binary range coder (Martin 1979; the carries as in LZMA).

Each bit is coded under a *context*, which learns how often it was 0: quickly at first, over the last 64 bits in the end. A bit
costs `−log₂` of the probability that its context gave it.
"""

from dataclasses import dataclass, field

TOP = 1 << 24
"""The range is widened by a byte as soon as it is below."""

CERTAIN = 1 << 16
"""The unit of probabilities."""

SLOWEST = 6
"""A context moves by at least this power of 1/2 of the distance."""

LEARNT = 62
"""Bits after which a context has slowed down."""


class Context:
    """How often a bit was 0, in 1/65536, and how many bits taught it."""

    def __init__(self) -> None:
        self.zero = CERTAIN // 2
        self.seen = 0

    def learn(self, bit: int) -> None:
        """Move towards the bit."""
        pace = min((self.seen + 2).bit_length(), SLOWEST)
        self.seen = min(self.seen + 1, LEARNT)
        self.zero += -(self.zero >> pace) if bit else (CERTAIN - self.zero) >> pace

    def share(self, span: int) -> int:
        """Return the part of a range that represents 0."""
        return (span >> 12) * (self.zero >> 4)


@dataclass
class Writer:
    """Codes bits."""

    out: bytearray = field(default_factory=bytearray)
    low: int = 0
    span: int = 0xFFFF_FFFF
    held: int = 0
    waiting: int = 0
    started: bool = False

    def bit(self, bit: int, context: Context) -> None:
        """Code a bit under a context."""
        share = context.share(self.span)
        if bit:
            self.low += share
            self.span -= share
        else:
            self.span = share
        context.learn(bit)
        while self.span < TOP:
            self.span <<= 8
            self._shift()

    def plain(self, value: int, width: int) -> None:
        """Code an unsigned number of `width` bits, all equally likely."""
        for place in range(width - 1, -1, -1):
            self.span >>= 1
            self.low += self.span * (value >> place & 1)
            while self.span < TOP:
                self.span <<= 8
                self._shift()

    def finish(self) -> bytes:
        """Return all bytes. Of the numbers in the range, the one with most zeros at its end is taken, and they are left out."""
        self.low = (self.low + TOP - 1) // TOP * TOP
        for _ in range(5):
            self._shift()
        return bytes(self.out).rstrip(b"\0")

    def _shift(self) -> None:
        """Let the highest byte go, unless it is 0xFF: a carry may still run through it."""
        carry, rest = self.low >> 32, self.low & 0xFFFF_FFFF
        if carry or rest < 0xFF00_0000:
            if self.started:
                self.out.append(self.held + carry & 0xFF)
            self.out.extend([0xFF + carry & 0xFF] * self.waiting)
            self.held, self.waiting, self.started = rest >> 24, 0, True
        else:
            self.waiting += 1
        self.low = rest << 8 & 0xFFFF_FFFF


@dataclass
class Reader:
    """Decoder of a `Writer`'s bytes. Past the end it reads zeros."""

    data: bytes
    at: int = 0
    code: int = 0
    span: int = 0xFFFF_FFFF

    def __post_init__(self) -> None:
        """Take the first four bytes."""
        for _ in range(4):
            self._shift()

    def bit(self, context: Context) -> int:
        """Decode a bit under a context."""
        share = context.share(self.span)
        bit = int(self.code >= share)
        if bit:
            self.code -= share
            self.span -= share
        else:
            self.span = share
        context.learn(bit)
        while self.span < TOP:
            self.span <<= 8
            self._shift()
        return bit

    def plain(self, width: int) -> int:
        """Decode an unsigned number of `width` bits."""
        value = 0
        for _ in range(width):
            self.span >>= 1
            bit = int(self.code >= self.span)
            self.code -= self.span * bit
            value = value << 1 | bit
            while self.span < TOP:
                self.span <<= 8
                self._shift()
        return value

    def _shift(self) -> None:
        byte = self.data[self.at] if self.at < len(self.data) else 0
        self.at += 1
        self.code = (self.code << 8 | byte) & 0xFFFF_FFFF
