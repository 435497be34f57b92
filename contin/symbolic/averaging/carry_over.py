"""What a model declares beside its equations, in the states of an averaged form: starts, symmetries, observables."""

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
    neg,
    number,
    power,
    sub,
    substitute,
    symbol,
)
from contin.model.parts import Start, State, Symmetry
from contin.symbolic.averaging.complex_formulas import Complex, conjugate, times
from contin.symbolic.averaging.form_polar import polar_names
from contin.symbolic.averaging.forms import AveragedForm
from contin.symbolic.averaging.oscillators import WeakOscillators
from contin.symbolic.calculus.sampling import sample


def averaged_states(form: AveragedForm, oscillators: WeakOscillators) -> tuple[State, ...]:
    """The states of the form; their values are those of the model's default point."""
    defaults = {s.name: s.value for s in oscillators.model.states}
    values = form_values(form, amplitudes_of(defaults, oscillators))
    period = mul(number(2), PI)
    return tuple(
        State(
            name,
            values[name],
            None,
            words,
            period if name in form.angles else None,
            ZERO if name in form.amplitudes else None,
            form.beyond if name in form.amplitudes else None,
        )
        for name, words in zip(form.states, form.descriptions, strict=True)
    )


def averaged_starts(form: AveragedForm, oscillators: WeakOscillators) -> tuple[Start, ...]:
    """The named starts; states that a start does not mention have their default."""
    defaults = {s.name: s.value for s in oscillators.model.states}
    starts = []
    for start in oscillators.model.starts:
        amplitudes = amplitudes_of({**defaults, **start.states}, oscillators)
        starts.append(Start(start.name, form_values(form, amplitudes), dict(start.parameters)))
    return tuple(starts)


def amplitudes_of(point: Mapping[str, Expression], oscillators: WeakOscillators) -> list[Complex]:
    """A = x - i y/omega at t = 0."""
    inverse = power(oscillators.omega, number(-1))
    return [(point[p.position], mul(number(-1), point[p.velocity], inverse)) for p in oscillators.pairs]


def form_values(form: AveragedForm, amplitudes: Sequence[Complex]) -> dict[str, Expression]:
    """The states of a form at given complex amplitudes."""
    if form.name == "cartesian":
        return dict(zip(form.states, (p for a in amplitudes for p in a), strict=True))
    if form.name == "stokes":
        (u1, v1), (u2, v2) = amplitudes
        re, im = times(amplitudes[0], conjugate(amplitudes[1]))
        two = number(2)
        first = sub(add(power(u1, two), power(v1, two)), add(power(u2, two), power(v2, two)))
        return {"S1": first, "S2": mul(two, re), "S3": mul(two, im)}
    radii, phases = polar_names(len(amplitudes))
    values = {name: _modulus(a) for name, a in zip(radii, amplitudes, strict=True)}
    for name, amplitude in zip(phases, amplitudes[1:], strict=True):
        values[name] = _angle(times(amplitude, conjugate(amplitudes[0])))
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


def averaged_symmetries(form: AveragedForm, oscillators: WeakOscillators) -> list[Symmetry]:
    """Declared symmetries that send every oscillator to plus or minus an oscillator; others have no averaged form."""
    found = []
    for symmetry in oscillators.model.symmetries:
        moves = _signed_permutation(symmetry, oscillators)
        if moves is None:
            continue
        images = _images(form, moves)
        if images:
            found.append(Symmetry(symmetry.name, images))
    return found


def _signed_permutation(symmetry: Symmetry, oscillators: WeakOscillators) -> list[tuple[int, int]] | None:
    """[(j, sign)]: oscillator i becomes sign * oscillator j."""
    names = [(p.position, p.velocity) for p in oscillators.pairs]
    moves = []
    for position, velocity in names:
        images = [symmetry.map.get(n, symbol(n)) for n in (position, velocity)]
        match = next(
            (
                (j, sign)
                for j, pair in enumerate(names)
                for sign in (1, -1)
                if all(image is mul(number(sign), symbol(n)) for image, n in zip(images, pair, strict=True))
            ),
            None,
        )
        if match is None:
            return None
        moves.append(match)
    return moves if sorted(j for j, _ in moves) == list(range(len(names))) else None


def _images(form: AveragedForm, moves: Sequence[tuple[int, int]]) -> dict[str, Expression]:
    """The substitution in the form's states; empty where it moves nothing."""
    count = len(moves)
    images: dict[str, Expression] = {}
    if form.name == "cartesian":
        for i, (j, sign) in enumerate(moves):
            for part in ("u", "v"):
                images[f"{part}{i + 1}"] = mul(number(sign), symbol(f"{part}{j + 1}"))
    elif form.name == "stokes":
        relative = number(moves[0][1] * moves[1][1])
        swapped = moves[0][0] == 1
        images = {
            "S1": neg(symbol("S1")) if swapped else symbol("S1"),
            "S2": mul(relative, symbol("S2")),
            "S3": mul(relative, neg(symbol("S3")) if swapped else symbol("S3")),
        }
    else:
        radii, phases = polar_names(count)
        theta: list[Expression] = [ZERO, *(symbol(name) for name in phases)]
        for i, (j, _) in enumerate(moves):
            images[radii[i]] = symbol(radii[j])
        first, first_sign = moves[0]
        for i, (j, sign) in enumerate(moves[1:], start=1):
            shift = PI if sign != first_sign else ZERO
            images[phases[i - 1]] = add(sub(theta[j], theta[first]), shift)
    return {name: image for name, image in images.items() if image is not symbol(name)}


def averaged_observables(form: AveragedForm, oscillators: WeakOscillators) -> tuple[dict[str, Expression], list[str]]:
    """(observables in the form's states, names of those that change along an oscillation and are left out)."""
    model = oscillators.model
    kept: dict[str, Expression] = {}
    dropped = []
    frame = amplitudes_in(form, oscillators.count)
    for name, formula in model.observables.items():
        if not depends_on(formula, model.state_names):
            kept[name] = formula
        elif name in form.states or name in form.observables:
            continue  # the form's own r, r1, psi, ... stand for it
        elif _is_invariant(formula, oscillators):
            mapping = {}
            for (u, v), pair in zip(frame, oscillators.pairs, strict=True):
                mapping[symbol(pair.position)] = u
                mapping[symbol(pair.velocity)] = mul(number(-1), oscillators.omega, v)
            kept[name] = substitute([formula], mapping)[0]
        else:
            dropped.append(name)
    return kept, dropped


def amplitudes_in(form: AveragedForm, count: int) -> list[Complex]:
    """Complex amplitudes up to a common phase, in the form's states."""
    if form.name == "cartesian":
        return [(symbol(f"u{i + 1}"), symbol(f"v{i + 1}")) for i in range(count)]
    if form.name == "stokes":
        r1, r2, psi = (form.observables[n] for n in ("r1", "r2", "psi"))
        return [(r1, ZERO), (mul(r2, call("cos", psi)), mul(r2, call("sin", psi)))]
    radii, phases = polar_names(count)
    angles: list[Expression] = [ZERO, *(symbol(p) for p in phases)]
    turned = zip((symbol(r) for r in radii), angles, strict=True)
    return [(mul(r, call("cos", a)), mul(r, call("sin", a))) for r, a in turned]


def _is_invariant(formula: Expression, oscillators: WeakOscillators) -> bool:
    """Sampled: does the value stay the same along a harmonic oscillation?"""
    model = oscillators.model
    env: dict[str, object] = dict(model.default_parameters())
    w = float(evaluate(oscillators.omega, model.default_parameters()))
    chance = np.random.default_rng(3)
    phase = np.linspace(0.0, 2 * math.pi, 24, endpoint=False)
    for pair in oscillators.pairs:
        radius, start = chance.uniform(0.5, 2.0), chance.uniform(0.0, 6.0)
        env[pair.position] = radius * elementary.cos(phase + start)
        env[pair.velocity] = -w * radius * elementary.sin(phase + start)
    values = sample([formula], env)[0]
    return bool(np.all(np.isfinite(values)) and np.ptp(values) <= 1e-10 * max(1.0, float(np.abs(values).max())))


def gauge_symmetries(form: AveragedForm) -> list[Symmetry]:
    """(r, theta) ~ (-r, theta + pi): symmetries of every averaged system of this form whose formulas are odd."""
    if form.name == "polar":
        radii, phases = polar_names(len(form.states) - len(form.angles))
        if len(radii) == 1:
            return [Symmetry("reflection", {"r": neg(symbol("r"))})]
        if len(radii) == 2:
            return [Symmetry("gauge", {"r1": neg(symbol("r1")), "psi": add(symbol("psi"), PI)})]
        images: dict[str, Expression] = {"r1": neg(symbol("r1"))}
        images |= {p: add(symbol(p), PI) for p in phases}
        found = [Symmetry("gauge1", images)]
        for j, phase in enumerate(phases, start=2):
            found.append(Symmetry(f"gauge{j}", {f"r{j}": neg(symbol(f"r{j}")), phase: add(symbol(phase), PI)}))
        return found
    return []
