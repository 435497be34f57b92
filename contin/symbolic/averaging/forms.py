"""The averaged equations in the three forms: names of the states, their equations, and the user's r1, r2, psi."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Final

from contin.errors import InputError
from contin.model.advice import closest
from contin.model.expression import ZERO, Expression, mul, number, power
from contin.symbolic.averaging.amplitudes import SlowSystem
from contin.symbolic.averaging.complex_formulas import Complex, plus
from contin.symbolic.averaging.shared_average import shared_average

FORMS: Final = ("polar", "cartesian", "stokes")


@dataclass(frozen=True)
class AveragedForm:
    """Equations of one form, and how points of the phase plane translate into its states.

    `valid` says in words where the equations hold; `angles` are the states that are angles.
    """

    name: str
    states: tuple[str, ...]
    descriptions: tuple[str, ...]
    equations: tuple[Expression, ...]
    observables: Mapping[str, Expression] = field(default_factory=dict)
    angles: tuple[str, ...] = ()
    valid: str = ""
    rotation: Mapping[str, Expression] = field(default_factory=dict)
    amplitudes: tuple[str, ...] = ()  # states that must not be negative
    beyond: str | None = None  # what to say where one of them reaches 0
    rates: tuple[str, ...] = ()  # observables that are linear in the equations
    definitions: Mapping[str, Expression] = field(default_factory=dict)



def check_form(name: object, count: int) -> str:
    """A form's name, checked against the number of oscillators."""
    if not isinstance(name, str) or name not in FORMS:
        advice = closest(str(name), FORMS) or f"there are {', '.join(FORMS)}"
        raise InputError(f"averaging has no form {name!r}: {advice}")
    if name == "stokes" and count != 2:
        raise InputError(f"the form stokes is for two oscillators, and there are {count}; use polar or cartesian")
    return name


def general_parts(system: SlowSystem, i: int, amplitudes: Sequence[Complex]) -> Complex:
    """Real and imaginary part of the contributions to A_i' that are averaged by quadrature."""
    total: Complex = (ZERO, ZERO)
    for item in system.equations[i].general:
        re, im = shared_average(item.term, system.oscillators, system.setting, amplitudes)
        if item.is_force:  # -i/omega (re + i im)
            inverse = power(system.omega, number(-1))
            re, im = mul(inverse, im), mul(number(-1), inverse, re)
        total = plus(total, (mul(item.coefficient, re), mul(item.coefficient, im)))
    return total
