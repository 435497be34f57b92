"""Taylor series of the functions of the grammar at a series, by recurrences from their differential equations."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from typing import Final

from contin.model.expression import as_expression, call, div, number
from contin.symbolic.calculus.series_arithmetic import (
    Coefficient,
    NotAnalyticError,
    Series,
    dot,
    integrated,
    is_zero,
    plain,
    plus,
    scaled,
    series_power,
    series_product,
    series_sum,
    slope_terms,
    times,
)

ENTIRE: Final = frozenset({"exp", "expm1", "sin", "cos", "sinh", "cosh"})


def function_series(name: str, argument: Series) -> Series:
    """name(argument); raises `NotAnalyticError` at a pole, a kink, or the end of the function's domain."""
    if argument.start < 0:
        argument = argument.stripped()
        if argument.start < 0:
            raise NotAnalyticError(f"{name} of a pole")
    a = Series(0, tuple(argument.at(k) for k in range(argument.end)))
    rule = _RULES.get(name)
    if rule is None or not a.terms:
        raise NotAnalyticError(name)
    return rule(a)


def _of_constant(name: str, a: Series) -> Coefficient:
    return plain(call(name, as_expression(a.terms[0])))


def _exp(a: Series) -> Series:
    slope = slope_terms(a)
    y: list[Coefficient] = [Fraction(1)]
    for k in range(1, len(a.terms)):
        y.append(times(Fraction(1, k), dot(slope[:k], y[k - 1 :: -1])))
    return scaled(_of_constant("exp", a), Series(0, tuple(y)))


def _expm1(a: Series) -> Series:
    return Series(0, (_of_constant("expm1", a), *_exp(a).terms[1:]))


def _pair(names: tuple[str, str], sign: int) -> tuple[Callable[[Series], Series], Callable[[Series], Series]]:
    """(sin, cos) with sign -1, (sinh, cosh) with sign 1: s' = c a', c' = sign s a'."""

    def both(a: Series) -> tuple[Series, Series, Coefficient, Coefficient]:
        slope = slope_terms(a)
        s: list[Coefficient] = [Fraction(0)]
        c: list[Coefficient] = [Fraction(1)]
        for k in range(1, len(a.terms)):
            s_k = times(Fraction(1, k), dot(slope[:k], c[k - 1 :: -1]))
            c_k = times(Fraction(sign, k), dot(slope[:k], s[k - 1 :: -1]))
            s.append(s_k)
            c.append(c_k)
        return Series(0, tuple(s)), Series(0, tuple(c)), _of_constant(names[0], a), _of_constant(names[1], a)

    def odd(a: Series) -> Series:
        s, c, s0, c0 = both(a)
        return series_sum([scaled(s0, c), scaled(c0, s)])

    def even(a: Series) -> Series:
        s, c, s0, c0 = both(a)
        return series_sum([scaled(c0, c), scaled(times(Fraction(sign), s0), s)])

    return odd, even


def _ratio(odd: Callable[[Series], Series], even: Callable[[Series], Series]) -> Callable[[Series], Series]:
    def quotient(a: Series) -> Series:
        if is_zero(a.terms[0]):
            a = Series(0, (Fraction(0), *a.terms[1:]))
        return series_product(odd(a), series_power(even(a), number(-1)))

    return quotient


def _log(a: Series) -> Series:
    if is_zero(a.terms[0]):
        raise NotAnalyticError("log of zero")
    slope = Series(0, tuple(slope_terms(a)))
    return integrated(_of_constant("log", a), series_product(slope, series_power(a, number(-1))), len(a.terms))


def _log1p(a: Series) -> Series:
    shifted = Series(0, (plus(Fraction(1), a.terms[0]), *a.terms[1:]))
    return Series(0, (_of_constant("log1p", a), *_log(shifted).terms[1:]))


def _log10(a: Series) -> Series:
    decadic = scaled(div(1, call("log", 10)), _log(a))
    return Series(0, (_of_constant("log10", a), *decadic.terms[1:]))


def _arc(name: str, sign: int, exponent: Fraction, factor: int) -> Callable[[Series], Series]:
    """asin, acos, atan: derivative factor (1 + sign a^2)^exponent a'."""

    def rule(a: Series) -> Series:
        square = series_product(a, a)
        inner = Series(
            0, (plus(Fraction(1), times(Fraction(sign), square.terms[0])), *scaled(Fraction(sign), square).terms[1:])
        )
        slope = series_product(Series(0, tuple(slope_terms(a))), series_power(inner, number(exponent)))
        return integrated(_of_constant(name, a), scaled(Fraction(factor), slope), len(a.terms))

    return rule


def _sqrt(a: Series) -> Series:
    return series_power(a, number(Fraction(1, 2)))


_sin, _cos = _pair(("sin", "cos"), -1)
_sinh, _cosh = _pair(("sinh", "cosh"), 1)
_RULES: Final[dict[str, Callable[[Series], Series]]] = {
    "exp": _exp,
    "expm1": _expm1,
    "sin": _sin,
    "cos": _cos,
    "sinh": _sinh,
    "cosh": _cosh,
    "tan": _ratio(_sin, _cos),
    "tanh": _ratio(_sinh, _cosh),
    "log": _log,
    "log1p": _log1p,
    "log10": _log10,
    "sqrt": _sqrt,
    "asin": _arc("asin", -1, Fraction(-1, 2), 1),
    "acos": _arc("acos", -1, Fraction(-1, 2), -1),
    "atan": _arc("atan", 1, Fraction(-1), 1),
    "asinh": _arc("asinh", 1, Fraction(-1, 2), 1),
    "atanh": _arc("atanh", -1, Fraction(-1), 1),
}
