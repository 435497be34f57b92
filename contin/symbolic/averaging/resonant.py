"""Averages of polynomials in the states of several oscillators: of the products of amplitudes, the resonant ones stay.

With z_j = A_j exp(i omega t), x_j = (z_j + conj z_j)/2 and y_j = i omega (z_j - conj z_j)/2, a product of amplitudes
times exp(-i omega t) has a mean only where it has one factor z more than factors conj z. With frequencies h_j omega,
where the powers m_j of z_j and n_j of conj z_j have sum h_j (m_j - n_j) = h, of the exp(-i h omega t) asked for.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import Union

from contin.model.expression import Expression, numeric_value

Exponent = Union[int, Fraction]  # halves occur in the polar form only: r^d with any integer d
Powers = tuple[tuple[Exponent, Exponent], ...]  # for each oscillator: the powers of A and of conj A
StatePowers = Mapping[tuple[int, bool], int]  # (oscillator, is it the velocity) -> exponent
Monomials = dict[Powers, tuple[Fraction, Fraction]]  # with a complex rational coefficient
DEGREE_LIMIT = 16


def state_powers(term: Expression, states: Mapping[str, tuple[int, bool]]) -> dict[tuple[int, bool], int] | None:
    """Exponents of a product of states {(oscillator, is it the velocity): exponent}; None if it is no such product."""
    found: dict[tuple[int, bool], int] = {}
    for factor in term.args if term.op == "mul" else (term,):
        base, exponent = factor, 1
        if factor.op == "pow" and factor.args[1].op == "number":
            value = numeric_value(factor.args[1])
            if not (isinstance(value, Fraction) and value.denominator == 1 and 0 < value <= DEGREE_LIMIT):
                return None
            base, exponent = factor.args[0], int(value)
        if base.op != "symbol" or str(base.value) not in states:
            return None
        key = states[str(base.value)]
        found[key] = found.get(key, 0) + exponent
    return found


def resonant_part(powers: StatePowers, harmonics: Sequence[int], target: int) -> tuple[Monomials, int]:
    """The mean of product * exp(-i target omega t) as products of amplitudes, without the factor omega^k; and k."""
    product: Monomials = {((0, 0),) * len(harmonics): (Fraction(1), Fraction(0))}
    half = Fraction(1, 2)
    omegas = 0
    for (i, is_velocity), exponent in powers.items():
        for _ in range(exponent):
            if is_velocity:  # i h (z - conj z)/2
                rate = half * harmonics[i]
                product = _times(product, i, (Fraction(0), rate), (Fraction(0), -rate))
                omegas += 1
            else:
                product = _times(product, i, (half, Fraction(0)), (half, Fraction(0)))
    kept = {
        p: c
        for p, c in product.items()
        if sum(h * (m - n) for h, (m, n) in zip(harmonics, p, strict=True)) == target and (c[0] or c[1])
    }
    return kept, omegas


def _times(
    product: Monomials, i: int, plain: tuple[Fraction, Fraction], conjugate: tuple[Fraction, Fraction]
) -> Monomials:
    result: Monomials = {}
    for powers, (a, b) in product.items():
        for (c, d), shift in ((plain, (1, 0)), (conjugate, (0, 1))):
            m, n = powers[i]
            key = (*powers[:i], (m + shift[0], n + shift[1]), *powers[i + 1 :])
            old = result.get(key, (Fraction(0), Fraction(0)))
            result[key] = (old[0] + a * c - b * d, old[1] + a * d + b * c)
    return result
