"""Arithmetic of constants in formulas: exact where it can be, and nothing that rounds.

What has no exact result is left for the machine code, so that all forms of a formula round alike.
"""

from __future__ import annotations

import math
from fractions import Fraction
from typing import Final, Union

from contin.model.vocabulary import STEPWISE, VARIADIC_FUNCTIONS

Number = Union[Fraction, float]

FOLD_LIMIT_BITS: Final = 400  # a folded rational larger than this becomes a float
SHORT_DIGITS: Final = 15  # every decimal this short survives the way to a double and back


def constant(value: int | float | Fraction) -> Number:
    """Integers, fractions and short decimals (0.1 is 1/10) are exact; a float with more than `SHORT_DIGITS`
    significant digits is a rounded result and keeps its binary value."""
    if isinstance(value, float):
        if not math.isfinite(value):
            return math.nan if value != value else value  # one NaN, whatever its source
        if value.is_integer() and abs(value) < 2.0**53:
            return Fraction(int(value))
        shortest = float.__repr__(value)
        if significant_digits(shortest) > SHORT_DIGITS:
            return float(value)
        value = Fraction(shortest)
    exact = Fraction(value)
    if exact.numerator.bit_length() > FOLD_LIMIT_BITS or exact.denominator.bit_length() > FOLD_LIMIT_BITS:
        try:
            return float(exact)
        except OverflowError:
            return math.inf if exact > 0 else -math.inf
    return exact


def significant_digits(decimal: str) -> int:
    """Significant digits of a decimal like 0.0120 (2) or 1.5e-3 (2)."""
    mantissa = decimal.lower().partition("e")[0].lstrip("+-")
    return len(mantissa.replace(".", "").strip("0"))


def folded_power(base: Number, exponent: int) -> Number | None:
    """base^exponent; None where it is left as it stands."""
    if base == 0 and exponent < 0:
        return None  # stays visible as a division by zero
    if isinstance(base, Fraction):
        bits = max(base.numerator.bit_length(), base.denominator.bit_length())
        if bits * abs(exponent) > FOLD_LIMIT_BITS:
            return None
        return base**exponent
    try:
        return float(base**exponent)
    except (OverflowError, ZeroDivisionError):
        return None


_AT_ZERO: Final = frozenset("sin tan asin atan sinh tanh asinh atanh expm1 log1p sqrt".split())
_ONE_AT_ZERO: Final = frozenset({"cos", "cosh", "exp"})


def folded_call(name: str, values: list[Number]) -> Number | None:
    """Exact results only: everything else is left for the machine code, so that all forms round alike."""
    x = values[0]
    if name in VARIADIC_FUNCTIONS:
        return min(values) if name == "min" else max(values)
    if name == "abs":
        return -x if x < 0 else x
    if name == "sign":
        return Fraction((x > 0) - (x < 0))
    if name == "heaviside":
        return Fraction(1, 2) if x == 0 else Fraction(int(x > 0))
    if name in STEPWISE:
        return _folded_step(name, values)
    if x == 0 and name in _AT_ZERO:
        return Fraction(0)
    if x == 0 and name in _ONE_AT_ZERO:
        return Fraction(1)
    if x == 1 and name in ("log", "log10", "sqrt"):
        return Fraction(int(name == "sqrt"))
    if name == "sqrt" and isinstance(x, Fraction) and x > 0:
        top, bottom = math.isqrt(x.numerator), math.isqrt(x.denominator)
        if top * top == x.numerator and bottom * bottom == x.denominator:
            return Fraction(top, bottom)
    return None


def _folded_step(name: str, values: list[Number]) -> Number | None:
    if not all(isinstance(v, Fraction) for v in values):
        return None
    x = Fraction(values[0])
    if name == "mod":
        return x % Fraction(values[1]) if values[1] else None
    if name == "factorial":
        return Fraction(math.factorial(int(x))) if x.denominator == 1 and 0 <= x <= 20 else None
    return Fraction(math.floor(x) if name == "floor" else math.ceil(x))


_COMPARE: Final = {
    "<": lambda a, b: a < b, "<=": lambda a, b: a <= b, ">": lambda a, b: a > b,
    ">=": lambda a, b: a >= b, "==": lambda a, b: a == b, "!=": lambda a, b: a != b,
}  # fmt: skip


def holds(op: str, a: Number, b: Number) -> bool:
    """Whether a < b, a <= b, ..."""
    return bool(_COMPARE[op](a, b))
