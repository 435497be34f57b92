"""Laurent series of a formula in one of its symbols."""

from __future__ import annotations

from fractions import Fraction

from contin.model.expression import Expression, numeric_value
from contin.model.symbol_masks import symbol_bit
from contin.symbolic.calculus.guards import is_guard
from contin.symbolic.calculus.series_arithmetic import (
    Coefficient,
    NotAnalyticError,
    Series,
    series_power,
    series_product,
    series_sum,
)
from contin.symbolic.calculus.series_functions import function_series


def expand(expression: Expression, variable: str, terms: int) -> Series:
    """Laurent series of `expression` in `variable` about 0, from about `terms` terms of each part.

    Raises `NotAnalyticError` where there is none.
    """
    bit = symbol_bit(variable)
    known: dict[Expression, Series] = {}
    for node in quotient_nodes(expression, bit):
        if node.op == "symbol":
            known[node] = Series(0, (Fraction(0), Fraction(1), *[Fraction(0)] * (terms - 2))[:terms])
        else:
            known[node] = _node_series(node, [known.get(a) or _constant(a, terms) for a in _operands(node)], bit)
    return known.get(expression) or _constant(expression, terms)


def quotient_nodes(expression: Expression, bit: int) -> list[Expression]:
    """The nodes that depend on the variable, operands first; behind a guard only the quotient that it guards.

    Raises `NotAnalyticError` for any other conditional.
    """
    order: list[Expression] = []
    seen: set[Expression] = set()
    stack = [(expression, False)]
    while stack:
        node, done = stack.pop()
        if done:
            order.append(node)
        elif node.mask & bit and node not in seen:
            seen.add(node)
            stack.append((node, True))
            stack.extend((a, False) for a in _operands(node))
    return order


def _operands(node: Expression) -> tuple[Expression, ...]:
    if node.op != "if":
        return node.args
    condition = node.args[0]
    if all(is_guard(c) for c in (condition.args if condition.op == "and" else (condition,))):
        return node.args[2:]
    raise NotAnalyticError("conditional")


def _constant(node: Expression, terms: int) -> Series:
    value: Coefficient = numeric_value(node) if node.is_number else node
    return Series(0, (value, *[Fraction(0)] * (terms - 1)))


def _node_series(node: Expression, parts: list[Series], bit: int) -> Series:
    op = node.op
    if op == "add":
        return series_sum(parts)
    if op == "mul":
        product = parts[0]
        for factor in parts[1:]:
            product = series_product(product, factor)
        return product
    if op == "pow":
        if node.args[1].mask & bit:
            return function_series("exp", series_product(parts[1], function_series("log", parts[0])))
        return series_power(parts[0], node.args[1])
    if op == "if":
        return parts[0]
    if len(parts) == 1:
        return function_series(op, parts[0])
    raise NotAnalyticError(op)
