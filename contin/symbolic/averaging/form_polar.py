"""Polar form: amplitudes r_i and phase differences psi_j = theta_j - theta_1, as in papers; singular at r_i = 0."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

from contin.model.expression import ONE, ZERO, Expression, add, call, mul, neg, number, power, sub, symbol
from contin.symbolic.averaging.amplitudes import SlowSystem
from contin.symbolic.averaging.complex_formulas import Complex, conjugate, times, to_power
from contin.symbolic.averaging.forms import (
    AveragedForm,
    general_parts,
    mean_rates,
    needs_frame,
    phasor_amplitudes,
    ratio,
    slow_words,
)
from contin.symbolic.averaging.squared_radius import turn_over_radius
from contin.symbolic.averaging.weak import WeakOscillators

FREQUENCY_SHIFT = "frequency_shift"


def polar_names(count: int, forced: bool = False) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Names of the amplitudes, and of the phases: differences from the first one, or from the forcing's."""
    radii = ("r",) if count == 1 else tuple(f"r{i + 1}" for i in range(count))
    if forced:
        return radii, ("psi",) if count == 1 else tuple(f"psi{i + 1}" for i in range(count))
    return radii, ("psi",) if count == 2 else tuple(f"psi{i + 1}" for i in range(1, count))


def phase_from_first(oscillators: WeakOscillators, amplitudes: Sequence[Complex], j: int) -> Complex:
    """A_j turned by the rotation that makes A_1 positive, up to a positive factor."""
    share = Fraction(oscillators.harmonics[j], oscillators.harmonics[0])
    if share.denominator == 1:
        return times(amplitudes[j], to_power(conjugate(amplitudes[0]), int(share)))
    re, im = amplitudes[0]
    angle = mul(number(-share), call("atan2", im, re))
    return times(amplitudes[j], (call("cos", angle), call("sin", angle)))


def polar_form(system: SlowSystem) -> AveragedForm:
    """r_i' and psi_j' in slow time; for one oscillator without forcing r' and, as an observable, the frequency's shift.

    psi_j = theta_j - (h_j/h_1) theta_1, and with forcing psi_j = theta_j, the forcing's phase being 0.
    """
    oscillators = system.oscillators
    forced = oscillators.is_forced
    count = oscillators.count
    radii, phases = polar_names(count, forced)
    own: list[Expression] = [symbol(name) for name in radii]
    relative: list[Expression] = [*(() if forced else (ZERO,)), *(symbol(name) for name in phases)]
    r = [*own, *(ONE for _ in oscillators.phasors)]
    angles = [*relative, *(ZERO if p.state is None else symbol(p.state) for p in oscillators.phasors)]
    rates = [_rates(system, i, r, angles) for i in range(count)]
    growths, turns = [g for g, _ in rates], [t for _, t in rates]
    lead = ZERO if forced else turns[0]
    shares = [ratio(oscillators, h) for h in oscillators.harmonics[:count]]
    differences = [_difference(turns[j], lead, shares[j]) for j in range(0 if forced else 1, count)]
    frame = [_at_angle(a, p) for a, p in zip(own, relative, strict=True)]
    means = mean_rates(
        system,
        [*frame, *phasor_amplitudes(oscillators)],
        [*(power(a, number(2)) for a in own), *(ONE for _ in oscillators.phasors)],
        lambda average, j: turn_over_radius(average, own[j]),
        [(a, _at_angle(ONE, p)) for a, p in zip(r, angles, strict=True)],
    )
    slow = [_difference(m, lead, ratio(oscillators, s.turns)) for m, s in zip(means, oscillators.slow, strict=True)]
    smooth = count == 1 and not forced
    other = "stokes or cartesian" if count == 2 and oscillators.is_plain else "cartesian"
    return AveragedForm(
        "polar",
        (*radii, *phases, *(s.name for s in oscillators.slow)),
        (*_words(oscillators), *slow_words(system)),
        (*growths, *differences, *slow),
        {FREQUENCY_SHIFT: turns[0]} if smooth else {},
        angles=(*phases, *(s.name for s in oscillators.slow if s.turns)),
        valid="valid for r >= 0; the form cartesian is smooth through r = 0"
        if smooth
        else f"valid for {', '.join(radii)} > 0; phases have no meaning at zero amplitude, where the form {other} is "
        "smooth",
        amplitudes=radii,
        beyond="The polar form means amplitudes r >= 0; the form cartesian goes through r = 0."
        if smooth
        else f"The polar form is singular at zero amplitude; the form {other} is smooth there.",
        rates=(FREQUENCY_SHIFT,) if smooth else (),
    )


def _words(oscillators: WeakOscillators) -> list[str]:
    """Descriptions of the amplitudes and the phases."""
    count, harmonics = oscillators.count, oscillators.harmonics
    words = ["amplitude"] if count == 1 else [f"amplitude of oscillator {i + 1}" for i in range(count)]
    if oscillators.is_forced:
        own = ["phase"] if count == 1 else [f"phase of oscillator {i + 1}" for i in range(count)]
        return [*words, *(f"{text} relative to the forcing" for text in own)]
    for j in range(1, count):
        times_first = "" if harmonics[j] == harmonics[0] else f"{Fraction(harmonics[j], harmonics[0])} times "
        words.append(f"phase of oscillator {j + 1} minus {times_first}that of oscillator 1")
    return words


def _difference(own: Expression, first: Expression, share: Expression) -> Expression:
    """theta_j' - share theta_1', term by term so that common terms cancel."""
    terms = list(own.args) if own.op == "add" else [own]
    minus = list(first.args) if first.op == "add" else [first]
    if first is ZERO or share is ZERO:
        return own
    return add(*terms, *(neg(t) if share is ONE else mul(neg(share), t) for t in minus))


def _rates(system: SlowSystem, i: int, r: list[Expression], psi: list[Expression]) -> tuple[Expression, Expression]:
    """r_i' and theta_i'."""
    growth: list[Expression] = []
    turn: list[Expression] = []
    equation = system.equations[i]
    own_growth: list[Expression] = []
    own_turn: list[Expression] = []
    for j in equation.radial:
        rates = system.rates(i, j)
        g = rates.sin(r[j])
        if j == i:
            own_growth.append(g)
            own_turn.append(turn_over_radius(rates, r[j]))
            continue
        angle = sub(psi[j], psi[i])
        cos, sin = call("cos", angle), call("sin", angle)
        raw = rates.cos(r[j])
        growth += [mul(g, cos), mul(number(-1), raw, sin)]
        turn += [mul(power(r[i], number(-1)), add(mul(g, sin), mul(raw, cos)))]
    for powers, (re, im) in equation.products.items():
        size = mul(*(power(r[j], number(m + n)) for j, (m, n) in enumerate(powers)))
        angle = sub(add(*(mul(number(m - n), psi[j]) for j, (m, n) in enumerate(powers))), psi[i])
        cos, sin = _trig(angle)
        growth.append(mul(re, size, cos))
        growth.append(mul(number(-1), im, size, sin))
        inverse = power(r[i], number(-1))
        turn.append(mul(re, size, sin, inverse))
        turn.append(mul(im, size, cos, inverse))
    if needs_frame(system, i):
        # where all have one frequency, the frame in which oscillator i has the phase 0
        common = bool(system.oscillators.kicks) and set(system.oscillators.harmonics) == {1}
        seen = [sub(p, psi[i]) for p in psi] if common else psi
        units = [_at_angle(ONE, p) for p in seen]
        frame: list[Complex] = [(mul(a, c), mul(a, s)) for a, (c, s) in zip(r, units, strict=True)]
        re, im = general_parts(system, i, frame, list(zip(r, units, strict=True)))
        cos, sin = _at_angle(ONE, seen[i])
        growth.append(add(mul(re, cos), mul(im, sin)))
        turn.append(mul(add(mul(im, cos), neg(mul(re, sin))), power(r[i], number(-1))))
    return _ordered(growth, own_growth), _ordered(turn, own_turn)


def _at_angle(radius: Expression, angle: Expression) -> Complex:
    return mul(radius, call("cos", angle)), mul(radius, call("sin", angle))


def _trig(angle: Expression) -> tuple[Expression, Expression]:
    """cos and sin; of -w by those of w."""
    if angle.op == "mul" and angle.args[0].is_number and float(angle.args[0].value or 0) < 0:
        return call("cos", neg(angle)), neg(call("sin", neg(angle)))
    return call("cos", angle), call("sin", angle)


def _ordered(coupling: list[Expression], own: list[Expression]) -> Expression:
    flat: list[Expression] = []
    for term in [*coupling, *own]:
        flat += term.args if term.op == "add" else (term,)
    return add(*flat)
