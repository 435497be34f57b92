"""The averaged equations in the three forms: names of the states, their equations, and the user's r1, r2, psi."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction

from contin.errors import InputError
from contin.model.advice import closest
from contin.model.expression import ONE, ZERO, Expression, add, call, mul, number, power, symbol
from contin.symbolic.averaging.amplitudes import MeanEquation, SlowSystem
from contin.symbolic.averaging.complex_formulas import Complex, conjugate, plus, times, to_power
from contin.symbolic.averaging.form_names import FORMS
from contin.symbolic.averaging.friction import response_amplitude
from contin.symbolic.averaging.kicks import Amplitudes, kick_mean, kick_rates
from contin.symbolic.averaging.radial import RadialAverage
from contin.symbolic.averaging.resonant import Powers
from contin.symbolic.averaging.shared_average import shared_average
from contin.symbolic.averaging.weak import WeakOscillators


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


def check_form(name: object, oscillators: WeakOscillators, others: Sequence[str] = ()) -> str:
    """A form's name, checked against the oscillators; `others` are those of packages."""
    count = oscillators.count
    if not isinstance(name, str) or name not in FORMS:
        known = [*FORMS, *others]
        advice = closest(str(name), known) or f"there are {', '.join(known)}"
        raise InputError(f"averaging has no form {name!r}: {advice}")
    if name == "stokes" and count != 2:
        raise InputError(f"the form stokes is for two oscillators, and there are {count}; use polar or cartesian")
    if name == "stokes" and (oscillators.phasors or oscillators.slow or set(oscillators.harmonics) != {1}):
        raise InputError(
            "the form stokes is for two oscillators in 1:1 resonance without forcing, slow states and rotators; use "
            "polar or cartesian"
        )
    if name == "cartesian" and any(s.turns for s in oscillators.slow) and not oscillators.is_forced:
        raise InputError(
            "the form cartesian takes rotators with forcing only: without it their phases count from the first "
            "oscillator's, which has none at rest; use polar"
        )
    return name


def ratio(oscillators: WeakOscillators, turns: int) -> Expression:
    """Turns in one turn of the first oscillator."""
    return number(Fraction(turns, oscillators.harmonics[0]))


def phasor_amplitudes(oscillators: WeakOscillators) -> list[Complex]:
    """Of the forcing 1, of a rotator exp(i its phase)."""
    found: list[Complex] = []
    for phasor in oscillators.phasors:
        if phasor.state is None:
            found.append((ONE, ZERO))
        else:
            phase = symbol(phasor.state)
            found.append((call("cos", phase), call("sin", phase)))
    return found


def response_amplitudes(oscillators: WeakOscillators, amplitudes: Sequence[Complex]) -> list[Complex]:
    """Of the responses, at those of the oscillators and phasors."""
    found = []
    for response in oscillators.responses:
        frequency = mul(number(response.pair.harmonic), oscillators.omega)
        found.append(response_amplitude(response, amplitudes, frequency))
    return found


def slow_words(system: SlowSystem) -> list[str]:
    """Descriptions of the slow states."""
    first = "the forcing" if system.oscillators.is_forced else "oscillator 1"
    return [f"phase {s.name} relative to {first}" if s.turns else "slow state" for s in system.oscillators.slow]


def product_of(powers: Powers, amplitudes: Sequence[Complex], squares: Sequence[Expression], start: Complex) -> Complex:
    """start * prod A_j^m_j conj(A_j)^n_j, with |A_j|^2 kept as one factor."""
    for a, square, (m, n) in zip(amplitudes, squares, powers, strict=True):
        common = min(m, n)
        if common:
            size = power(square, number(common))
            start = (mul(start[0], size), mul(start[1], size))
        if m > common:
            start = times(start, to_power(a, int(m - common)))
        elif n > common:
            start = times(start, to_power(conjugate(a), int(n - common)))
    return start


def mean_rates(
    system: SlowSystem,
    amplitudes: Sequence[Complex],
    squares: Sequence[Expression],
    over_radius: Callable[[RadialAverage, int], Expression],
    polar: Sequence[tuple[Expression, Complex]] = (),
) -> tuple[Expression, ...]:
    """The rates of the slow states at complex amplitudes (oscillators, then phasors) with these squared moduli.

    over_radius : (average, j) -> its C(r)/r at the amplitude of oscillator j.
    """

    def rate(equation: MeanEquation) -> Expression:
        terms = [equation.constant]
        for powers, c in equation.products.items():
            terms.append(product_of(powers, amplitudes, squares, c)[0])
        terms += [over_radius(average, j) for j, average in equation.radial]
        for item in equation.general:
            re, _ = shared_average(item.term, system.oscillators, system.setting, amplitudes, 0)
            terms.append(mul(item.coefficient, re))
        return add(*terms)

    def kicked(state: str) -> Expression:
        oscillators = system.oscillators
        return add(*(kick_mean(kick, state, oscillators, Amplitudes(amplitudes, polar)) for kick in oscillators.kicks))

    states = zip(system.oscillators.slow, system.means, strict=True)
    return tuple(add(rate(equation), kicked(state.name)) for state, equation in states)


def needs_frame(system: SlowSystem, i: int) -> bool:
    """True where A_i' has parts that are formulas of all the amplitudes (`general_parts`)."""
    pair = system.oscillators.pairs[i]
    kicked = any(n in kick.changes for kick in system.oscillators.kicks for n in (pair.position, pair.velocity))
    return bool(system.equations[i].general or system.equations[i].linear) or kicked


def general_parts(
    system: SlowSystem, i: int, amplitudes: Sequence[Complex], polar: Sequence[tuple[Expression, Complex]] = ()
) -> Complex:
    """Real and imaginary part of the contributions to A_i' that are averaged by quadrature, of kicks and of responses.

    amplitudes : of the oscillators, then of the phasors.  polar : moduli and units A/|A|, where the form has them.
    """
    total: Complex = (ZERO, ZERO)
    oscillators = system.oscillators
    for item in system.equations[i].general:
        re, im = shared_average(item.term, oscillators, system.setting, amplitudes, oscillators.harmonics[i])
        if item.is_force:  # -i/omega (re + i im)
            inverse = power(oscillators.frequency(i), number(-1))
            re, im = mul(inverse, im), mul(number(-1), inverse, re)
        total = plus(total, (mul(item.coefficient, re), mul(item.coefficient, im)))
    if system.equations[i].linear:
        responses = response_amplitudes(oscillators, amplitudes)
        first = oscillators.count + len(oscillators.phasors)
        for c, k in system.equations[i].linear:
            total = plus(total, times(c, responses[k - first]))
    for kick in oscillators.kicks:
        total = plus(total, kick_rates(kick, i, oscillators, Amplitudes(amplitudes, polar)))
    return total
