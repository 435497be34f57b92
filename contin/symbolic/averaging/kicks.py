"""Kicks: states that jump by order eps where a line in the plane of the oscillators is crossed (`events` of a model).

The line a.x + b.y + c = D cos(h tau - delta) + c = 0 is crossed upwards at h tau = delta - beta and downwards at
delta + beta, cos(beta) = -c/D, once a turn each where D > |c| and never where D < |c|. A kick x_i -> x_i + eps e_i,
y_i -> y_i + eps f_i at tau changes A_i by eps exp(-i h_i tau) (e_i - i f_i/w_i); a period 2 pi/omega has one such
crossing (h of them for lines of oscillators of harmonic h), so in slow time A_i' gets omega/(2 pi) times the sum.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final

from contin.errors import InputError
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
    mul,
    neg,
    number,
    power,
    sub,
    substitute,
    symbol,
)
from contin.model.parts import Event
from contin.model.printing import to_text
from contin.symbolic.averaging.complex_formulas import Complex, conjugate, plus, times, to_power
from contin.symbolic.averaging.piecewise_turn import Turn, linear_in_turning
from contin.symbolic.averaging.reading import is_zero, series
from contin.symbolic.averaging.weak import Kick, WeakOscillators

TWO: Final = number(2)


def kick_of(event: Event, jumps: Mapping[str, Expression], when: Expression, small: str, name: str) -> Kick:
    """An event of the model `name` as a kick; `when` and `jumps` are its formulas in phasors and without slaved states.

    Raises
    ------
    InputError
        A jump is not of order eps, or moves what the line is made of; in words.
    """
    changes = {}
    for state, image in jumps.items():
        at_zero = substitute([image], {symbol(small): ZERO})[0]
        if not is_zero(sub(at_zero, symbol(state))):
            raise InputError(
                f"averaging model {name}: the jump of {state} where {to_text(event.when)} crosses zero is not small: "
                f"at {small} = 0 it must leave {state} as it is. Write it as {state} + {small}*..., or "
                f"{state}*sqrt(1 + {small}*.../{state}^2) for a change of energy"
            )
        changes[state] = series(image, small, 1)[0]
        if when.mask & symbol(state).mask and not is_zero(changes[state]):
            raise InputError(
                f"averaging model {name}: the event where {to_text(event.when)} crosses zero moves {state}, so that it "
                "may happen again at once; let it happen on a line of other states"
            )
    return Kick(when, event.direction, changes)


@dataclass(frozen=True)
class Amplitudes:
    """Complex amplitudes of all that turns, with the moduli and the units A/|A| where the form has them."""

    amplitudes: Sequence[Complex]
    polar: Sequence[tuple[Expression, Complex]] = ()

    def modulus_and_unit(self, j: int) -> tuple[Expression, Complex]:
        """|A_j| and A_j/|A_j|"""
        if self.polar:
            return self.polar[j]
        u, v = self.amplitudes[j]
        size = call("sqrt", add(power(u, TWO), power(v, TWO)))
        return size, (div(u, size), div(v, size))


@dataclass(frozen=True)
class Crossings:
    """Where a kick happens: exp(i tau) of each instant, and the condition that it happens."""

    instants: tuple[Complex, ...]
    happens: Expression | None


def kick_rates(kick: Kick, i: int, oscillators: WeakOscillators, of: Amplitudes) -> Complex:
    """What the kick adds to A_i' in slow time."""
    pair = oscillators.pairs[i]
    position, velocity = (kick.changes.get(name, ZERO) for name in (pair.position, pair.velocity))
    if position is ZERO and velocity is ZERO:
        return ZERO, ZERO
    change: Complex = (position, neg(div(velocity, oscillators.frequency(i))))
    return _summed(kick, change, pair.harmonic, oscillators, of)


def kick_mean(kick: Kick, state: str, oscillators: WeakOscillators, of: Amplitudes) -> Expression:
    """What the kick adds to the rate of a slow state."""
    change = kick.changes.get(state, ZERO)
    if change is ZERO:
        return ZERO
    return _summed(kick, (change, ZERO), 0, oscillators, of)[0]


def _summed(kick: Kick, change: Complex, harmonic: int, oscillators: WeakOscillators, of: Amplitudes) -> Complex:
    turn = Turn(oscillators, oscillators.omega, dict(enumerate(of.amplitudes)))
    crossings = _crossings(kick, turn, of)
    total: Complex = (ZERO, ZERO)
    for unit in crossings.instants:
        value = (turn.at(change[0], *unit), turn.at(change[1], *unit))
        back = conjugate(to_power(unit, harmonic)) if harmonic else (ONE, ZERO)
        total = plus(total, times(back, value))
    rate = div(oscillators.omega, mul(TWO, PI))
    total = (mul(rate, total[0]), mul(rate, total[1]))
    if crossings.happens is None:
        return total
    return if_(crossings.happens, total[0], ZERO), if_(crossings.happens, total[1], ZERO)


def _crossings(kick: Kick, turn: Turn, of: Amplitudes) -> Crossings:
    found = linear_in_turning(kick.when, turn.oscillators)
    if found is None or len({turn.oscillators.harmonics[j] for j in found[0]}) != 1:
        raise InputError(
            f"averaging: events must happen where a linear function of oscillators of one frequency crosses zero, not "
            f"{to_text(kick.when)}"
        )
    coefficients, constant = found
    size, direction = _harmonic(coefficients, turn, of)
    level = neg(div(constant, size))
    across = ONE if constant is ZERO else call("sqrt", call("max", ZERO, sub(ONE, power(level, TWO))))
    signs = {"up": (-1,), "down": (1,), "both": (-1, 1)}[kick.direction]
    units = [times(direction, (level, mul(number(sign), across))) for sign in signs]
    (h,) = {turn.oscillators.harmonics[j] for j in coefficients}
    if h > 1:
        units = [root for unit in units for root in _roots(unit, h)]
    return Crossings(tuple(units), None if constant is ZERO else compare(">", size, call("abs", constant)))


def _harmonic(
    coefficients: Mapping[int, tuple[Expression, Expression]], turn: Turn, of: Amplitudes
) -> tuple[Expression, Complex]:
    """D and exp(i delta) of sum a_j x_j + b_j y_j = D cos(h tau - delta); of one oscillator conj(A) (a - i b w)."""
    if len(coefficients) > 1:
        p, q = turn.harmonic(coefficients)
        size = call("sqrt", add(power(p, TWO), power(q, TWO)))
        return size, (div(p, size), div(q, size))
    [(j, (a, b))] = coefficients.items()
    modulus, unit = of.modulus_and_unit(j)
    slope = mul(b, turn.oscillators.frequency(j))
    if slope is ZERO and a is ONE:
        return modulus, conjugate(unit)
    size = call("sqrt", add(power(a, TWO), power(slope, TWO)))
    return mul(modulus, size), times(conjugate(unit), (div(a, size), neg(div(slope, size))))


def _roots(unit: Complex, h: int) -> list[Complex]:
    """exp(i tau) for all tau of a turn with exp(i h tau) = unit."""
    angle = call("atan2", unit[1], unit[0])
    angles = [div(add(angle, mul(number(2 * k), PI)), number(h)) for k in range(h)]
    return [(call("cos", a), call("sin", a)) for a in angles]
