"""Two integrals of rational functions in closed form, by partial fractions of at most quadratic denominators."""

from __future__ import annotations

from typing import TYPE_CHECKING

from contin.records import Sympy

if TYPE_CHECKING:
    from types import ModuleType


def odd_integral(function: Sympy, u: Sympy) -> Sympy:
    """Antiderivative of a rational function of u with real logarithms and arc tangents, 0 at u = 0, or None.

    Logarithms appear as log(q(u)/q(0)), so that they stay real and exact near u = 0.
    """
    import sympy

    total: Sympy = sympy.Integer(0)
    even_top = sympy.cancel(function / u)
    v = sympy.Symbol("v", positive=True)
    if sympy.cancel(even_top - even_top.xreplace({u: -u})) == 0:  # odd: v = u^2
        inner = odd_integral(sympy.cancel(even_top.subs(u, sympy.sqrt(v)) / 2), v)
        return None if inner is None else inner.xreplace({v: u**2})
    for part in sympy.Add.make_args(sympy.apart(sympy.cancel(function), u)):
        value = _simple(sympy, part, u)
        if value is None:
            return None
        total += value
    return total


def _simple(sympy: ModuleType, part: Sympy, u: Sympy) -> Sympy:
    """One partial fraction."""
    if part.is_polynomial(u):
        antiderivative = sympy.integrate(part, u)
        return antiderivative - antiderivative.subs(u, 0)
    top, bottom = sympy.fraction(sympy.together(part))
    base, exponent = _base(sympy, bottom, u)
    poly = sympy.Poly(base, u)
    scale = sympy.cancel(bottom / base**exponent)
    top = sympy.cancel(top / scale)
    if poly.degree() == 1:
        slope, start = poly.coeff_monomial(u), poly.coeff_monomial(1)
        if start == 0 or top.has(u):
            return None
        if exponent == 1:
            return top / slope * sympy.log(1 + slope * u / start)
        return top / (slope * (1 - exponent)) * (base ** (1 - exponent) - start ** (1 - exponent))
    if poly.degree() != 2 or exponent != 1:
        return None
    a, b, c = (poly.coeff_monomial(u**k) for k in (2, 1, 0))
    if c == 0:
        return None
    line = sympy.Poly(top, u)
    p, q = line.coeff_monomial(u), line.coeff_monomial(1)
    rest = sympy.cancel(q - p * b / (2 * a))
    value = p / (2 * a) * sympy.log(sympy.expand(base / c)) if p != 0 else sympy.Integer(0)
    if rest != 0:
        square = sympy.factor(4 * a * c - b**2)
        if square.is_positive:
            root = sympy.sqrt(square)
            value += 2 * rest / root * (sympy.atan((2 * a * u + b) / root) - sympy.atan(b / root))
        elif square.is_negative and b == 0:
            ratio = sympy.sqrt(sympy.factor(-a / c))  # c (1 - (ratio u)^2)
            value += rest / (c * ratio) * (sympy.log(1 + ratio * u) - sympy.log(1 - ratio * u)) / 2
        else:
            return None
    return value


def _base(sympy: ModuleType, bottom: Sympy, u: Sympy) -> tuple[Sympy, int]:
    factors = [(f, e) for f, e in sympy.factor_list(bottom, u)[1] if f.has(u)]
    if len(factors) != 1:
        return bottom, 1
    return factors[0][0], int(factors[0][1])


def quarter_integral(function: Sympy, s: Sympy) -> Sympy:
    """Integral over phi = 0 ... pi/2 of a rational function of s = cos(phi)^2 (or sin^2); None if none is found.

    From the integral of 1/(1 + z s), pi/(2 sqrt(1 + z)), for real z > -1 and, in pairs, for complex z.
    """
    import sympy

    total: Sympy = sympy.Integer(0)
    for part in sympy.Add.make_args(sympy.apart(sympy.cancel(function), s)):
        if part.is_polynomial(s):
            for (k,), coefficient in sympy.Poly(part, s).terms():
                moment = sympy.binomial(2 * k, k) / sympy.Integer(4) ** k * sympy.pi / 2
                total += coefficient * moment
            continue
        value = _pole(sympy, part, s)
        if value is None:
            return None
        total += value
    return total


def _pole(sympy: ModuleType, part: Sympy, s: Sympy) -> Sympy:
    top, bottom = sympy.fraction(sympy.together(part))
    base, exponent = _base(sympy, bottom, s)
    scale = sympy.cancel(bottom / base**exponent)
    top = sympy.cancel(top / scale)
    poly = sympy.Poly(base, s)
    start = poly.coeff_monomial(1)
    if start == 0:
        return None
    if poly.degree() == 1 and not top.has(s):
        z = sympy.factor(poly.coeff_monomial(s) / start)
        t = sympy.Symbol("t", positive=True)
        value = sympy.pi / (2 * sympy.sqrt(t) * sympy.sqrt(t + z))  # of 1/(t + z s)
        for k in range(1, exponent):
            value = -sympy.diff(value, t) / k
        return sympy.factor_terms(top / start**exponent * value.subs(t, 1))
    if poly.degree() != 2 or exponent != 1:
        return None
    p, q = (sympy.factor(poly.coeff_monomial(s**k) / start) for k in (1, 2))
    line = sympy.Poly(top / start, s)
    alpha, beta = line.coeff_monomial(1), line.coeff_monomial(s)
    square = sympy.factor(q - p**2 / 4)
    if not square.is_positive:  # real poles that do not factor over the rationals
        return None
    real = 1 + p / 2
    squared = sympy.factor(1 + p + q)
    both = sympy.sqrt(squared) + real  # modulus and real part of 1 + z; sqrt(modulus - real) = sqrt(square/both)
    skew = sympy.factor(alpha * p / 2 - beta)
    value = alpha * sympy.sqrt(both / (2 * squared)) / 2
    if skew != 0:
        value -= skew / (2 * sympy.sqrt(2 * squared * both))
    return sympy.pi * value
