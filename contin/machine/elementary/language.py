"""The few operations that elementary functions are written in, beside + - * / and comparisons.

A function of this room is plain Python over floats, 64-bit integers and truth values, and `translate` writes the same
function as LLVM text. Here is what Python itself has no operator for. All are exact, or rounded once by IEEE 754, so
the function gives the same bits wherever it runs, in the interpreter too.
"""

from __future__ import annotations

import math
import struct
from collections.abc import Callable
from typing import Final, ParamSpec, TypeVar

P = ParamSpec("P")
R = TypeVar("R")

Pair = tuple[float, float]
"""An unevaluated sum high + low, |low| <= ulp(high)/2: about 106 bits."""

RARE: Final[set[str]] = set()


def rare(function: Callable[P, R]) -> Callable[P, R]:
    """A function kept out of line: the arguments that need it are few."""
    RARE.add(function.__name__)
    return function


def bits(x: float) -> int:
    """The 64 bits of x as a signed integer."""
    return int(struct.unpack("<q", struct.pack("<d", x))[0])


def double(i: int) -> float:
    """The number with these 64 bits."""
    return float(struct.unpack("<d", struct.pack("<Q", i & 0xFFFFFFFFFFFFFFFF))[0])


def fabs(x: float) -> float:
    """|x|, without the sign of zero or NaN."""
    return abs(x)


def sqrt(x: float) -> float:
    """Square root, correctly rounded; NaN below 0."""
    return math.sqrt(x) if x >= 0 or x != x else math.nan


def quotient(x: float, y: float) -> float:
    """x/y where y may be 0, which IEEE 754 defines and Python refuses."""
    if y != 0:
        return x / y
    return math.nan if x == 0 or x != x else math.copysign(math.inf, x) * math.copysign(1.0, y)


def copysign(x: float, y: float) -> float:
    """|x| with the sign of y."""
    return math.copysign(x, y)


def to_float(i: int) -> float:
    """A signed integer, rounded to nearest."""
    return float(i)


def shift_right(i: int, by: int) -> int:
    """The 64 bits moved right, zeros coming in; 0 <= by < 64."""
    return _signed((i & 0xFFFFFFFFFFFFFFFF) >> by)


def shift_left(i: int, by: int) -> int:
    """The 64 bits moved left, those beyond the top lost; 0 <= by < 64."""
    return _signed(i << by)


def low_product(a: int, b: int) -> int:
    """The lower 64 bits of the product of two unsigned integers."""
    return _signed(a * b)


def high_product(a: int, b: int) -> int:
    """The upper 64 bits of the product of two unsigned integers."""
    return _signed(((a & 0xFFFFFFFFFFFFFFFF) * (b & 0xFFFFFFFFFFFFFFFF)) >> 64)


def low_sum(a: int, b: int) -> int:
    """a + b modulo 2^64."""
    return _signed(a + b)


def carry(a: int, b: int) -> int:
    """1 where a + b, both unsigned, is 2^64 or more."""
    return ((a & 0xFFFFFFFFFFFFFFFF) + (b & 0xFFFFFFFFFFFFFFFF)) >> 64


def _signed(i: int) -> int:
    i &= 0xFFFFFFFFFFFFFFFF
    return i - (1 << 64) if i >> 63 else i
