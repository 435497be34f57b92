"""Terms of second-order averages: sums of c * prod r_j^d_j exp(i n_j theta_j), c formulas in the parameters."""

from __future__ import annotations

import math
from collections import defaultdict
from dataclasses import dataclass
from fractions import Fraction
from typing import Final

from contin.errors import InputError
from contin.machine import elementary
from contin.model.expression import PI, ZERO, Expression, add, mul, number, power
from contin.model.printing import to_text
from contin.symbolic.averaging.amplitudes import AmplitudeEquation
from contin.symbolic.averaging.pulses import Pulse
from contin.symbolic.averaging.resonant import Exponent, Powers

Shape = tuple[tuple[int, int], ...]  # for each oscillator (d, n): r^d exp(i n theta)
Entry = tuple[Expression, complex]
ROUNDING: Final = 1e-13
NOT_SMOOTH: Final = "second-order averaging: the corrections are not smooth at zero amplitude; use the form polar"
LARGEST_DENOMINATOR: Final = 20000  # fractions with smaller ones are 2.5e-9 apart


@dataclass(frozen=True)
class Wave:
    """c * shape * exp(i k omega t): a term of a polynomial force."""

    coefficient: Expression
    number: complex
    shape: Shape
    k: int


Atom = Wave | Pulse
Sum = dict[Shape, list[Entry]]


def shifted(shape: Shape, j: int, d: int, n: int) -> Shape:
    old = shape[j]
    return (*shape[:j], (old[0] + d, old[1] + n), *shape[j + 1 :])


def product_of(a: Shape, b: Shape) -> Shape:
    return tuple((p[0] + q[0], p[1] + q[1]) for p, q in zip(a, b, strict=True))


def conjugate_of(shape: Shape) -> Shape:
    return tuple((d, -n) for d, n in shape)


def _half(value: int) -> Exponent:
    return Fraction(value, 2) if value % 2 else value // 2


def equation(total: Sum, polar: bool) -> AmplitudeEquation:
    products: dict[Powers, tuple[Expression, Expression]] = {}
    largest = max((abs(value) for terms in total.values() for _, value in terms), default=1.0)
    for shape, terms in total.items():
        powers = []
        for d, n in shape:
            if (d + n) % 2 and not polar:
                raise InputError(NOT_SMOOTH)
            powers.append((_half(d + n), _half(d - n)))
        parts = []
        for part in ("real", "imag"):
            summed: dict[Expression, float] = defaultdict(float)
            for coefficient, value in terms:
                summed[_in_order(coefficient)] += float(getattr(value, part))
            kept = {c: v for c, v in summed.items() if abs(v) > ROUNDING * largest}
            parts.append(add(*(mul(_constant(v), c) for c, v in kept.items())) if kept else ZERO)
        if parts != [ZERO, ZERO]:
            products[tuple(powers)] = (parts[0], parts[1])
    return AmplitudeEquation({}, products, ())


def _in_order(coefficient: Expression) -> Expression:
    """mu beta and beta mu are one coefficient."""
    if coefficient.op != "mul":
        return coefficient
    return mul(*sorted(coefficient.args, key=to_text))


def _constant(value: float) -> Expression:
    """p/q, p/(q pi) or p/(q pi^2) where the number is one to rounding: means of trigonometric polynomials are."""
    for k in range(3):
        scaled = value * elementary.pow(math.pi, k)
        guess = Fraction(scaled).limit_denominator(LARGEST_DENOMINATOR)
        if abs(float(guess) - scaled) <= 2e-15 * max(1.0, abs(scaled)):
            if k == 0:
                return number(guess)
            return mul(number(guess), power(PI, number(-k)))
    return number(value)
