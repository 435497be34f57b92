"""How far averaged equations hold: the limits that their closed forms and quadratures presume, in the form's states."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

from contin.model.expression import Expression, add, call, number, power, substitute
from contin.model.parts import Limit
from contin.symbolic.averaging.amplitudes import General, SlowSystem
from contin.symbolic.averaging.complex_formulas import Complex
from contin.symbolic.averaging.radial import R
from contin.symbolic.averaging.shared_average import shared_limit


def limits_of(system: SlowSystem, amplitudes: Sequence[Complex]) -> tuple[Limit, ...]:
    """Every limit once.

    amplitudes : the complex amplitudes in the form's states, up to a common phase.
    """
    found: dict[Expression, Limit] = {}
    radial = [pair for equation in system.equations for pair in equation.radial.items()]
    radial += [pair for mean in system.means for pair in mean.radial]
    for j, average in radial:
        for limit in average.limits:
            margin = substitute([limit.margin], {R: _modulus(amplitudes[j])})[0]
            found.setdefault(margin, replace(limit, margin=margin))
    for harmonic, general in _general(system):
        for item in general:
            limit = shared_limit(item.term, system.oscillators, system.setting, amplitudes, harmonic)
            found.setdefault(limit.margin, limit)
    for limit in system.oscillators.limits:
        found.setdefault(limit.margin, limit)
    return tuple(found.values())


def _general(system: SlowSystem) -> Iterator[tuple[int, Sequence[General]]]:
    """What is averaged by shared rules, with the harmonic that it is averaged against."""
    for equation, harmonic in zip(system.equations, system.oscillators.harmonics, strict=False):
        yield harmonic, equation.general
    for mean in system.means:
        yield 0, mean.general


def _modulus(amplitude: Complex) -> Expression:
    u, v = amplitude
    if v.is_number and not v.value:
        return u
    return call("sqrt", add(power(u, number(2)), power(v, number(2))))
