"""Polar form: amplitudes r_i and phase differences psi_j = theta_j - theta_1, as in papers; singular at r_i = 0."""

from __future__ import annotations

from contin.model.expression import ZERO, Expression, add, call, mul, neg, number, power, sub, symbol
from contin.symbolic.averaging.amplitudes import SlowSystem
from contin.symbolic.averaging.complex_formulas import Complex
from contin.symbolic.averaging.forms import AveragedForm, general_parts
from contin.symbolic.averaging.squared_radius import turn_over_radius

FREQUENCY_SHIFT = "frequency_shift"


def polar_names(count: int) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Names of the amplitudes and of the phase differences."""
    if count == 1:
        return ("r",), ()
    radii = tuple(f"r{i + 1}" for i in range(count))
    return radii, ("psi",) if count == 2 else tuple(f"psi{i + 1}" for i in range(1, count))


def polar_form(system: SlowSystem) -> AveragedForm:
    """r_i' and psi_j' in slow time; for one oscillator r' and, as an observable, the shift of the frequency."""
    count = system.oscillators.count
    radii, phases = polar_names(count)
    r = [symbol(name) for name in radii]
    psi: list[Expression] = [ZERO, *(symbol(name) for name in phases)]
    growths, turns = [], []
    for i in range(count):
        growth, turn = _rates(system, i, r, psi)
        growths.append(growth)
        turns.append(turn)
    differences = tuple(_difference(turns[j], turns[0]) for j in range(1, count))
    words = ["amplitude"] if count == 1 else [f"amplitude of oscillator {i + 1}" for i in range(count)]
    words += [f"phase of oscillator {j + 1} minus that of oscillator 1" for j in range(1, count)]
    if count == 1:
        valid = "valid for r >= 0; the form cartesian is smooth through r = 0"
        return AveragedForm(
            "polar",
            radii,
            tuple(words),
            tuple(growths),
            {FREQUENCY_SHIFT: turns[0]},
            valid=valid,
            amplitudes=radii,
            beyond="The polar form means amplitudes r >= 0; the form cartesian goes through r = 0.",
            rates=(FREQUENCY_SHIFT,),
        )
    other = "stokes or cartesian" if count == 2 else "cartesian"
    valid = (
        f"valid for {', '.join(radii)} > 0; phases have no meaning at zero amplitude, where the form {other} is smooth"
    )
    return AveragedForm(
        "polar",
        (*radii, *phases),
        tuple(words),
        (*growths, *differences),
        angles=phases,
        valid=valid,
        amplitudes=radii,
        beyond=f"The polar form is singular at zero amplitude; the form {other} is smooth there.",
    )


def _difference(own: Expression, first: Expression) -> Expression:
    """theta_j' - theta_1', term by term so that common terms cancel."""
    terms = list(own.args) if own.op == "add" else [own]
    minus = list(first.args) if first.op == "add" else [first]
    return add(*terms, *(neg(t) for t in minus))


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
    if equation.general:
        frame: list[Complex] = [(mul(a, call("cos", p)), mul(a, call("sin", p))) for a, p in zip(r, psi, strict=True)]
        re, im = general_parts(system, i, frame)
        cos, sin = call("cos", psi[i]), call("sin", psi[i])
        growth.append(add(mul(re, cos), mul(im, sin)))
        turn.append(mul(add(mul(im, cos), neg(mul(re, sin))), power(r[i], number(-1))))
    return _ordered(growth, own_growth), _ordered(turn, own_turn)


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
