"""Quotients whose numerator and denominator vanish together, made computable where they do.

u/(1 - exp(-u)) at u = 0 is 0/0, and near 0 its derivatives lose all digits: the third is off by 1e9 at u = 1e-6. The
pass replaces such a quotient by a conditional that takes a Taylor polynomial near the zero, before anything is
differentiated. Sums of poles that cancel (coth(x) - 1/x) are treated alike; quotients of polynomials are divided out.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from fractions import Fraction
from functools import reduce
from operator import or_
from typing import Final

from contin.model.expression import Expression, add, if_, mul, numeric_value, postorder, rebuild, symbols_in
from contin.symbolic.calculus.arguments import regular_in_argument
from contin.symbolic.calculus.centres import LARGEST, LOCAL, Centre, centres
from contin.symbolic.calculus.polynomials import polynomial_quotient
from contin.symbolic.calculus.roots import regular_root
from contin.symbolic.calculus.series import expand
from contin.symbolic.calculus.series_arithmetic import NotAnalyticError, is_zero
from contin.symbolic.calculus.signs import is_positive
from contin.symbolic.calculus.taylor import taylor_near_zero

GROWTH: Final = 4  # times the cost of a quotient (nodes, in the derivative by each of its symbols), and
WORTH: Final = 5000  # the cost that a formula in its place may have: one of many symbols multiplied out is beyond it


def remove_singularities(expressions: Iterable[Expression]) -> list[Expression]:
    """The same functions, computable to about 1e-10 with derivatives 1 to 3 at and near removable singularities.

    Found are zeros of denominators in a formula w that is affine in a symbol (with formulas as coefficients) or that
    stands in numerator and denominator as it is; poles are left alone, and so is every formula without such a quotient:
    it stays the identical node. The conditions that this adds are guards, not switchings (`calculus.guards`).
    """
    roots = list(expressions)
    done: dict[Expression, Expression] = {}
    for node in postorder(roots):
        new = rebuild(node, tuple(done[a] for a in node.args)) if node.args else node
        if new.op == "mul":
            new = _regular_product(new)
        elif new.op == "add":
            new = _regular_sum(new)
        elif new.op == "sqrt":
            new = regular_root(new)
        done[node] = new
    return [done[root] for root in roots]


def _regular_product(product: Expression) -> Expression:
    """The product with each removable quotient among its factors replaced."""
    factors = product.args if product.op == "mul" else (product,)
    bottoms = [f for f in factors if _denominator(f) is not None]
    tops = [f for f in factors if f.mask and _denominator(f) is None]
    if any(top.mask & bottom.mask for top in tops for bottom in bottoms):
        found = regular_in_argument(product)
        if found is not None:
            return _regular_product(found) if found.op == "mul" else found
    for bottom in bottoms:
        base = bottom.args[0]
        partners = [top for top in tops if top.mask & base.mask]
        for centre in centres(base, partners) if partners else ():
            part = _vanishing_factors(bottom, partners, bottoms, centre)
            smooth = _smooth(mul(*part), centre) if part else None
            if smooth is not None:
                return _regular_product(mul(*(f for f in factors if f not in part), smooth))
    return product


def _vanishing_factors(
    bottom: Expression, tops: Sequence[Expression], bottoms: Sequence[Expression], centre: Centre
) -> list[Expression]:
    """The factors that are zero or infinite at the centre, if `bottom` is one and some factor of `tops` is another."""
    if not _is_zero_at(bottom.args[0], centre):
        return []
    zeros = [top for top in tops if _is_zero_at(top, centre)]
    return [*zeros, *(b for b in bottoms if b is bottom or _is_zero_at(b.args[0], centre))] if zeros else []


def _regular_sum(total: Expression) -> Expression:
    """The sum with each group of poles that cancel replaced."""
    poles = [term for term in total.args if any(_denominator(f) is not None for f in _factors(term))]
    if len(poles) < 2:
        return total
    within = {pole: set(postorder([pole])) for pole in poles}
    for pole in poles:
        for bottom in _factors(pole):
            base = _denominator(bottom)
            partners = [t for t in poles if t is not pole and base is not None and t.mask & base.mask]
            if base is None or not partners:
                continue
            shared = reduce(or_, (t.mask for t in partners))
            for centre in centres(base, (), shared):  # its own formulas: each of the poles has its turn
                near = [t for t in poles if centre.replaced in within[t]] if _is_zero_at(base, centre) else []
                group = [term for term in near if _is_pole_at(term, centre)] if len(near) > 1 else []
                smooth = _smooth(add(*group), centre) if len(group) > 1 else None
                if smooth is not None:
                    return add(*(t for t in total.args if t not in group), smooth)
    return total


def _smooth(part: Expression, centre: Centre) -> Expression | None:
    """`part` with its singularity at the centre removed, or None if it is a pole or not analytic there."""
    (local,) = centre.local([part])
    size = len(postorder([local]))
    if size > LARGEST:
        return None
    try:
        exact = polynomial_quotient(local, centre.w)
        found = taylor_near_zero(local, centre.w) if exact is None else None
    except (NotAnalyticError, OverflowError):
        return None
    smooth = exact if exact is not None else None if found is None else if_(found[0], found[1], part)
    if smooth is None:
        return None
    cost = len(postorder([smooth])) * len(symbols_in([smooth]))
    return smooth if cost <= max(WORTH, GROWTH * size * len(symbols_in([part]))) else None


def _factors(term: Expression) -> tuple[Expression, ...]:
    return term.args if term.op == "mul" else (term,)


def _denominator(factor: Expression) -> Expression | None:
    """The base of a negative integer power that depends on something and might vanish."""
    if factor.op != "pow" or not factor.args[0].mask or not factor.args[1].is_number:
        return None
    exponent = numeric_value(factor.args[1])
    is_integer = isinstance(exponent, Fraction) and exponent.denominator == 1
    return factor.args[0] if is_integer and exponent < 0 and not is_positive(factor.args[0]) else None


def _is_zero_at(expression: Expression, centre: Centre) -> bool:
    try:
        series = expand(centre.local([expression])[0], LOCAL, 4)
    except NotAnalyticError:
        return False
    return series.end > 0 and all(is_zero(series.at(k)) for k in range(min(series.start, 0), 1))


def _is_pole_at(expression: Expression, centre: Centre) -> bool:
    try:
        series = expand(centre.local([expression])[0], LOCAL, 6).stripped()
    except NotAnalyticError:
        return False
    return series.start < 0 and bool(series.terms)
