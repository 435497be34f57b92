"""Truncated Laurent series in one symbol, with formulas (in the other symbols) as coefficients.

Coefficients are Python numbers while they are numbers (exact where the formula is), formulas otherwise. Each operation
keeps as many terms as it can know; division by a series that starts with w^v loses v of them.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Final, Union

from contin.model.expression import (
    Expression,
    Number,
    add,
    as_expression,
    call,
    div,
    mul,
    number,
    numeric_value,
    power,
    symbol_bit,
)
from contin.symbolic.guards import is_guard
from contin.symbolic.vanishing import vanishes

Coefficient = Union[Number, Expression]
ENTIRE: Final = frozenset({"exp", "expm1", "sin", "cos", "sinh", "cosh"})


class NotAnalyticError(ArithmeticError):
    """The formula has no Laurent series here that this module knows (a kink, a branch point, a condition)."""


@dataclass(frozen=True)
class Series:
    """sum of terms[k] w^(start + k), known up to (not including) w^(start + len(terms))."""

    start: int
    terms: tuple[Coefficient, ...]

    @property
    def end(self) -> int:
        """First unknown power."""
        return self.start + len(self.terms)

    def at(self, exponent: int) -> Coefficient:
        """Coefficient of w^exponent, which must be known."""
        if exponent >= self.end:
            raise IndexError(exponent)
        return self.terms[exponent - self.start] if exponent >= self.start else Fraction(0)

    def stripped(self) -> Series:
        """The same series from its first term that is not identically zero."""
        for k, term in enumerate(self.terms):
            if not is_zero(term):
                return Series(self.start + k, self.terms[k:])
        return Series(self.end, ())


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
        return _sum(parts)
    if op == "mul":
        product = parts[0]
        for factor in parts[1:]:
            product = _product(product, factor)
        return product
    if op == "pow":
        if node.args[1].mask & bit:
            return _function("exp", _product(parts[1], _function("log", parts[0])))
        return _power(parts[0], node.args[1])
    if op == "if":
        return parts[0]
    if len(parts) == 1:
        return _function(op, parts[0])
    raise NotAnalyticError(op)


# coefficients


def is_zero(c: Coefficient) -> bool:
    """True where a coefficient is identically zero."""
    if isinstance(c, Expression):
        return vanishes(c)
    return c == 0 if isinstance(c, Fraction) else abs(c) < 1e-14


def plus(a: Coefficient, b: Coefficient) -> Coefficient:
    """a + b"""
    if isinstance(a, Expression) or isinstance(b, Expression):
        return _plain(add(as_expression(a), as_expression(b)))
    return a + b


def times(a: Coefficient, b: Coefficient) -> Coefficient:
    """a b"""
    if isinstance(a, Expression) or isinstance(b, Expression):
        return _plain(mul(as_expression(a), as_expression(b)))
    return a * b


def over(a: Coefficient, b: Coefficient) -> Coefficient:
    """a / b"""
    if isinstance(a, Expression) or isinstance(b, Expression):
        return _plain(mul(as_expression(a), reciprocal(as_expression(b))))
    return a / b


def reciprocal(node: Expression) -> Expression:
    """1/node, factor by factor, so that it cancels against a product's factors."""
    if node.op == "mul":
        return mul(*(reciprocal(factor) for factor in node.args))
    if node.op == "pow" and node.args[1].is_number:
        value = numeric_value(node.args[1])
        if isinstance(value, Fraction) and value.denominator == 1:
            return power(node.args[0], number(-value))
    return power(node, number(-1))


def _plain(node: Expression) -> Coefficient:
    return numeric_value(node) if node.is_number else node


def _dot(a: Sequence[Coefficient], b: Sequence[Coefficient]) -> Coefficient:
    """sum a_i b_i, as one flat sum."""
    exact: Number = Fraction(0)
    formulas = []
    for x, y in zip(a, b, strict=True):
        if not x or not y:
            continue
        product = times(x, y)
        if isinstance(product, Expression):
            formulas.append(product)
        else:
            exact = exact + product
    return _plain(add(*formulas, number(exact))) if formulas else exact


# arithmetic


def _sum(parts: Sequence[Series]) -> Series:
    start, end = min(p.start for p in parts), min(p.end for p in parts)
    ones = [Fraction(1)] * len(parts)
    sums = [_dot([p.at(k) for p in parts], ones) for k in range(start, end)]
    # (a + b) - (b + a): what cancels is found here once, so that it does not grow into every later term
    return Series(start, tuple(Fraction(0) if isinstance(c, Expression) and vanishes(c) else c for c in sums))


def _product(a: Series, b: Series) -> Series:
    x, y = a.terms, b.terms
    count = min(len(x), len(y))
    return Series(a.start + b.start, tuple(_dot(x[: k + 1], y[k::-1]) for k in range(count)))


def _scaled(c: Coefficient, a: Series) -> Series:
    return Series(a.start, tuple(times(c, term) for term in a.terms))


def _power(a: Series, exponent: Expression) -> Series:
    """a^e for an exponent that does not contain the variable."""
    e = numeric_value(exponent) if exponent.is_number else None
    whole = int(e) if isinstance(e, Fraction) and e.denominator == 1 else None
    if whole is not None and whole > 0:
        result = a
        for _ in range(whole - 1):
            result = _product(result, a)
        return result
    base = a.stripped()
    if not base.terms or (base.start != 0 and whole is None):
        raise NotAnalyticError("power of zero")
    first = base.terms[0]
    unit = [over(term, first) for term in base.terms]
    factor: Coefficient = _plain(power(as_expression(first), exponent))
    raised = _unit_power(unit, numeric_value(exponent) if exponent.is_number else exponent)
    return _scaled(factor, Series(base.start * whole if whole is not None else 0, raised))


def _unit_power(u: Sequence[Coefficient], e: Coefficient) -> tuple[Coefficient, ...]:
    """u^e where u[0] = 1, from u y' = e u' y."""
    y: list[Coefficient] = [Fraction(1)]
    present = [j for j, c in enumerate(u) if j > 0 and c]
    for k in range(1, len(u)):
        used = [j for j in present if j <= k and y[k - j]]
        weights = [plus(times(plus(e, Fraction(1)), Fraction(j, k)), Fraction(-1)) for j in used]
        y.append(_dot([times(w, u[j]) for w, j in zip(weights, used, strict=True)], [y[k - j] for j in used]))
    return tuple(y)


def _derivative(a: Series) -> list[Coefficient]:
    """Coefficients of da/dw for a Taylor series that starts at w^0."""
    return [times(Fraction(k), term) for k, term in enumerate(a.terms)][1:]


def _integrated(constant: Coefficient, slope: Series, count: int) -> Series:
    terms = [times(Fraction(1, k + 1), slope.at(k)) for k in range(min(count - 1, slope.end))]
    return Series(0, (constant, *terms))


# functions


def _function(name: str, argument: Series) -> Series:
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
    return _plain(call(name, as_expression(a.terms[0])))


def _exp(a: Series) -> Series:
    slope = _derivative(a)
    y: list[Coefficient] = [Fraction(1)]
    for k in range(1, len(a.terms)):
        y.append(times(Fraction(1, k), _dot(slope[:k], y[k - 1 :: -1])))
    return _scaled(_of_constant("exp", a), Series(0, tuple(y)))


def _expm1(a: Series) -> Series:
    return Series(0, (_of_constant("expm1", a), *_exp(a).terms[1:]))


def _pair(names: tuple[str, str], sign: int) -> tuple[Callable[[Series], Series], Callable[[Series], Series]]:
    """(sin, cos) with sign -1, (sinh, cosh) with sign 1: s' = c a', c' = sign s a'."""

    def both(a: Series) -> tuple[Series, Series, Coefficient, Coefficient]:
        slope = _derivative(a)
        s: list[Coefficient] = [Fraction(0)]
        c: list[Coefficient] = [Fraction(1)]
        for k in range(1, len(a.terms)):
            s_k = times(Fraction(1, k), _dot(slope[:k], c[k - 1 :: -1]))
            c_k = times(Fraction(sign, k), _dot(slope[:k], s[k - 1 :: -1]))
            s.append(s_k)
            c.append(c_k)
        return Series(0, tuple(s)), Series(0, tuple(c)), _of_constant(names[0], a), _of_constant(names[1], a)

    def odd(a: Series) -> Series:
        s, c, s0, c0 = both(a)
        return _sum([_scaled(s0, c), _scaled(c0, s)])

    def even(a: Series) -> Series:
        s, c, s0, c0 = both(a)
        return _sum([_scaled(c0, c), _scaled(times(Fraction(sign), s0), s)])

    return odd, even


def _ratio(name: str, odd: Callable[[Series], Series], even: Callable[[Series], Series]) -> Callable[[Series], Series]:
    def quotient(a: Series) -> Series:
        if is_zero(a.terms[0]):
            a = Series(0, (Fraction(0), *a.terms[1:]))
        return _product(odd(a), _power(even(a), number(-1)))

    return quotient


def _log(a: Series) -> Series:
    if is_zero(a.terms[0]):
        raise NotAnalyticError("log of zero")
    slope = Series(0, tuple(_derivative(a)))
    return _integrated(_of_constant("log", a), _product(slope, _power(a, number(-1))), len(a.terms))


def _log1p(a: Series) -> Series:
    shifted = Series(0, (plus(Fraction(1), a.terms[0]), *a.terms[1:]))
    return Series(0, (_of_constant("log1p", a), *_log(shifted).terms[1:]))


def _log10(a: Series) -> Series:
    scaled = _scaled(div(1, call("log", 10)), _log(a))
    return Series(0, (_of_constant("log10", a), *scaled.terms[1:]))


def _arc(name: str, sign: int, exponent: Fraction, factor: int) -> Callable[[Series], Series]:
    """asin, acos, atan: derivative factor (1 + sign a^2)^exponent a'."""

    def rule(a: Series) -> Series:
        square = _product(a, a)
        inner = Series(
            0, (plus(Fraction(1), times(Fraction(sign), square.terms[0])), *_scaled(Fraction(sign), square).terms[1:])
        )
        slope = _product(Series(0, tuple(_derivative(a))), _power(inner, number(exponent)))
        return _integrated(_of_constant(name, a), _scaled(Fraction(factor), slope), len(a.terms))

    return rule


def _sqrt(a: Series) -> Series:
    return _power(a, number(Fraction(1, 2)))


_sin, _cos = _pair(("sin", "cos"), -1)
_sinh, _cosh = _pair(("sinh", "cosh"), 1)
_RULES: Final[dict[str, Callable[[Series], Series]]] = {
    "exp": _exp,
    "expm1": _expm1,
    "sin": _sin,
    "cos": _cos,
    "sinh": _sinh,
    "cosh": _cosh,
    "tan": _ratio("tan", _sin, _cos),
    "tanh": _ratio("tanh", _sinh, _cosh),
    "log": _log,
    "log1p": _log1p,
    "log10": _log10,
    "sqrt": _sqrt,
    "asin": _arc("asin", -1, Fraction(-1, 2), 1),
    "acos": _arc("acos", -1, Fraction(-1, 2), -1),
    "atan": _arc("atan", 1, Fraction(-1), 1),
}
