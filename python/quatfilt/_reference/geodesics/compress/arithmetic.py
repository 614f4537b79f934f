"""Sine, cosine and arc tangent in basic operations of float64: they have the same bits on every machine.

A stream is decoded elsewhere, and its errors are measured when it is written. So the format fixes every rounding: sums,
products, quotients and square roots of IEEE 754 in a fixed order, and Cephes' polynomials (S. Moshier).
"""

import numpy as np
from numpy.typing import NDArray

Doubles = NDArray[np.float64]

ROUND = 6_755_399_441_055_744.0
"""Adding this to a number below 2⁵¹ rounds to an integer, ties to even, which is then in the low bits."""

QUARTER_TURN = (1.57079632673412561417, 6.07710050630396597660e-11, 2.02226624879595063154e-21)
"""π/2 in three parts (Cody and Waite)."""

SINE = (
    1.58962301576546568060e-10,
    -2.50507477628578072866e-8,
    2.75573136213857245213e-6,
    -1.98412698295895385996e-4,
    8.33333333332211858878e-3,
    -1.66666666666666307295e-1,
)

COSINE = (
    -1.13585365213876817300e-11,
    2.08757008419747316778e-9,
    -2.75573141792967388112e-7,
    2.48015872888517045348e-5,
    -1.38888888888730564116e-3,
    4.16666666666665929218e-2,
)

ARC_NUMERATOR = (
    -8.750608600031904122785e-1,
    -1.615753718733365076637e1,
    -7.500855792314704667340e1,
    -1.228866684490136173410e2,
    -6.485021904942025371773e1,
)

ARC_DENOMINATOR = (
    1.0,
    2.485846490142306297962e1,
    1.650270098316988542046e2,
    4.328810604912902668951e2,
    4.853903996359136964868e2,
    1.945506571482613964425e2,
)

MORE_BITS = 6.123233995736765886130e-17
"""Part of π/2 beyond its last digit."""


def sin_cos(x: Doubles) -> tuple[Doubles, Doubles]:
    """Sine and cosine for `|x| ≤ 5·10⁵`."""
    shifted = x * (2 / np.pi) + ROUND
    n = shifted - ROUND
    quadrant = shifted.view(np.int64)
    rest = ((x - n * QUARTER_TURN[0]) - n * QUARTER_TURN[1]) - n * QUARTER_TURN[2]
    z = rest * rest
    sine = rest + rest * z * _polynomial(z, SINE)
    cosine = 1.0 - 0.5 * z + z * z * _polynomial(z, COSINE)
    odd, upper = quadrant & 1 != 0, quadrant & 2 != 0
    s, c = np.where(odd, cosine, sine), np.where(odd, -sine, cosine)
    return np.where(upper, -s, s), np.where(upper, -c, c)


def atan2(y: Doubles, x: Doubles) -> Doubles:
    """Angle of the point `(x, y)`, in `[−π, π]`."""
    length = np.abs(y)
    low, high = np.minimum(length, np.abs(x)), np.maximum(length, np.abs(x))
    high = np.where(high > 0.0, high, 1.0)
    far = np.where(low > 0.66 * high, 1.0, 0.0)
    a = (low - far * high) / (high + far * low)
    z = a * a
    tail = a * z * (_polynomial(z, ARC_NUMERATOR) / _polynomial(z, ARC_DENOMINATOR))
    octant = far * (np.pi / 4) + (a + (tail + far * (0.5 * MORE_BITS)))
    quadrant = np.where(length > np.abs(x), np.pi / 2 - (octant - MORE_BITS), octant)
    angle: Doubles = np.copysign(np.where(x < 0.0, np.pi - (quadrant - 2.0 * MORE_BITS), quadrant), y)
    return angle


def round_even(x: Doubles) -> Doubles:
    """Nearest integer, ties to even, for `|x| < 2⁵¹`."""
    return (x + ROUND) - ROUND


def _polynomial(x: Doubles, coefficients: tuple[float, ...]) -> Doubles:
    total = np.full_like(x, coefficients[0])
    for coefficient in coefficients[1:]:
        total = total * x + coefficient
    return total
