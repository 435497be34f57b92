"""hypot: the square root of x^2 + y^2 formed as a pair."""

from __future__ import annotations

import math

from contin.machine.elementary.double_double import fast_two_sum, square, square_root
from contin.machine.elementary.language import fabs, rare

INFINITY = math.inf
TWO_600, TWO_MINUS_600 = 4.149515568880993e180, 2.409919865102884e-181


def hypot(x: float, y: float) -> float:
    """sqrt(x^2 + y^2) without overflow or underflow on the way; infinite where x or y is, even beside NaN."""
    a = fabs(x)
    b = fabs(y)
    large = a if a > b else b
    small = b if a > b else a
    if not (large < 1e150 and small > 1e-140):
        return hypot_special(a, b)
    return norm(large, small)


def norm(large: float, small: float) -> float:
    """sqrt(large^2 + small^2) where nothing overflows."""
    p, e = square(large)
    q, f = square(small)
    h, d = fast_two_sum(p, q)
    h, d = fast_two_sum(h, d + (e + f))
    h, d = square_root(h, d)
    return h


@rare
def hypot_special(a: float, b: float) -> float:
    """The same for arguments that are 0, infinite, NaN, very large or very small."""
    if a == INFINITY or b == INFINITY:
        return INFINITY
    if a != a or b != b:
        return a + b
    large = a if a > b else b
    small = b if a > b else a
    if small <= large * 1e-17:
        return large + small
    if large >= 1e150:
        return norm(large * TWO_MINUS_600, small * TWO_MINUS_600) * TWO_600
    return norm(large * TWO_600, small * TWO_600) * TWO_MINUS_600
