"""What a model declares beside its equations, in the states of an averaged form: starts and observables."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from fractions import Fraction

import numpy as np

from contin.machine import elementary
from contin.model.evaluate import evaluate
from contin.model.expression import (
    PI,
    ZERO,
    Expression,
    add,
    call,
    depends_on,
    mul,
    number,
    power,
    sub,
    substitute,
    symbol,
)
from contin.model.parts import TIME, Start, State
from contin.records import Fields
from contin.symbolic.averaging.complex_formulas import Complex, conjugate, times
from contin.symbolic.averaging.form_cartesian import cartesian_names
from contin.symbolic.averaging.form_polar import phase_from_first, polar_names
from contin.symbolic.averaging.forms import AveragedForm, phasor_amplitudes, ratio, response_amplitudes
from contin.symbolic.averaging.oscillators import slow_values
from contin.symbolic.averaging.weak import WeakOscillators
from contin.symbolic.calculus.sampling import sample


def averaged_states(form: AveragedForm, oscillators: WeakOscillators) -> tuple[State, ...]:
    """The states of the form; their values are those of the model's default point."""
    written = {s.name: s for s in oscillators.model.states}
    values = form_values(form, {name: s.value for name, s in written.items()}, oscillators)
    period = mul(number(2), PI)
    slow = {s.name for s in oscillators.slow if not s.turns}
    return tuple(
        written[name]
        if name in slow
        else State(
            name,
            values[name],
            None,
            words,
            period if name in form.angles else None,
            ZERO if name in form.amplitudes else None,
            form.beyond if name in (form.amplitudes or form.states[:1]) else None,
        )
        for name, words in zip(form.states, form.descriptions, strict=True)
    )


def averaged_starts(form: AveragedForm, oscillators: WeakOscillators) -> tuple[Start, ...]:
    """The named starts; states that a start does not mention have their default."""
    defaults = {s.name: s.value for s in oscillators.model.states}
    starts = []
    for start in oscillators.model.starts:
        values = form_values(form, {**defaults, **start.states}, oscillators)
        starts.append(Start(start.name, values, dict(start.parameters)))
    return tuple(starts)


def amplitudes_of(point: Mapping[str, Expression], oscillators: WeakOscillators) -> list[Complex]:
    """A = x - i y/omega at t = 0."""
    return [
        (point[p.position], mul(number(-1), point[p.velocity], power(oscillators.frequency(i), number(-1))))
        for i, p in enumerate(oscillators.pairs)
    ]


def form_values(
    form: AveragedForm, point: Mapping[str, Expression], oscillators: WeakOscillators
) -> dict[str, Expression]:
    """The states of a form at a point of the phase space, at t = 0."""
    amplitudes = amplitudes_of(point, oscillators)
    slow = {s.name: point[s.name] for s in oscillators.slow}
    if form.name == "cartesian":
        names = cartesian_names(oscillators.count)
        return {**dict(zip(names, (p for a in amplitudes for p in a), strict=True)), **slow}
    if form.name == "stokes":
        (u1, v1), (u2, v2) = amplitudes
        re, im = times(amplitudes[0], conjugate(amplitudes[1]))
        two = number(2)
        first = sub(add(power(u1, two), power(v1, two)), add(power(u2, two), power(v2, two)))
        return {"S1": first, "S2": mul(two, re), "S3": mul(two, im)}
    return {**_polar_values(amplitudes, oscillators), **_phases_from_first(slow, amplitudes, oscillators)}


def _polar_values(amplitudes: Sequence[Complex], oscillators: WeakOscillators) -> dict[str, Expression]:
    forced = oscillators.is_forced
    radii, phases = polar_names(len(amplitudes), forced)
    values = {name: _modulus(a) for name, a in zip(radii, amplitudes, strict=True)}
    for j, name in enumerate(phases, start=0 if forced else 1):
        values[name] = _angle(amplitudes[j] if forced else phase_from_first(oscillators, amplitudes, j))
    return values


def _phases_from_first(
    slow: Mapping[str, Expression], amplitudes: Sequence[Complex], oscillators: WeakOscillators
) -> dict[str, Expression]:
    """Slow states; of rotators without forcing, the phase when the first oscillator is at its crest."""
    values = dict(slow)
    for state in oscillators.slow:
        if state.turns and not oscillators.is_forced:
            share = ratio(oscillators, state.turns)
            values[state.name] = sub(slow[state.name], mul(share, _angle(amplitudes[0])))
    return values


def _modulus(a: Complex) -> Expression:
    for one, other in (a, a[::-1]):
        if other is ZERO:
            sign = _sign(one)
            return mul(number(sign), one) if sign else call("abs", one)
    return call("sqrt", add(power(a[0], number(2)), power(a[1], number(2))))


def _angle(a: Complex) -> Expression:
    re, im = a
    if im is ZERO and _sign(re):
        return PI if _sign(re) < 0 else ZERO
    return call("atan2", im, re)


def _sign(formula: Expression) -> int:
    """1 or -1 where the formula has that sign (or is 0) whatever the parameters are; otherwise 0."""
    if formula.is_number:
        return -1 if evaluate(formula, {}) < 0 else 1
    if formula.op in ("sqrt", "exp", "abs", "pi", "cosh"):
        return 1
    if formula.op == "pow" and formula.args[1].is_number:
        exponent = formula.args[1].value
        return 1 if isinstance(exponent, Fraction) and exponent % 2 == 0 else _sign(formula.args[0])
    if formula.op == "mul":
        return math.prod(_sign(factor) for factor in formula.args)
    if formula.op == "add":
        signs = {_sign(term) for term in formula.args}
        return signs.pop() if len(signs) == 1 else 0
    return 0


def averaged_observables(form: AveragedForm, oscillators: WeakOscillators) -> tuple[dict[str, Expression], list[str]]:
    """(observables in the form's states, names of those that change along an oscillation and are left out)."""
    model = oscillators.model
    kept: dict[str, Expression] = {}
    dropped = []
    frame = amplitudes_in(form, oscillators)
    frame += response_amplitudes(oscillators, frame)
    unknown = [n for n in (model.averaging.slaved if model.averaging else ()) if n not in oscillators.slaved]
    followers = {symbol(n): e for n, e in oscillators.slaved.items()}
    for name, written in model.observables.items():
        formula = substitute([written], followers)[0] if followers else written
        if not depends_on(formula, [*model.state_names, TIME]):
            kept[name] = formula
        elif depends_on(formula, unknown):
            dropped.append(name)
        elif name in form.states or name in form.observables:
            continue  # the form's own r, r1, psi, ... stand for it
        elif _is_invariant(formula, oscillators):
            mapping = {}
            for i, ((u, v), pair) in enumerate(zip(frame, oscillators.turning, strict=True)):
                mapping[symbol(pair.position)] = u
                mapping[symbol(pair.velocity)] = mul(number(-1), oscillators.frequency(i), v)
            kept[name] = substitute([formula], mapping)[0]
        else:
            dropped.append(name)
    return kept, dropped


def amplitudes_in(form: AveragedForm, oscillators: WeakOscillators) -> list[Complex]:
    """Complex amplitudes of the oscillators, up to a common phase without forcing, then of the phasors."""
    count = oscillators.count
    others = phasor_amplitudes(oscillators)
    if form.name == "cartesian":
        return [*((symbol(f"u{i + 1}"), symbol(f"v{i + 1}")) for i in range(count)), *others]
    if form.name == "stokes":
        r1, r2, psi = (form.observables[n] for n in ("r1", "r2", "psi"))
        return [(r1, ZERO), (mul(r2, call("cos", psi)), mul(r2, call("sin", psi)))]
    forced = oscillators.is_forced
    radii, phases = polar_names(count, forced)
    angles: list[Expression] = [*(() if forced else (ZERO,)), *(symbol(p) for p in phases)]
    turned = zip((symbol(r) for r in radii), angles, strict=True)
    return [*((mul(r, call("cos", a)), mul(r, call("sin", a))) for r, a in turned), *others]


def _is_invariant(formula: Expression, oscillators: WeakOscillators) -> bool:
    """Sampled: does the value stay the same along a harmonic oscillation?"""
    model = oscillators.model
    if depends_on(formula, [TIME]):
        return False
    env: Fields = {**model.default_parameters(), **slow_values(model)}
    chance = np.random.default_rng(3)
    phase = np.linspace(0.0, 2 * math.pi, 24, endpoint=False)
    for i, pair in enumerate(oscillators.turning):
        w = float(evaluate(oscillators.frequency(i), model.default_parameters()))
        radius, start = chance.uniform(0.5, 2.0), chance.uniform(0.0, 6.0)
        env[pair.position] = radius * elementary.cos(pair.harmonic * phase + start)
        env[pair.velocity] = -w * radius * elementary.sin(pair.harmonic * phase + start)
    for state in oscillators.slow:
        if state.turns:
            env[state.name] = state.turns * phase + chance.uniform(0.0, 6.0)
    values = sample([formula], env)[0]
    return bool(np.all(np.isfinite(values)) and np.ptp(values) <= 1e-10 * max(1.0, float(np.abs(values).max())))
