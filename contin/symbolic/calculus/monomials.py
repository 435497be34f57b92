"""Formulas multiplied out: sums of monomials in atoms, so that formulas that are equal as polynomials look alike.

Atoms are symbols, and whatever is no polynomial (a quotient's denominator, a function's value), known by its own parts
multiplied out. Quotients are not brought to a common denominator: x/(k + x) and 1 - k/(k + x) stay different.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from fractions import Fraction
from typing import Final

from contin.model.expression import Expression, Number, numeric_value, postorder

Monomial = tuple[tuple[int, Fraction], ...]  # (atom, exponent), atoms ascending
Terms = dict[Monomial, Fraction]

UNIT: Final[Monomial] = ()
MOST_TERMS: Final = 2_000  # a product of sums with more is left as it is
HIGHEST: Final = 12  # power of a sum that is multiplied out
EFFORT: Final = 200_000  # products of monomials in one expansion (some tenths of a second); beyond, sums are atoms


class Monomials:
    """Expansions of formulas with the same atoms; what has been expanded once is remembered."""

    def __init__(self) -> None:
        self._atoms: dict[object, int] = {}
        self._symbols: dict[int, str] = {}
        self._done: dict[Expression, Terms] = {}
        self._effort = 0

    def expand(self, formulas: Iterable[Expression]) -> list[Terms]:
        """Each formula as {monomial: coefficient}, without zeros."""
        roots = list(formulas)
        for node in postorder(roots):
            if node not in self._done:
                self._done[node] = self._terms(node)
        return [self._done[root] for root in roots]

    def symbol(self, atom: int) -> str | None:
        """The name of an atom that is a symbol."""
        return self._symbols.get(atom)

    def _terms(self, node: Expression) -> Terms:
        if node.op == "number":
            return self._constant(node, numeric_value(node))
        if node.op == "symbol":
            atom = self._atom(("symbol", node.value))
            self._symbols[atom] = str(node.value)
            return {((atom, Fraction(1)),): Fraction(1)}
        parts = [self._done[a] for a in node.args]
        if node.op == "add":
            return summed(parts)
        if node.op == "mul":
            product = {UNIT: Fraction(1)}
            for part in parts:
                both = self._product(product, part)
                if both is None:
                    return self._opaque(node)
                product = both
            return product
        if node.op == "pow":
            return self._power(node, *parts)
        return self._opaque(node)

    def _constant(self, node: Expression, value: Number) -> Terms:
        if isinstance(value, float) and not math.isfinite(value):
            return self._opaque(node)
        return {UNIT: Fraction(value)} if value else {}

    def _power(self, node: Expression, base: Terms, exponent: Terms) -> Terms:
        if any(m != UNIT for m in exponent) or not base:
            return self._opaque(node)
        e = exponent.get(UNIT, Fraction(0))
        whole = e.denominator == 1
        if len(base) == 1:
            ((monomial, coefficient),) = base.items()
            if whole:
                return {_raised(monomial, e): coefficient ** int(e)}
            return self._opaque(node)
        if whole and 0 < e <= HIGHEST:
            result: Terms | None = {UNIT: Fraction(1)}
            for _ in range(int(e)):
                result = None if result is None else self._product(result, base)
            if result is not None:
                return result
        common, scale, rest = _content(base)
        if not whole:
            return self._opaque(node)
        atom = self._atom(("sum", frozenset(rest.items())))
        outside = _raised(common, e)
        return {_times(outside, ((atom, e),)): scale ** int(e)}

    def _opaque(self, node: Expression) -> Terms:
        parts = tuple(frozenset(self._done[a].items()) for a in node.args)
        atom = self._atom((node.op, parts, node.value))
        return {((atom, Fraction(1)),): Fraction(1)}

    def _atom(self, key: object) -> int:
        return self._atoms.setdefault(key, len(self._atoms))

    def _product(self, a: Terms, b: Terms) -> Terms | None:
        self._effort += len(a) * len(b)
        if len(a) > 1 and len(b) > 1 and (len(a) * len(b) > MOST_TERMS or self._effort > EFFORT):
            return None
        found: Terms = {}
        for m, c in a.items():
            for n, d in b.items():
                key = _times(m, n)
                found[key] = found.get(key, Fraction(0)) + c * d
        return {m: c for m, c in found.items() if c}


def summed(parts: Iterable[Terms]) -> Terms:
    """The sum of expansions."""
    found: Terms = {}
    for part in parts:
        for m, c in part.items():
            found[m] = found.get(m, Fraction(0)) + c
    return {m: c for m, c in found.items() if c}


def _times(a: Monomial, b: Monomial) -> Monomial:
    if not a or not b:
        return a or b
    powers = dict(a)
    for atom, e in b:
        powers[atom] = powers.get(atom, Fraction(0)) + e
    return tuple(sorted((atom, e) for atom, e in powers.items() if e))


def _raised(m: Monomial, e: Fraction) -> Monomial:
    return tuple((atom, f * e) for atom, f in m if f * e)


def _content(terms: Terms) -> tuple[Monomial, Fraction, Terms]:
    """(common monomial, coefficient of the first term, rest): terms = coefficient * monomial * rest."""
    common = dict(next(iter(terms)))
    for m in terms:
        powers = dict(m)
        common = {atom: min(e, powers.get(atom, Fraction(0))) for atom, e in common.items()} | {
            atom: min(e, Fraction(0)) for atom, e in powers.items() if atom not in common
        }
    shared: Monomial = tuple(sorted((atom, e) for atom, e in common.items() if e))
    inverse = _raised(shared, Fraction(-1))
    reduced = {_times(m, inverse): c for m, c in terms.items()}
    scale = reduced[min(reduced)]
    return shared, scale, {m: c / scale for m, c in reduced.items()}


def common_monomial(terms: Terms) -> Monomial:
    """The largest monomial that divides every term (negative exponents where a term has them)."""
    return _content(terms)[0] if terms else UNIT


def divided(terms: Terms, by: Monomial) -> Terms:
    """terms / by"""
    inverse = _raised(by, Fraction(-1))
    return {_times(m, inverse): c for m, c in terms.items()}
