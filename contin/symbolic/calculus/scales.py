"""How far the nearest singularity of a formula is from w = 0, as conditions |factor w^exponent| < 1."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Final

from contin.model.expression import ONE, Expression, add, as_expression, call, div, mul, numeric_value, power, sub
from contin.model.symbol_masks import symbol_bit
from contin.symbolic.calculus.centres import LOCAL
from contin.symbolic.calculus.polynomials import degree_of
from contin.symbolic.calculus.series import expand, quotient_nodes
from contin.symbolic.calculus.series_arithmetic import is_zero, over, reciprocal
from contin.symbolic.calculus.series_functions import ENTIRE
from contin.symbolic.calculus.vanishing import vanishes

TERMS: Final = 17  # coefficients of an argument that are looked at
LEADING: Final = 3  # and how many non-zero ones are used where the argument is no polynomial


@dataclass(frozen=True)
class Scale:
    """No singularity where |factor w^exponent| < 1."""

    factor: Expression
    exponent: int


def nearest_scales(local: Expression) -> list[Scale]:
    """Scales of every function and every negative or broken power in `local`, redundant ones left out."""
    bit = symbol_bit(LOCAL)
    found: list[Scale] = []
    for node in quotient_nodes(local, bit):
        if node.op == "pow":
            if not _is_whole_power(node):
                if node.args[0].mask & bit:
                    found.extend(_relative(node.args[0]))
                elif node.args[1].mask & bit:
                    found.extend(_absolute(node.args[1], call("log", node.args[0])))
        elif len(node.args) == 1:
            found.extend(_of_function(node))
    kept: list[Scale] = []
    for scale in found:
        if not any(_covers(other, scale) for other in kept):
            kept = [other for other in kept if not _covers(scale, other)]
            kept.append(scale)
    return kept


def _of_function(node: Expression) -> list[Scale]:
    name, argument = node.op, node.args[0]
    if name in ("log", "log10", "sqrt"):
        return _relative(argument)
    if name == "log1p":
        return _relative(add(ONE, argument))
    centre = as_expression(expand(argument, LOCAL, 2).at(0))
    if name in ENTIRE or name in ("tanh", "atan", "asinh") or is_zero(centre):
        return _absolute(argument, ONE)
    if name == "tan":
        return _absolute(argument, add(ONE, power(call("tan", centre), 2)))
    return _absolute(argument, div(ONE, sub(ONE, power(centre, 2))))  # asin, acos


def _absolute(argument: Expression, factor: Expression) -> list[Scale]:
    """Of argument = a_0 + a_1 w + a_2 w^2 + ...: the factor * a_j."""
    series = expand(argument, LOCAL, TERMS)
    coefficients = [mul(factor, as_expression(series.at(k))) for k in range(series.end)]
    return _scales(coefficients, degree_of(argument) is not None)


def _relative(base: Expression) -> list[Scale]:
    """Of base = c w^v (1 + u_1 w + u_2 w^2 + ...): the u_j."""
    series = expand(base, LOCAL, TERMS).stripped()
    if not series.terms:
        return []
    return _scales([as_expression(over(c, series.terms[0])) for c in series.terms], degree_of(base) is not None)


def _scales(coefficients: Sequence[Expression], is_polynomial: bool) -> list[Scale]:
    """All coefficients of a polynomial; of another series, whose functions have scales of their own, the first few."""
    scales = [Scale(c, k) for k, c in enumerate(coefficients) if k > 0 and not vanishes(c)]
    return scales if is_polynomial else scales[:LEADING]


def _covers(wide: Scale, narrow: Scale) -> bool:
    """True where the condition of `wide` implies that of `narrow`."""
    times, rest = divmod(narrow.exponent, wide.exponent)
    if rest:
        return False
    ratio = mul(narrow.factor, reciprocal(power(wide.factor, times)))
    return ratio.is_number and -1 <= numeric_value(ratio) <= 1


def _is_whole_power(node: Expression) -> bool:
    if not node.args[1].is_number:
        return False
    exponent = numeric_value(node.args[1])
    return isinstance(exponent, Fraction) and exponent.denominator == 1 and exponent > 0
