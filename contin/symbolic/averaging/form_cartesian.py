"""Cartesian form: complex amplitudes A_i = u_i + i v_i, smooth at zero amplitude, with a circle symmetry.

Synchronous states rotate with a common rate: they are relative equilibria of this form.
"""

from __future__ import annotations

from dataclasses import replace

from contin.model.expression import ZERO, Expression, add, call, compare, div, if_, mul, neg, number, power, sub, symbol
from contin.symbolic.averaging.amplitudes import SlowSystem
from contin.symbolic.averaging.complex_formulas import Complex, conjugate, plus, times, to_power
from contin.symbolic.averaging.form_polar import polar_names
from contin.symbolic.averaging.forms import AveragedForm, general_parts
from contin.symbolic.averaging.squared_radius import rates_over_radius

ROTATION_RATE = "rotation_rate"


def cartesian_names(count: int) -> tuple[str, ...]:
    """u1, v1, u2, v2, ..."""
    return tuple(name for i in range(count) for name in (f"u{i + 1}", f"v{i + 1}"))


def cartesian_form(system: SlowSystem) -> AveragedForm:
    """u_i' and v_i' in slow time."""
    count = system.oscillators.count
    names = cartesian_names(count)
    amplitudes: list[Complex] = [(symbol(names[2 * i]), symbol(names[2 * i + 1])) for i in range(count)]
    squares = [add(power(u, number(2)), power(v, number(2))) for u, v in amplitudes]
    definitions = {f"R{i + 1}": square for i, square in enumerate(squares)}
    equations: list[Expression] = []
    for i in range(count):
        total: Complex = (ZERO, ZERO)
        for powers, coefficient in system.equations[i].products.items():
            product = coefficient
            for a, (m, n) in zip(amplitudes, powers, strict=True):
                product = _product(product, a, int(m), int(n))
            total = plus(total, product)
        for j in system.equations[i].radial:
            rate = rates_over_radius(system.rates(i, j), squares[j])
            suffix = f"{i + 1}" if i == j else f"{i + 1}{j + 1}"
            definitions |= {n + suffix: part for n, part in zip(("growth", "turn"), rate, strict=True) if part.args}
            total = plus(total, times(rate, amplitudes[j]))
        if system.equations[i].general:
            total = plus(total, general_parts(system, i, amplitudes))
        equations += total
    radii, phases = polar_names(count)
    observables = {name: call("sqrt", square) for name, square in zip(radii, squares, strict=True)}
    for j, name in enumerate(phases, start=1):
        re, im = times(amplitudes[j], conjugate(amplitudes[0]))
        observables[name] = call("atan2", im, re)
    words = [f"{part} part of amplitude {i + 1}" for i in range(count) for part in ("real", "imaginary")]
    valid = "smooth at zero amplitude; synchronous states rotate at a common rate"
    form = AveragedForm(
        "cartesian",
        names,
        tuple(words),
        tuple(equations),
        observables,
        valid=valid,
        rotation=rotation(count),
        rates=(ROTATION_RATE,),
        definitions=definitions,
    )
    return replace(form, observables={**observables, ROTATION_RATE: _rate(equations, amplitudes, squares)})


def _rate(equations: list[Expression], amplitudes: list[Complex], squares: list[Expression]) -> Expression:
    """Mean rate of rotation sum Im(conj A A')/sum |A|^2, 0 at rest."""
    motion = zip(amplitudes, equations[::2], equations[1::2], strict=True)
    along = [sub(mul(u, f_v), mul(v, f_u)) for (u, v), f_u, f_v in motion]
    total = add(*squares)
    return if_(compare("==", total, ZERO), ZERO, div(add(*along), total))


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


def rotation(count: int) -> dict[str, Expression]:
    """The generator of the circle symmetry: d/dchi of exp(i chi) A at chi = 0."""
    names = cartesian_names(count)
    turned: dict[str, Expression] = {}
    for u, v in zip(names[::2], names[1::2], strict=True):
        turned |= {u: neg(symbol(v)), v: symbol(u)}
    return turned
