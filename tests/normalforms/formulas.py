"""Jets of systems written as formulas: Taylor coefficients by sympy at a point given in high precision."""

from __future__ import annotations

from math import factorial

import mpmath
import sympy

from .polynomials import PolynomialJet, exponents


def taylor_jet(states, active, formulas, at, *, order=3, kind="flow", **values) -> PolynomialJet:
    """The jet of u' = formulas at the point `at` {name: value}, with the parameters `active` (formulas in `values`)."""
    names = [*states, *active]
    symbols = sympy.symbols(names)
    local = dict(zip(names, symbols, strict=True))
    point = {s: sympy.Float(mpmath.nstr(mpmath.mpf(at[s.name]), 40), 40) for s in symbols}
    constants = {sympy.Symbol(k): sympy.Float(mpmath.nstr(mpmath.mpf(v), 40), 40) for k, v in values.items()}
    field = []
    for text in formulas:
        f = sympy.sympify(text, locals=local).subs(constants)
        series = {}
        for e in exponents(len(names), 1, order):
            d = f
            for s, m in zip(symbols, e, strict=True):
                d = sympy.diff(d, s, m) if m else d
            c = d.subs(point)
            for m in e:
                c = c / factorial(m)
            if c != 0:
                series[e] = float(c)
        field.append(series)
    return PolynomialJet(field, len(active), kind)
