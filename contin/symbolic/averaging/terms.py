"""Sums taken apart: a formula as a list of (coefficient free of the states, term); each term is averaged alone."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

from contin.model.expression import (
    ONE,
    ZERO,
    Expression,
    add,
    compare,
    if_,
    logical,
    mul,
    neg,
    number,
    numeric_value,
    postorder,
    power,
    rebuild,
    substitute,
)

Term = tuple[Expression, Expression]
EXPANSION_LIMIT = 400  # terms; a power of a sum beyond this stays as it is


def additive_terms(expression: Expression, mask: int) -> list[Term]:
    """[(c, t), ...] with expression = sum of c*t; no c contains a symbol of `mask`, equal t are collected.

    Products of sums are multiplied out as far as they are polynomial in the symbols of `mask`; coefficients stay as
    their author wrote them.
    """
    collected: dict[Expression, list[Expression]] = {}
    for c, t in _split(expression, mask):
        collected.setdefault(t, []).append(c)
    sums = ((add(*c), t) for t, c in collected.items())
    return [(c, t) for c, t in sums if c is not ZERO]


def _split(node: Expression, mask: int) -> list[Term]:
    if not node.mask & mask:
        return [(node, ONE)] if node is not ZERO else []
    if node.op == "add":
        return [pair for argument in node.args for pair in _split(argument, mask)]
    if node.op == "mul":
        return _product([_split(factor, mask) for factor in node.args], node)
    if node.op == "pow" and node.args[1].op == "number" and node.args[0].op == "add":
        exponent = numeric_value(node.args[1])
        if isinstance(exponent, Fraction) and exponent.denominator == 1 and 1 < exponent <= 12:
            return _product([_split(node.args[0], mask)] * int(exponent), node)
    if node.op == "pow" and node.args[1].op == "number" and node.args[0].op == "mul":
        exponent = numeric_value(node.args[1])
        if isinstance(exponent, Fraction) and exponent.denominator == 1:
            free = [f for f in node.args[0].args if not f.mask & mask]
            if free:
                bound = [f for f in node.args[0].args if f.mask & mask]
                inner = _split(power(mul(*bound), node.args[1]), mask)
                return [(mul(power(mul(*free), node.args[1]), c), t) for c, t in inner]
    if node.op == "if" and not node.args[0].mask & mask:
        then = [(if_(node.args[0], c, ZERO), t) for c, t in _split(node.args[1], mask)]
        return then + [(if_(node.args[0], ZERO, c), t) for c, t in _split(node.args[2], mask)]
    if node.op == "if":
        then = [(c, if_(node.args[0], t, ZERO)) for c, t in _split(node.args[1], mask)]
        return then + [(c, if_(node.args[0], ZERO, t)) for c, t in _split(node.args[2], mask)]
    return [(ONE, node)]


def _product(factors: Sequence[list[Term]], node: Expression) -> list[Term]:
    size = 1
    for terms in factors:
        size *= max(len(terms), 1)
    if size > EXPANSION_LIMIT:
        return [(ONE, node)]
    product: list[Term] = [(ONE, ONE)]
    for terms in factors:
        collected: dict[Expression, list[Expression]] = {}
        for c, t in product:
            for d, s in terms:
                collected.setdefault(mul(t, s), []).append(mul(c, d))
        product = [(add(*c), t) for t, c in collected.items()]
    return product


def without_kinks(expression: Expression, mask: int) -> Expression:
    """abs, sign, heaviside, min and max of the symbols of `mask` written as conditionals, and no conditional inside a
    comparison. The value on a switching surface itself, which no average sees, may change."""
    done: dict[Expression, Expression] = {}
    for node in postorder([expression]):
        args = tuple(done[a] for a in node.args)
        new = rebuild(node, args) if args else node
        done[node] = _plain(new) if new.mask & mask else new
    return done[expression]


def _plain(node: Expression) -> Expression:
    op, args = node.op, node.args
    if op == "abs":
        return if_(_lifted(compare(">", args[0], ZERO)), args[0], neg(args[0]))
    if op == "sign":
        return if_(_lifted(compare(">", args[0], ZERO)), ONE, number(-1))
    if op == "heaviside":
        return if_(_lifted(compare(">", args[0], ZERO)), ONE, ZERO)
    if op in ("min", "max"):
        return if_(_lifted(compare("<" if op == "min" else ">", *args)), *args)
    if op in ("<", "<=", ">", ">=", "==", "!="):
        return _lifted(node)
    return node


def factors_apart(expression: Expression, mask: int) -> Expression:
    """Conditions u*v > 0 on the symbols of `mask` as (u > 0 and v > 0) or (not u > 0 and not v > 0)."""
    done: dict[Expression, Expression] = {}
    for node in postorder([expression]):
        args = tuple(done[a] for a in node.args)
        new = rebuild(node, args) if args else node
        done[node] = _apart(new) if new.op in ("<", "<=", ">", ">=") and new.mask & mask else new
    return done[expression]


def _apart(comparison: Expression) -> Expression:
    low, high = comparison.args if comparison.op in ("<", "<=") else comparison.args[::-1]
    difference = add(high, neg(low))
    if difference.op != "mul":
        return comparison
    result: Expression | None = None
    for factor in difference.args:
        own = compare(">", factor, ZERO)
        if result is None:
            result = own
        else:
            both = logical("and", result, own)
            neither = logical("and", logical("not", result), logical("not", own))
            result = logical("or", both, neither)
    assert result is not None
    return result


def _lifted(comparison: Expression) -> Expression:
    """(a if q else b) > c as (q and a > c) or (not q and b > c)."""
    if comparison.op not in ("<", "<=", ">", ">=", "==", "!="):
        return comparison
    inner = next((n for n in postorder(comparison.args) if n.op == "if"), None)
    if inner is None:
        return comparison
    condition, then, otherwise = inner.args
    sides = []
    for choice in (then, otherwise):
        sides.append(_lifted(substitute([comparison], {inner: choice})[0]))
    return logical("or", logical("and", condition, sides[0]), logical("and", logical("not", condition), sides[1]))
