"""Where the conditions in a function of one oscillator change sign: straight lines and circles of the (x, y) plane."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from contin.errors import InputError
from contin.model.evaluate import evaluate
from contin.model.expression import COMPARISONS, Expression, mask_of, postorder, sub
from contin.model.printing import to_text
from contin.records import Sympy
from contin.symbolic.calculus.guards import is_guard
from contin.symbolic.calculus.sympy_bridge import from_sympy, sympy_symbol, to_sympy

if TYPE_CHECKING:
    from types import ModuleType

X: Final = "@x"
Y: Final = "@y"
PLANE: Final = mask_of((X, Y))
"""Position and velocity of the oscillator in `one-oscillator functions`: no model can use these names."""


@dataclass(frozen=True)
class Line:
    """a x + b y + c = 0 with coefficients in the parameters, as sympy objects and as numbers for the default values."""

    a: Sympy
    b: Sympy
    c: Sympy
    numbers: tuple[float, float, float]


@dataclass(frozen=True)
class Circle:
    """x^2 + y^2/omega^2 = radius^2: the condition depends on the amplitude alone."""

    radius: Sympy
    number: float


def state_comparisons(function: Expression) -> list[Expression]:
    """The comparisons in a one-oscillator function that depend on x or y."""
    return [n for n in postorder([function]) if n.op in COMPARISONS and n.mask & PLANE and not is_guard(n)]


def switching_sets(
    function: Expression, omega: Expression, values: Mapping[str, float], positive: tuple[str, ...]
) -> tuple[list[Line], list[Circle]]:
    """The lines and circles on which a one-oscillator function may change its formula.

    Raises
    ------
    InputError
        A condition is no product of linear functions, of functions of x or y alone, or of the amplitude; quoted.
    """
    lines: dict[Sympy, Line] = {}
    circles: dict[Sympy, Circle] = {}
    for comparison in state_comparisons(function):
        found = _zero_set(sub(*comparison.args), omega, values, positive)
        if found is None:
            raise InputError(
                f"averaging: cannot locate where the condition {_in_words(comparison)} changes sign along a turn."
                " Conditions may be products of functions linear in the states, of polynomials in one state, and of "
                "functions of the amplitude"
            )
        for item in found:
            if isinstance(item, Line):
                lines.setdefault((item.a, item.b, item.c), item)
            else:
                circles.setdefault(item.radius, item)
    return list(lines.values()), list(circles.values())


def _in_words(comparison: Expression) -> str:
    return to_text(comparison).replace(X, "x").replace(Y, "y")


def _zero_set(
    function: Expression, omega: Expression, values: Mapping[str, float], positive: tuple[str, ...]
) -> list[Line | Circle] | None:
    import sympy

    x, y = sympy_symbol(X), sympy_symbol(Y)
    formula = to_sympy(function, positive)
    numerator, denominator = sympy.fraction(sympy.together(formula))
    if not numerator.is_polynomial(x, y) or not denominator.is_polynomial(x, y):
        return None
    found: list[Line | Circle] = []
    for side in (numerator, denominator):
        for factor, _ in sympy.factor_list(side)[1]:
            if not factor.has(x, y):
                continue
            sets = _factor_sets(sympy, factor, x, y, omega, values, positive)
            if sets is None:
                return None
            found += sets
    return found


def _factor_sets(
    sympy: ModuleType,
    factor: Sympy,
    x: Sympy,
    y: Sympy,
    omega: Expression,
    values: Mapping[str, float],
    positive: tuple[str, ...],
) -> list[Line | Circle] | None:
    poly = sympy.Poly(factor, x, y)
    if poly.total_degree() == 1:
        return [_line(sympy, poly.coeff_monomial(x), poly.coeff_monomial(y), poly.coeff_monomial(1), values)]
    if not factor.has(y) or not factor.has(x):
        only = x if factor.has(x) else y
        roots = _real_roots(sympy, factor, only, values)
        if roots is None:
            return None
        one, zero = sympy.Integer(1), sympy.Integer(0)
        return [_line(sympy, *((one, zero) if only is x else (zero, one)), -root, values) for root in roots]
    w = to_sympy(omega, positive)
    r = sympy.Symbol("r", positive=True)
    radial = sympy.expand(factor.subs(x, sympy.sqrt(r**2 - y**2 / w**2)))
    if not radial.has(y):
        roots = _real_roots(sympy, radial, r, values)
        return None if roots is None else [Circle(root, number_of(root, values)) for root in roots]
    if poly.is_homogeneous:
        slope = sympy.Symbol("slope", real=True)
        roots = _real_roots(sympy, sympy.expand(factor.subs(y, slope * x) / x ** poly.total_degree()), slope, values)
        if roots is not None:
            return [_line(sympy, root, sympy.Integer(-1), sympy.Integer(0), values) for root in roots]
    return None


def _real_roots(sympy: ModuleType, formula: Sympy, unknown: Sympy, values: Mapping[str, float]) -> list[Sympy] | None:
    """The roots that are real for the default parameters; None where they have no closed form."""
    poly = sympy.Poly(formula, unknown)
    if poly.degree() > 4:
        return None
    roots = sympy.roots(poly)
    if sum(roots.values()) < poly.degree():
        return None
    real = []
    for root in roots:
        value = complex(root.evalf(17, subs=_substitutions(root, values)))
        if abs(value.imag) <= 1e-12 * max(1.0, abs(value)) and (not unknown.is_positive or value.real > 0):
            real.append(root)
    return real


def _substitutions(formula: Sympy, values: Mapping[str, float]) -> dict[Sympy, float]:
    return {s: values[s.name] for s in formula.free_symbols}


def number_of(formula: Sympy, values: Mapping[str, float]) -> float:
    """Value of a sympy formula in the parameters."""
    return float(evaluate(from_sympy(formula), values))


def _line(sympy: ModuleType, a: Sympy, b: Sympy, c: Sympy, values: Mapping[str, float]) -> Line:
    if a != 0 and not a.free_symbols:  # x - c, whatever the sign it came with
        a, b, c = sympy.Integer(1), b / a, c / a
    elif a == 0 and not b.free_symbols:
        a, b, c = a, sympy.Integer(1), c / b
    numbers = tuple(number_of(part, values) for part in (a, b, c))
    if not all(math.isfinite(n) for n in numbers):
        raise InputError("averaging: a switching line is not finite for the default parameters")
    return Line(a, b, c, (numbers[0], numbers[1], numbers[2]))
