"""How far averaged equations hold: the limits that their closed forms and quadratures presume, in the form's states."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from contin.model.expression import Expression, add, call, number, power, substitute
from contin.model.parts import Limit
from contin.symbolic.averaging.amplitudes import SlowSystem
from contin.symbolic.averaging.complex_formulas import Complex
from contin.symbolic.averaging.radial import R
from contin.symbolic.averaging.shared_average import shared_limit


def limits_of(system: SlowSystem, amplitudes: Sequence[Complex]) -> tuple[Limit, ...]:
    """Every limit once.

    amplitudes : the complex amplitudes in the form's states, up to a common phase.
    """
    found: dict[Expression, Limit] = {}
    for equation in system.equations:
        for j, average in equation.radial.items():
            for limit in average.limits:
                margin = substitute([limit.margin], {R: _modulus(amplitudes[j])})[0]
                found.setdefault(margin, replace(limit, margin=margin))
        for item in equation.general:
            limit = shared_limit(item.term, system.oscillators, system.setting, amplitudes)
            found.setdefault(limit.margin, limit)
    return tuple(found.values())


def _modulus(amplitude: Complex) -> Expression:
    u, v = amplitude
    if v.is_number and not v.value:
        return u
    return call("sqrt", add(power(u, number(2)), power(v, number(2))))
