"""Compressed rotations, in memory and in files."""

import struct
import zlib
from dataclasses import dataclass
from typing import Any, Self

import numpy as np

from quatfilt import _validation
from quatfilt._backend import ops
from quatfilt._typing import Array
from quatfilt.errors import FileFormatError
from quatfilt.formats._bytes import read_bytes, write_bytes
from quatfilt.formats.files import PathLike

_MAGIC = b"\x93QFPGA\r\n"
"""No text begins with it, and a transfer that changes the ends of lines spoils it."""

_VERSION = 1

_HEADER = struct.Struct("<8sBBBxIQdQ")
"""Magic, version, bytes of a number, whether there is no axis of joints, joints, frames, largest error, bytes of the stream."""

_CHECKSUM = struct.Struct("<I")

_MOST_SAMPLES = 1 << 36
"""A terabyte of rotations: whoever claims more is mistaken."""


@dataclass(frozen=True, repr=False)
class Compressed:
    """Rotations that `compress` made small, or `Compressed.load` read.

    Parameters
    ----------
    stream : bytes
        What a backend wrote.
    frames : int
        How many frames.
    joints : int
        How many joints; 1 where there was no axis of joints.
    single : bool
        Whether there is no axis of joints.
    dtype : dtype
        float32 or float64: what comes back.
    max_error : float, radians of rotation
        The largest angle between a sample and what comes back, as it was measured.

    Attributes
    ----------
    nbytes : int
        Bytes in all, which is what `save` writes.
    ratio : float
        How many times as large the rotations were.

    Examples
    --------
    >>> import numpy as np, quatfilt as qf
    >>> qf.compress(np.tile([1.0, 0.0, 0.0, 0.0], (1000, 2, 1)), tolerance=0.001)
    Compressed(1000 frames of 2 joints, float64, 44 bytes, ratio 1455)
    """

    stream: bytes
    frames: int
    joints: int
    single: bool
    dtype: np.dtype[Any]
    max_error: float

    @property
    def nbytes(self) -> int:
        """Bytes in all."""
        return _HEADER.size + len(self.stream) + _CHECKSUM.size

    @property
    def ratio(self) -> float:
        """How many times as large the rotations were."""
        return self.frames * self.joints * 4 * self.dtype.itemsize / self.nbytes

    def decompress(self, *, scalar_first: bool = True) -> Array:
        """Return the rotations.

        Parameters
        ----------
        scalar_first : bool, default True
            Whether quaternions come as ``(w, x, y, z)``; False for SciPy's ``(x, y, z, w)``.

        Returns
        -------
        ndarray, shape (frames, joints, 4) or (frames, 4)
            Continuous in sign from the first frame on, which has the sign that it had; NaN where samples were missing.

        Raises
        ------
        MemoryError
            If they do not fit into memory.

        Examples
        --------
        >>> import numpy as np, quatfilt as qf
        >>> q = qf.exp(np.linspace(0, 1, 50)[:, None] * [0.3, 0.0, 0.4])
        >>> back = qf.compress(q, tolerance=0.01).decompress()
        >>> bool(qf.geodesic_distance(q, back).max() <= 0.01)
        True
        """
        first = _validation.switch(scalar_first, "scalar_first")
        np.empty((self.frames, self.joints, 4), self.dtype)  # a file may claim more than there is memory for
        double = self.dtype.itemsize == 8
        clip = ops().decompress(self.stream, self.frames, self.joints, double)
        return _validation.scalar_order(clip[:, 0] if self.single else clip, scalar_first=first)

    def save(self, path: PathLike) -> None:
        """Write a file: under a temporary name first, so that an interrupted run leaves an older one as it was.

        Parameters
        ----------
        path : str or path
            Where to; any extension.

        Raises
        ------
        FileAccessError
            If the file cannot be written.

        Examples
        --------
        >>> import numpy as np, quatfilt as qf, tempfile, pathlib
        >>> small = qf.compress(np.tile([1.0, 0.0, 0.0, 0.0], (1000, 1)), tolerance=0.001)
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     path = pathlib.Path(folder) / "still.qfc"
        ...     small.save(path)
        ...     print(qf.Compressed.load(path) == small, path.stat().st_size == small.nbytes)
        True True
        """
        write_bytes(_validation.path(path, "path"), self._to_bytes)

    @classmethod
    def load(cls, path: PathLike) -> Self:
        """Read a file that `save` wrote.

        Parameters
        ----------
        path : str or path
            The file.

        Returns
        -------
        Compressed
            What was saved.

        Raises
        ------
        FileFormatError
            If it is no such file, is damaged or cut off, or was written by a later version.
        FileAccessError
            If it cannot be read.
        """
        name = _validation.path(path, "path")
        data = read_bytes(name)
        if not data.startswith(_MAGIC):
            raise FileFormatError(name, None, "expected compressed rotations, got another kind of file")
        if len(data) < _HEADER.size + _CHECKSUM.size:
            raise FileFormatError(name, None, f"cut off after {len(data)} bytes")
        _, version, itemsize, single, joints, frames, error, length = _HEADER.unpack_from(data)
        if version != _VERSION:
            raise FileFormatError(
                name, None, f"expected version {_VERSION} of compressed rotations, got {version}"
            )
        expected = _HEADER.size + length + _CHECKSUM.size
        if len(data) != expected:
            raise FileFormatError(name, None, f"expected {expected} bytes, got {len(data)}")
        body = data[: -_CHECKSUM.size]
        if _CHECKSUM.unpack_from(data, len(body)) != (zlib.crc32(body),):
            raise FileFormatError(name, None, "damaged: the checksum differs")
        if (
            itemsize not in (4, 8)
            or single > 1
            or (single and joints != 1)
            or frames * joints > _MOST_SAMPLES
        ):
            raise FileFormatError(name, None, "damaged: the header holds impossible values")
        dtype = np.dtype(f"f{itemsize}")
        return cls(body[_HEADER.size :], frames, joints, bool(single), dtype, error)

    def _to_bytes(self) -> bytes:
        header = _HEADER.pack(
            _MAGIC,
            _VERSION,
            self.dtype.itemsize,
            self.single,
            self.joints,
            self.frames,
            self.max_error,
            len(self.stream),
        )
        return header + self.stream + _CHECKSUM.pack(zlib.crc32(header + self.stream))

    def __repr__(self) -> str:
        """Say how much of what this is."""
        joints = "" if self.single else f" of {self.joints} joint{'' if self.joints == 1 else 's'}"
        frames = f"{self.frames} frame{'' if self.frames == 1 else 's'}"
        return f"Compressed({frames}{joints}, {self.dtype}, {self.nbytes} bytes, ratio {self.ratio:.4g})"


__all__ = ["Compressed"]
