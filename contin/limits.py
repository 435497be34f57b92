"""Which numbers a file or a call may hold: those of double precision, and counts whose results a computer can hold."""

from __future__ import annotations

import math
import sys
from typing import Final

from contin.errors import InputError

LARGEST_COUNT: Final = 1_000_000_000  # steps, budgets: what is done one by one
LARGEST_TABLE: Final = 20_000_000  # numbers kept at once: samples times columns
MOST_INTERVALS: Final = 10_000  # of a mesh
MOST_POINTS: Final = 7  # Gauss points an interval of a mesh
MOST_RUNS: Final = 10_000_000  # of a scan


def is_finite(value: int | float) -> bool:
    """True for what double precision holds; a whole number may have more digits than that."""
    return abs(value) <= sys.float_info.max if isinstance(value, int) else math.isfinite(value)


def as_double(value: int | float) -> float:
    """The nearest number of double precision, infinite where there is none."""
    return float(value) if is_finite(value) else math.copysign(math.inf, value) if value == value else math.nan


def check_count(name: str, value: object, least: int = 1, most: int = LARGEST_COUNT) -> int:
    """`value`, a whole number from `least` to `most`; InputError that names it otherwise."""
    if isinstance(value, bool) or not isinstance(value, int) or value < least:
        raise InputError(f"{name} must be a whole number, {least} or more; got {brief(value)}")
    if value > most:
        raise InputError(f"{name} must be {most} at most; got {brief(value)}")
    return value


def brief(value: object) -> str:
    """A value for a message; a whole number of more digits than Python converts by its number of digits."""
    if isinstance(value, int) and not isinstance(value, bool) and abs(value) >= 10**60:
        return f"a number of {int(math.log10(abs(value))) + 1} digits"
    text = repr(value)
    return text if len(text) <= 60 else text[:56] + " ..."
