"""Cartesian form: complex amplitudes A_i = u_i + i v_i, smooth at zero amplitude, with a circle symmetry.

Synchronous states rotate with a common rate: they are relative equilibria of this form.
"""

from __future__ import annotations

from contin.model.expression import ZERO, Expression, add, call, mul, neg, number, power, sub, symbol
from contin.symbolic.amplitudes import SlowSystem
from contin.symbolic.complex_formulas import Complex, conjugate, plus, times, to_power
from contin.symbolic.form_polar import polar_names
from contin.symbolic.forms import AveragedForm, general_parts
from contin.symbolic.squared_radius import rates_over_radius


def cartesian_names(count: int) -> tuple[str, ...]:
    """u1, v1, u2, v2, ..."""
    return tuple(name for i in range(count) for name in (f"u{i + 1}", f"v{i + 1}"))


def cartesian_form(system: SlowSystem) -> AveragedForm:
    """u_i' and v_i' in slow time."""
    count = system.oscillators.count
    names = cartesian_names(count)
    amplitudes: list[Complex] = [(symbol(names[2 * i]), symbol(names[2 * i + 1])) for i in range(count)]
    squares = [add(power(u, number(2)), power(v, number(2))) for u, v in amplitudes]
    equations: list[Expression] = []
    for i in range(count):
        total: Complex = (ZERO, ZERO)
        for powers, coefficient in system.equations[i].products.items():
            product = coefficient
            for a, (m, n) in zip(amplitudes, powers, strict=True):
                product = _product(product, a, m, n)
            total = plus(total, product)
        for j in system.equations[i].radial:
            rate = rates_over_radius(system.rates(i, j), squares[j])
            total = plus(total, times(rate, amplitudes[j]))
        if system.equations[i].general:
            total = plus(total, general_parts(system, i, amplitudes))
        equations += total
    radii, phases = polar_names(count)
    observables = {name: call("sqrt", square) for name, square in zip(radii, squares, strict=True)}
    for j, name in enumerate(phases, start=1):
        re, im = times(amplitudes[j], conjugate(amplitudes[0]))
        observables[name] = call("atan2", im, re)
    words = [f"{part} part of the amplitude of oscillator {i + 1}" for i in range(count) for part in ("real", "imaginary")]
    valid = "smooth at zero amplitude; synchronous states rotate at a common rate"
    return AveragedForm("cartesian", names, tuple(words), tuple(equations), observables, (), valid)


def _product(start: Complex, a: Complex, m: int, n: int) -> Complex:
    """start * a^m * conj(a)^n, with |a|^2 kept as one factor."""
    common = min(m, n)
    if common:
        square = power(add(power(a[0], number(2)), power(a[1], number(2))), number(common))
        start = (mul(start[0], square), mul(start[1], square))
    if m > common:
        start = times(start, to_power(a, m - common))
    elif n > common:
        start = times(start, to_power(conjugate(a), n - common))
    return start


def rotation(count: int) -> list[Expression]:
    """The generator of the circle symmetry: d/dchi of exp(i chi) A at chi = 0."""
    names = cartesian_names(count)
    return [part for i in range(count) for part in (neg(symbol(names[2 * i + 1])), sub(symbol(names[2 * i]), ZERO))]
