"""Closed forms of integrals over arcs of x = r cos(phi), y = -omega r sin(phi): polynomials and rational functions.

Every rule is a formula of fixed cost, so what has a closed form here does not depend on the speed of a machine. What
fits no rule gives None, and the caller writes a quadrature.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

from contin.records import Sympy
from contin.symbolic.averaging.cells import Arc, Cut
from contin.symbolic.averaging.rational_integrals import odd_integral, quarter_integral


def trig_integral(formula: Sympy, x: Sympy, y: Sympy, r: Sympy, omega: Sympy, arcs: Sequence[Arc]) -> Sympy:
    """(integral of f sin(phi), integral of f cos(phi)) over the arcs, or None without a closed form."""
    if formula.is_polynomial(x, y):
        return _polynomial(formula, x, y, r, omega, arcs)
    if formula.is_rational_function(x, y):
        return _rational(formula, x, y, r, omega, arcs)
    return None


def _polynomial(formula: Sympy, x: Sympy, y: Sympy, r: Sympy, omega: Sympy, arcs: Sequence[Arc]) -> Sympy:
    import sympy

    with_sin, with_cos = [], []
    for (m, n), coefficient in sympy.Poly(formula, x, y).terms():
        scale = coefficient * r ** (m + n) * (-omega) ** n
        with_sin.append(scale * power_integral(m, n + 1, arcs))
        with_cos.append(scale * power_integral(m + 1, n, arcs))
    return sympy.Add(*with_sin), sympy.Add(*with_cos)


def power_integral(m: int, n: int, arcs: Sequence[Arc]) -> Sympy:
    """Integral of cos^m sin^n over the arcs."""
    import sympy

    return sympy.Add(*(_at(m, n, arc.stop) - _at(m, n, arc.start) for arc in arcs))


def _at(m: int, n: int, cut: Cut) -> Sympy:
    import sympy

    cos, sin, phi = _names()
    value = _antiderivative(m, n).xreplace({cos: cut.cos, sin: cut.sin, phi: cut.phi})
    return value if cut.exact else sympy.expand(value)


def _names() -> tuple[Sympy, Sympy, Sympy]:
    import sympy

    cos, sin, phi = sympy.symbols("cos sin phi", real=True)
    return cos, sin, phi


@lru_cache(maxsize=2000)
def _antiderivative(m: int, n: int) -> Sympy:
    """Of cos^m sin^n, as a polynomial in cos, sin and phi."""
    import sympy

    cos, sin, phi = _names()
    if n % 2:  # u = cos, du = -sin dphi
        return -sympy.integrate(sympy.expand(cos**m * (1 - cos**2) ** ((n - 1) // 2)), cos)
    if m % 2:
        return sympy.integrate(sympy.expand(sin**n * (1 - sin**2) ** ((m - 1) // 2)), sin)
    if n:
        reduced = sympy.Rational(n - 1, m + n) * _antiderivative(m, n - 2)
        return -(sin ** (n - 1)) * cos ** (m + 1) / (m + n) + reduced
    if m:
        return cos ** (m - 1) * sin / m + sympy.Rational(m - 1, m) * _antiderivative(m - 2, 0)
    return phi


def _rational(formula: Sympy, x: Sympy, y: Sympy, r: Sympy, omega: Sympy, arcs: Sequence[Arc]) -> Sympy:
    """f = q(x) y^n or q(y) x^n: integrals in cos or sin, or over whole quarters in cos^2."""
    import sympy

    numerator, denominator = sympy.fraction(sympy.cancel(sympy.together(formula)))
    if denominator.has(x) and denominator.has(y):
        return None
    in_x = denominator.has(x)
    rational_in, power_of = (x, y) if in_x else (y, x)
    cos, sin, _ = _names()
    trig = {x: r * cos, y: -omega * r * sin}
    main, other = (cos, sin) if in_x else (sin, cos)
    totals = []
    for weight in (sin, cos):
        total: Sympy = sympy.Integer(0)
        for (n,), coefficient in sympy.Poly(numerator, power_of).terms():
            quotient = (coefficient / denominator).xreplace({rational_in: trig[rational_in]})
            factor = trig[power_of] ** n * weight
            power = sympy.degree(factor, other) if factor.has(other) else 0
            quotient *= factor.xreplace({other: sympy.Integer(1)})
            value = _one(quotient, power, main, other, arcs, in_x)
            if value is None:
                return None
            total += value
        totals.append(total)
    return totals[0], totals[1]


def _one(quotient: Sympy, power: int, main: Sympy, other: Sympy, arcs: Sequence[Arc], main_is_cos: bool) -> Sympy:
    """Integral of quotient(main) * other^power over the arcs."""
    import sympy

    if power % 2:  # d main = -+ other dphi
        sign = -1 if main_is_cos else 1
        inner = sympy.cancel(quotient * (1 - main**2) ** ((power - 1) // 2))
        antiderivative = odd_integral(inner, main)
        if antiderivative is None:
            return None
        return sign * sympy.Add(*(_between(antiderivative, main, arc, main_is_cos) for arc in arcs))
    inner = sympy.cancel(quotient * (1 - main**2) ** (power // 2))
    flipped = sympy.cancel(inner.xreplace({main: -main}))
    if sympy.cancel(flipped + inner) == 0:  # odd in main: d other = +- main dphi
        sign = 1 if main_is_cos else -1
        in_other = sympy.cancel(sympy.cancel(inner / main).subs(main, sympy.sqrt(1 - other**2)))
        antiderivative = odd_integral(in_other, other)
        if antiderivative is None:
            return None
        return sign * sympy.Add(*(_between(antiderivative, other, arc, not main_is_cos) for arc in arcs))
    if sympy.cancel(flipped - inner) != 0 or not all(arc.start.exact and arc.stop.exact for arc in arcs):
        return None
    s = sympy.Symbol("s", positive=True)
    one = quarter_integral(sympy.cancel(inner.subs(main, sympy.sqrt(s))), s)
    quarters = sum(round((arc.stop.number - arc.start.number) / 1.5707963267948966) for arc in arcs)
    return None if one is None else quarters * one


def _between(antiderivative: Sympy, variable: Sympy, arc: Arc, is_cos: bool) -> Sympy:
    ends = [(cut.cos if is_cos else cut.sin) for cut in (arc.start, arc.stop)]
    return antiderivative.xreplace({variable: ends[1]}) - antiderivative.xreplace({variable: ends[0]})
