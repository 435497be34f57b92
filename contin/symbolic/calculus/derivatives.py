"""Derivatives of formulas: rules for every function of the grammar, applied forward through the graph.

One pass visits each node that depends on the variable once (its `mask` says so), so a Jacobian costs the number of
(node, variable) pairs that really depend on each other. Conventions where a derivative does not exist: the slope of
abs at 0 is sign(0) = 0, the mean of both sides; min and max take the slope of their first argument on a tie; sign,
heaviside, floor, ceil and factorial (of whole numbers) have slope 0 everywhere (no delta functions); conditions are
never differentiated, so a conditional has the one-sided slopes of the branch that is taken.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from fractions import Fraction
from typing import Final

from contin.model.expression import (
    MINUS_ONE,
    ONE,
    ZERO,
    Expression,
    add,
    call,
    compare,
    div,
    if_,
    logical,
    mask_of,
    mul,
    neg,
    number,
    numeric_value,
    postorder,
    power,
    sub,
    substitute,
    symbol,
)
from contin.model.symbol_masks import symbol_bit
from contin.symbolic.calculus.guards import near_zero

Differentials = dict[Expression, Expression]
"""Node -> its differential, for the nodes where that is not zero."""


def derivative(expression: Expression, name: str) -> Expression:
    """d expression / d name."""
    return sparse_jacobian([expression], [name]).get((0, 0), ZERO)


def jacobian(expressions: Sequence[Expression], names: Sequence[str]) -> list[list[Expression]]:
    """Rows [d e / d name for name in names], one for each expression; zeros are the node ZERO."""
    rows = [[ZERO] * len(names) for _ in expressions]
    for (i, j), entry in sparse_jacobian(expressions, names).items():
        rows[i][j] = entry
    return rows


def sparse_jacobian(expressions: Sequence[Expression], names: Sequence[str]) -> dict[tuple[int, int], Expression]:
    """The non-zero entries {(i, j): d e_i / d name_j}, row by row with ascending columns."""
    bits = [symbol_bit(name) for name in names]
    touched = _nodes_by_bit(expressions, names)
    slopes: dict[Expression, tuple[Expression, ...]] = {}
    columns: list[Differentials] = []
    for name, bit in zip(names, bits, strict=True):
        differentials: Differentials = {symbol(name): ONE}
        for node in touched[bit]:
            _differentiate(node, differentials, slopes)
        columns.append({e: differentials[e] for e in expressions if e in differentials})
    entries: dict[tuple[int, int], Expression] = {}
    for i, expression in enumerate(expressions):
        for j, column in enumerate(columns):
            if expression.mask & bits[j] and expression in column:
                entries[i, j] = column[expression]
    return entries


def direction_symbols(order: int, count: int) -> list[Expression]:
    """Symbols for the components of the `order`-th direction; their names cannot occur in a model."""
    return [symbol(f"@{order}[{i}]") for i in range(count)]


def directional(
    expressions: Iterable[Expression], names: Sequence[str], directions: Sequence[Sequence[Expression]]
) -> list[Expression]:
    """D^k e (d_1, ..., d_k): the k-th derivative along k directions, each with one component for every name.

    The multilinear form of the expressions' Taylor expansion (Kuznetsov, Elements of Applied Bifurcation Theory,
    3rd ed., sec. 5.4: B(v, w) for k = 2, C(v, w, s) for k = 3). Directions are constants, whatever they contain.
    """
    results = list(expressions)
    replace: dict[Expression, Expression] = {}
    for order, direction in enumerate(directions, start=1):
        if len(direction) != len(names):
            raise ValueError(f"a direction has one component for each of {len(names)} names; got {len(direction)}")
        fresh = direction_symbols(order, len(names))
        # zero components stay zeros, so that whatever they would multiply is never built
        components = [f if d is not ZERO else ZERO for f, d in zip(fresh, direction, strict=True)]
        replace.update({f: d for f, d in zip(fresh, direction, strict=True) if f is not d})
        results = _along(results, names, components)
    return substitute(results, replace) if replace else results


def _along(expressions: list[Expression], names: Sequence[str], direction: Sequence[Expression]) -> list[Expression]:
    mask = mask_of(names)
    differentials: Differentials = {symbol(n): d for n, d in zip(names, direction, strict=True) if d is not ZERO}
    slopes: dict[Expression, tuple[Expression, ...]] = {}
    for node in postorder(expressions):
        if node.args and node.mask & mask:
            _differentiate(node, differentials, slopes)
    return [differentials.get(e, ZERO) for e in expressions]


def _nodes_by_bit(expressions: Sequence[Expression], names: Sequence[str]) -> dict[int, list[Expression]]:
    """For each name's bit, the inner nodes that depend on it, operands first."""
    lists: dict[int, list[Expression]] = {symbol_bit(name): [] for name in names}
    wanted = mask_of(names)
    for node in postorder(expressions):
        if not node.args:
            continue
        mask = node.mask & wanted
        while mask:
            lowest = mask & -mask
            lists[lowest].append(node)
            mask ^= lowest
    return lists


def _differentiate(
    node: Expression, differentials: Differentials, slopes: dict[Expression, tuple[Expression, ...]]
) -> None:
    """Enter the differential of `node` from those of its operands, where it is not zero."""
    op, args = node.op, node.args
    if op == "add":
        result = _sum([differentials[a] for a in args if a in differentials])
    elif op == "mul":
        result = _sum(
            [mul(*args[:k], differentials[a], *args[k + 1 :]) for k, a in enumerate(args) if a in differentials]
        )
    elif op == "if":
        result = if_(args[0], differentials.get(args[1], ZERO), differentials.get(args[2], ZERO))
    elif op in ("min", "max"):
        first = compare("<=" if op == "min" else ">=", *args)
        result = if_(first, differentials.get(args[0], ZERO), differentials.get(args[1], ZERO))
    elif op == "pow":
        result = _power_rule(args[0], args[1], differentials.get(args[0], ZERO), differentials.get(args[1], ZERO))
    elif op in SLOPES:
        slope = slopes.get(node)
        if slope is None:
            slope = slopes[node] = SLOPES[op](node)
        # the inner factors first: then they stay a common beginning of the outer products
        result = _sum([mul(differentials[a], s) for s, a in zip(slope, args, strict=True) if a in differentials])
    else:
        return  # conditions
    if result is not ZERO:
        differentials[node] = result


def _sum(terms: list[Expression]) -> Expression:
    if len(terms) == 1:
        return terms[0]
    return add(*terms) if terms else ZERO


def _power_rule(base: Expression, exponent: Expression, d_base: Expression, d_exponent: Expression) -> Expression:
    """d(b^e) = e b^(e-1) db + b^e log(b) de, with the limits at b = 0 where the formula says 0 * infinity."""
    if exponent.is_number:
        return mul(exponent, power(base, _minus_one(exponent)), d_base)
    along_base = mul(exponent, power(base, _minus_one(exponent)))
    if exponent.mask and base.mask:
        # x^n for n = 2, three times differentiated, at x = 0; for x != 0 the formula is right also where n = 0
        along_base = if_(logical("and", near_zero(base), near_zero(exponent)), ZERO, along_base)
    if d_exponent is ZERO:
        return mul(along_base, d_base)
    along_exponent = mul(power(base, exponent), call("log", base))
    if base.mask:
        along_exponent = if_(near_zero(base), ZERO, along_exponent)
    return add(mul(along_base, d_base), mul(along_exponent, d_exponent))


def _minus_one(exponent: Expression) -> Expression:
    if exponent.is_number:
        return number(numeric_value(exponent) - 1)
    return sub(exponent, ONE)


def _arc_slope(x: Expression) -> Expression:
    """1/sqrt(1 - x^2), without cancellation at the ends."""
    return power(mul(sub(ONE, x), add(ONE, x)), number(Fraction(-1, 2)))


def _atan2_slopes(node: Expression) -> tuple[Expression, ...]:
    y, x = node.args
    squared = add(power(x, 2), power(y, 2))
    return div(x, squared), neg(div(y, squared))


SLOPES: Final[dict[str, Callable[[Expression], tuple[Expression, ...]]]] = {
    "sin": lambda n: (call("cos", *n.args),),
    "cos": lambda n: (neg(call("sin", *n.args)),),
    "tan": lambda n: (add(ONE, power(n, 2)),),
    "asin": lambda n: (_arc_slope(n.args[0]),),
    "acos": lambda n: (neg(_arc_slope(n.args[0])),),
    "atan": lambda n: (power(add(ONE, power(n.args[0], 2)), MINUS_ONE),),
    "atan2": _atan2_slopes,
    "sinh": lambda n: (call("cosh", *n.args),),
    "cosh": lambda n: (call("sinh", *n.args),),
    "tanh": lambda n: (sub(ONE, power(n, 2)),),  # not 1/cosh^2: its derivatives overflow to NaN for large arguments
    "asinh": lambda n: (power(add(ONE, power(n.args[0], 2)), number(Fraction(-1, 2))),),
    "acosh": lambda n: (power(mul(sub(n.args[0], ONE), add(n.args[0], ONE)), number(Fraction(-1, 2))),),
    "atanh": lambda n: (power(mul(sub(ONE, n.args[0]), add(ONE, n.args[0])), MINUS_ONE),),
    "exp": lambda n: (n,),
    "expm1": lambda n: (call("exp", *n.args),),
    "log": lambda n: (power(n.args[0], MINUS_ONE),),
    "log1p": lambda n: (power(add(ONE, n.args[0]), MINUS_ONE),),
    "log10": lambda n: (power(mul(n.args[0], call("log", 10)), MINUS_ONE),),
    "sqrt": lambda n: (div(number(Fraction(1, 2)), n),),
    "abs": lambda n: (call("sign", *n.args),),
    "sign": lambda n: (ZERO,),
    "heaviside": lambda n: (ZERO,),
    "floor": lambda n: (ZERO,),
    "ceil": lambda n: (ZERO,),
    "factorial": lambda n: (ZERO,),
    "mod": lambda n: (ONE, neg(call("floor", div(*n.args)))),  # a - b floor(a/b)
}
"""Function -> its partial derivatives, as formulas; sums, products, powers, min, max and if are in `_differentiate`."""
