"""Closed forms as a person would write them: a few cheap rewritings of a sympy formula, and the shortest is taken."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from contin.records import Sympy

if TYPE_CHECKING:
    from types import ModuleType

LIMIT: Final = 400  # operations; longer formulas are only expanded


def tidy(value: object, variable: object) -> Sympy:
    """An equal formula with as few operations as cheap rewritings find.

    value : a sympy expression; nothing else is taken, least of all text, which sympy would evaluate.
    """
    import sympy

    if not isinstance(value, sympy.Expr):
        raise TypeError(f"tidy takes a sympy expression; got {type(value).__name__}")
    if value.is_Number or value.is_Symbol:
        return value
    expanded = sympy.expand(value)
    if expanded.is_polynomial(variable):
        return expanded
    candidates = [expanded]
    if sympy.count_ops(expanded) <= LIMIT:
        roots = _roots_together(sympy, expanded)
        candidates += [roots, sympy.factor_terms(expanded), sympy.factor_terms(roots)]
        candidates.append(sympy.collect(expanded, variable))
        if sympy.count_ops(expanded) <= 80:
            together = sympy.together(roots)
            candidates += [together, sympy.factor_terms(together)]
    return min(candidates, key=lambda c: (_weight(sympy, c), sympy.default_sort_key(c)))


def _roots_together(sympy: ModuleType, value: Sympy) -> Sympy:
    """sqrt(2) sqrt(a)/sqrt(b) as sqrt(2 a/b), term by term, and sqrt(r^2 - c^2)/r as sqrt(1 - c^2/r^2) stays."""
    terms = []
    for term in sympy.Add.make_args(value):
        inside, outside = [], []
        for factor in sympy.Mul.make_args(term):
            if factor.is_Pow and factor.exp in (sympy.Rational(1, 2), sympy.Rational(-1, 2)):
                inside.append(factor.base if factor.exp > 0 else 1 / factor.base)
            else:
                outside.append(factor)
        if len(inside) > 1:
            radicand = sympy.together(sympy.Mul(*inside))
            terms.append(sympy.Mul(*outside) * sympy.sqrt(radicand))
        else:
            terms.append(term)
    return sympy.Add(*terms)


def _weight(sympy: ModuleType, value: Sympy) -> int:
    return int(sympy.count_ops(value)) + 2 * sum(1 for _ in value.atoms(sympy.Pow))
