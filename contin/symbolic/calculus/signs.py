"""Formulas that are positive for all real values of their symbols, by the rules of signs."""

from __future__ import annotations

from fractions import Fraction

from contin.model.expression import Expression, numeric_value, postorder

POSITIVE, NOT_NEGATIVE, UNKNOWN = 2, 1, 0


def is_positive(expression: Expression) -> bool:
    """True where the formula is provably above zero at every real point (so that it is no denominator that vanishes).

    Sums and products of such formulas, even powers, absolute values, square roots, exponentials and cosh. False means
    that these rules do not tell. One walk over the nodes.
    """
    signs: dict[Expression, int] = {}
    for node in postorder([expression]):
        signs[node] = _sign(node, [signs[argument] for argument in node.args])
    return signs[expression] == POSITIVE


def _sign(node: Expression, signs: list[int]) -> int:
    if node.is_number:
        value = numeric_value(node)
        return POSITIVE if value > 0 else NOT_NEGATIVE if value == 0 else UNKNOWN
    if node.op in ("exp", "cosh"):
        return POSITIVE
    if node.op in ("abs", "sqrt"):
        return max(NOT_NEGATIVE, signs[0])
    if node.op == "add":
        return min(min(signs), NOT_NEGATIVE) if POSITIVE not in signs or UNKNOWN in signs else POSITIVE
    if node.op in ("mul", "min"):
        return min(signs)
    if node.op == "max":
        return max(signs)
    if node.op == "pow":
        return max(signs[0], NOT_NEGATIVE) if _is_even(node.args[1]) else signs[0]
    return UNKNOWN


def _is_even(exponent: Expression) -> bool:
    value = numeric_value(exponent) if exponent.is_number else None
    return isinstance(value, Fraction) and value.denominator == 1 and value.numerator % 2 == 0
