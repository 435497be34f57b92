"""Cartesian form: complex amplitudes A_i = u_i + i v_i, smooth at zero amplitude, with a circle symmetry.

Synchronous states rotate with a common rate: they are relative equilibria of this form. With forcing there is no such
symmetry: the frame turns with the forcing.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from contin.model.expression import (
    ONE,
    ZERO,
    Expression,
    add,
    call,
    compare,
    div,
    if_,
    mul,
    number,
    power,
    sub,
    symbol,
)
from contin.symbolic.averaging.amplitudes import SlowSystem
from contin.symbolic.averaging.complex_formulas import Complex, plus, times
from contin.symbolic.averaging.form_polar import phase_from_first, polar_names
from contin.symbolic.averaging.forms import (
    AveragedForm,
    general_parts,
    mean_rates,
    needs_frame,
    phasor_amplitudes,
    product_of,
    slow_words,
)
from contin.symbolic.averaging.squared_radius import rates_over_radius
from contin.symbolic.averaging.weak import WeakOscillators

ROTATION_RATE = "rotation_rate"


def cartesian_names(count: int) -> tuple[str, ...]:
    """u1, v1, u2, v2, ..."""
    return tuple(name for i in range(count) for name in (f"u{i + 1}", f"v{i + 1}"))


def cartesian_form(system: SlowSystem) -> AveragedForm:
    """u_i' and v_i' in slow time, and the rates of slow states."""
    oscillators = system.oscillators
    count = oscillators.count
    names = cartesian_names(count)
    own: list[Complex] = [(symbol(names[2 * i]), symbol(names[2 * i + 1])) for i in range(count)]
    squares = [add(power(u, number(2)), power(v, number(2))) for u, v in own]
    definitions = {f"R{i + 1}": square for i, square in enumerate(squares)}
    amplitudes = [*own, *phasor_amplitudes(oscillators)]
    sizes = [*squares, *(ONE for _ in oscillators.phasors)]
    equations: list[Expression] = []
    for i in range(count):
        total: Complex = (ZERO, ZERO)
        for powers, coefficient in system.equations[i].products.items():
            total = plus(total, product_of(powers, amplitudes, sizes, coefficient))
        for j in system.equations[i].radial:
            rate = rates_over_radius(system.rates(i, j), squares[j])
            suffix = f"{i + 1}" if i == j else f"{i + 1}{j + 1}"
            definitions |= {n + suffix: part for n, part in zip(("growth", "turn"), rate, strict=True) if part.args}
            total = plus(total, times(rate, amplitudes[j]))
        if needs_frame(system, i):
            total = plus(total, general_parts(system, i, amplitudes))
        equations += total
    means = mean_rates(system, amplitudes, sizes, lambda average, j: rates_over_radius(average, squares[j])[1])
    words = [f"{part} part of amplitude {i + 1}" for i in range(count) for part in ("real", "imaginary")]
    free = not oscillators.is_forced
    form = AveragedForm(
        "cartesian",
        (*names, *(s.name for s in oscillators.slow)),
        (*words, *slow_words(system)),
        (*equations, *means),
        _radii_and_phases(oscillators, own, squares),
        angles=tuple(s.name for s in oscillators.slow if s.turns),
        valid="smooth at zero amplitude" + ("; synchronous states rotate at a common rate" if free else ""),
        rotation=rotation(oscillators.harmonics[:count]) if free else {},
        rates=(ROTATION_RATE,) if free else (),
        definitions=definitions,
    )
    if not free:
        return form
    rate_of = _rate(equations, own, squares, oscillators.harmonics)
    return replace(form, observables={**form.observables, ROTATION_RATE: rate_of})


def _radii_and_phases(
    oscillators: WeakOscillators, amplitudes: Sequence[Complex], squares: Sequence[Expression]
) -> dict[str, Expression]:
    """r_i, and the phases of the polar form."""
    forced = oscillators.is_forced
    radii, phases = polar_names(oscillators.count, forced)
    observables: dict[str, Expression] = {
        name: call("sqrt", square) for name, square in zip(radii, squares, strict=True)
    }
    for j, name in enumerate(phases, start=0 if forced else 1):
        re, im = amplitudes[j] if forced else phase_from_first(oscillators, amplitudes, j)
        observables[name] = call("atan2", im, re)
    return observables


def _rate(
    equations: list[Expression], amplitudes: list[Complex], squares: list[Expression], harmonics: Sequence[int]
) -> Expression:
    """Mean rate of rotation sum h Im(conj A A')/sum h^2 |A|^2, 0 at rest."""
    motion = zip(amplitudes, equations[::2], equations[1::2], harmonics, strict=False)
    along = [mul(number(h), sub(mul(u, f_v), mul(v, f_u))) for (u, v), f_u, f_v, h in motion]
    total = add(*(mul(number(h * h), square) for h, square in zip(harmonics, squares, strict=False)))
    return if_(compare("==", total, ZERO), ZERO, div(add(*along), total))


def rotation(harmonics: Sequence[int]) -> dict[str, Expression]:
    """The generator of the circle symmetry: d/dchi of exp(i h chi) A at chi = 0."""
    names = cartesian_names(len(harmonics))
    turned: dict[str, Expression] = {}
    for u, v, h in zip(names[::2], names[1::2], harmonics, strict=True):
        turned |= {u: mul(number(-h), symbol(v)), v: mul(number(h), symbol(u))}
    return turned
