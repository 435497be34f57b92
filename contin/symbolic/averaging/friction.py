"""Dry friction with its stick set: a slaved velocity V' = f - level sign(V), driven with f = Re(B e^{it}).

V sticks while |f| < level, where sign(V) stands for f/level (Filippov); then V' = 0, also in other equations that
contain f - level sign(V). Its steady motion and the first harmonic Re(S e^{it}) of sign(V) depend on
m = level/|B| alone. With S = (B/|B|) (s + i d):

    m >= 1            it sticks:                    s = 1/m, d = 0
    m_c < m < 1       it slips for u of each half turn from t_0 = -acos(m): tan(acos(m)) = (u - sin u)/(1 - cos u)
    m <= m_c          it slips all the time:        s = 2 m, d = -(4/pi) sqrt(1 - (pi m/2)^2)

with m_c = 1/sqrt(1 + pi^2/4) (J. P. Den Hartog, Trans. ASME 53 (1931) 107). The inverse of u -> (u - sin u)/(1 - cos u)
on (0, pi] has no closed form: u/T is a polynomial (in a fraction of T^2) that agrees with
it to rounding.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from typing import Final

import numpy as np

from contin.errors import InputError
from contin.machine import elementary
from contin.model.expression import (
    ONE,
    PI,
    ZERO,
    Expression,
    add,
    call,
    compare,
    div,
    if_,
    mask_of,
    mul,
    neg,
    number,
    power,
    sub,
    substitute,
    symbol,
)
from contin.model.parts import Limit, Oscillator
from contin.symbolic.averaging.complex_formulas import Complex, plus, times
from contin.symbolic.averaging.reading import short
from contin.symbolic.averaging.terms import additive_terms
from contin.symbolic.averaging.weak import Response

TWO: Final = number(2)
MOST: Final = 4.0 / math.pi**2  # (pi/2)^-2, scales T^2 to (0, 1)
BEND: Final = 1
DEGREE: Final = 18


@dataclass(frozen=True)
class Rubbing:
    """A velocity with dry friction: the response that stands for sign(V), and V itself in what turns."""

    response: Response
    velocity: Expression


def rubbing(
    name: str,
    equation: Expression,
    turning: Sequence[Oscillator],
    omega: Expression,
    small: str,
    symbols: tuple[str, str],
) -> Rubbing | None:
    """The slaved state `name` as a velocity with dry friction; None where its equation has no sign(V).

    symbols : names for sign(V) and its rate.

    Raises
    ------
    InputError
        The equation is not f - level sign(V) with f linear in oscillators of one frequency; in words.
    """
    places = {n: (j, k) for j, pair in enumerate(turning) for k, n in enumerate((pair.position, pair.velocity))}
    friction = call("sign", symbol(name))
    at_zero = substitute([equation], {symbol(small): ZERO})[0]
    terms = {t: c for c, t in additive_terms(at_zero, mask_of([name, *places]))}
    if friction not in terms:
        return None
    level = neg(terms.pop(friction))
    drive: dict[int, tuple[Expression, Expression]] = {}
    for t, c in terms.items():
        if t.op != "symbol" or str(t.value) not in places:
            raise InputError(
                f"averaging: the slaved state {name} with dry friction must have {name}' = f - mu*sign({name}) with f "
                f"linear in the oscillators; the term {short(mul(c, t))} does not fit"
            )
        j, k = places[str(t.value)]
        p, q = drive.get(j, (ZERO, ZERO))
        drive[j] = (add(p, c), q) if k == 0 else (p, add(q, c))
    harmonics = {turning[j].harmonic for j in drive}
    if len(harmonics) != 1:
        raise InputError(f"averaging: {name}, with dry friction, must be driven by oscillators of one frequency")
    (h,) = harmonics
    pair = Oscillator(*symbols, h)
    inverse = power(mul(number(h), omega), number(-2))
    parts = [mul(level, inverse, symbol(pair.velocity))]
    for j, (p, q) in drive.items():
        parts += [mul(number(-1), p, inverse, symbol(turning[j].velocity)), mul(q, symbol(turning[j].position))]
    return Rubbing(Response(pair, drive, level), add(*parts))


def response_amplitude(response: Response, amplitudes: Sequence[Complex], frequency: Expression) -> Complex:
    """S at the complex amplitudes of the oscillators (and phasors); `frequency` is theirs."""
    total: Complex = (ZERO, ZERO)
    for j, (p, q) in response.drive.items():
        total = plus(total, times((p, mul(q, frequency)), amplitudes[j]))
    size = call("sqrt", add(power(total[0], TWO), power(total[1], TWO)))
    m = div(response.level, size)
    s, d = _slipping(m)
    sliding = compare("<", m, number(1.0 / math.sqrt(1.0 + math.pi**2 / 4)))
    along, across = _stick_slip(m)
    s, d = if_(sliding, s, along), if_(sliding, d, across)
    slips = times((div(total[0], size), div(total[1], size)), (s, d))
    moves = compare(">", size, response.level)
    return (
        if_(moves, slips[0], div(total[0], response.level)),
        if_(moves, slips[1], div(total[1], response.level)),
    )


def response_limit(response: Response) -> Limit:
    """The level must be positive."""
    return Limit(response.level, "dry friction has a positive level: mu*sign(V) with mu > 0", 1e-13)


def _slipping(m: Expression) -> Complex:
    inside = sub(ONE, power(mul(number(0.5), PI, m), TWO))
    return mul(TWO, m), mul(number(-4), power(PI, number(-1)), call("sqrt", call("max", ZERO, inside)))


def _stick_slip(m: Expression) -> Complex:
    """(2/pi) (int_t0^t1 e^-it + int_t1^(t0 + pi) (cos t/m) e^-it), t0 = -acos m, t1 = t0 + u."""
    across = call("sqrt", call("max", ZERO, sub(ONE, power(m, TWO))))
    start = neg(call("acos", call("min", ONE, m)))
    u = _slip_angle(div(across, m))
    stop = add(start, u)
    c0, s0 = m, neg(across)  # cos and sin of t0
    c1, s1 = call("cos", stop), call("sin", stop)
    stuck = sub(PI, u)
    twice = (sub(mul(TWO, c0, c0), ONE), mul(TWO, s0, c0)), (sub(mul(TWO, c1, c1), ONE), mul(TWO, s1, c1))
    quarter = number(0.25)
    # int e^-it = [sin t + i cos t], int cos t e^-it = t/2 + [sin 2t + i cos 2t]/4
    real = add(sub(s1, s0), div(add(mul(number(0.5), stuck), mul(quarter, sub(twice[0][1], twice[1][1]))), m))
    imaginary = add(sub(c1, c0), div(mul(quarter, sub(twice[0][0], twice[1][0])), m))
    scale = mul(TWO, power(PI, number(-1)))
    return mul(scale, real), mul(scale, imaginary)


def _slip_angle(tangent: Expression) -> Expression:
    """u with (u - sin u)/(1 - cos u) = T, for 0 <= T <= pi/2."""
    square = mul(number(MOST), power(tangent, TWO))
    z = div(mul(number(1 + BEND), square), add(ONE, mul(number(BEND), square)))
    value: Expression = number(_coefficients()[-1])
    for c in _coefficients()[-2::-1]:
        value = add(number(c), mul(z, value))
    return mul(tangent, value)


@cache
def _coefficients() -> tuple[float, ...]:
    """Of the polynomial u/T in z = (1 + k) y/(1 + k y), y = (2 T/pi)^2.

    The fraction puts u's singularity, at y near -1/2, farther away.
    """
    nodes = 0.5 - 0.5 * elementary.cos((np.arange(DEGREE + 1) + 0.5) * math.pi / (DEGREE + 1))
    values = [_exact(float(z) / (1 + BEND - BEND * float(z))) for z in nodes]
    fitted = np.polynomial.Chebyshev.fit(nodes, values, DEGREE, domain=[0.0, 1.0])
    return tuple(float(c) for c in fitted.convert(kind=np.polynomial.Polynomial, domain=[-1, 1]).coef)


def _exact(y: float) -> float:
    """u/T at y by Newton's iteration in 40 digits."""
    import mpmath

    with mpmath.workdps(40):
        t = mpmath.pi / 2 * mpmath.sqrt(mpmath.mpf(y))
        u = mpmath.findroot(lambda u: (u - mpmath.sin(u)) / (1 - mpmath.cos(u)) - t, min(3 * t, 3))
        return float(u / t)
