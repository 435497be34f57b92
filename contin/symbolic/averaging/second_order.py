"""Second-order averaging: the corrections of order eps to the averaged equations.

For A' = eps f(A, t) + eps^2 g(A, t) with period T in t, let w be the zero-mean integral of f - <f> over t. Then
the averaged variables obey A' = eps <f> + eps^2 (<g> + <Df w>) (Sanders, Verhulst and Murdock, Averaging Methods in
Nonlinear Dynamical Systems, 2nd ed., sec. 2.9).

Forces may be polynomial, and polynomial between lines through the origin of one oscillator's plane, where they may
jump: the oscillation crosses such a line at a fixed phase and with non-zero speed. Then <Df w> keeps a meaning: the
jumps contribute after an integration by parts over the phase, and the theorem holds away from r = 0. Conditions that
are no such lines (thresholds |x| > c) are refused, and so is a force on one oscillator that depends piecewise on
another one which is itself driven piecewise by a third.

Everything is a sum of terms c * prod r_j^d_j exp(i n_j theta_j); c are formulas in the parameters, and the means over
the phase of products of piecewise functions are numbers.
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Final

import numpy as np

from contin.errors import InputError
from contin.machine import elementary
from contin.model.expression import ONE, PI, ZERO, Expression, add, mul, number, power, substitute, symbol
from contin.model.printing import to_text
from contin.symbolic.averaging.amplitudes import AmplitudeEquation, SlowSystem
from contin.symbolic.averaging.build_form import build_form
from contin.symbolic.averaging.cells import Arc, regions
from contin.symbolic.averaging.forms import AveragedForm
from contin.symbolic.averaging.resonant import Exponent, Powers, state_powers
from contin.symbolic.averaging.switching_lines import PLANE, X, Y, state_comparisons
from contin.symbolic.averaging.terms import additive_terms, without_kinks
from contin.symbolic.averaging.turn_grid import Complex, TurnGrid
from contin.symbolic.averaging.weak import WeakOscillators

Shape = tuple[tuple[int, int], ...]  # for each oscillator (d, n): r^d exp(i n theta)
ROUNDING: Final = 1e-13
LARGEST_DENOMINATOR: Final = 20000  # fractions with smaller ones are 2.5e-9 apart


@dataclass(frozen=True)
class Wave:
    """c * shape * exp(i k omega t): a term of a polynomial force."""

    coefficient: Expression
    number: complex
    shape: Shape
    k: int


@dataclass(frozen=True)
class Pulse:
    """c * r^d exp(i theta) L(phi) of oscillator `source`, with L on the grid: a term of a piecewise force."""

    coefficient: Expression
    number: complex
    source: int
    d: int
    values: Complex


Atom = Wave | Pulse
Sum = dict[Shape, list[tuple[Expression, complex]]]


def second_order_terms(oscillators: WeakOscillators, system: SlowSystem, form: AveragedForm) -> AveragedForm:
    """The form of the terms of order eps in slow time (eps^2 in t) alone: its equations, and observables of rates."""
    if oscillators.slow or oscillators.kicks:
        raise InputError("averaging to second order takes no slow states, rotators and kicks; use order: 1")
    builder = _Builder(oscillators)
    every = range(oscillators.count)
    first = [builder.atoms(oscillators.position[0][i], oscillators.velocity[0][i], i) for i in every]
    first += [[] for _ in oscillators.phasors]  # phasors do not vary
    equations = []
    for i in range(oscillators.count):
        total: Sum = defaultdict(list)
        builder.add_mean(total, builder.atoms(oscillators.position[1][i], oscillators.velocity[1][i], i))
        for atom in first[i]:
            builder.add_interaction(total, atom, first)
        equations.append(_equation(total, form.name == "polar"))
    corrections = SlowSystem(oscillators, system.setting, tuple(equations))
    return build_form(corrections, form.name)


class _Builder:
    def __init__(self, oscillators: WeakOscillators) -> None:
        self.oscillators = oscillators
        self.harmonics = oscillators.harmonics
        self.count = len(self.harmonics)
        self.omega = oscillators.omega
        self.states = oscillators.places()
        self.grid = TurnGrid.between(self.breakpoints())

    # The force as a sum of atoms --------------------------------------------------------------------------------------

    def breakpoints(self) -> list[float]:
        found = [0.0]
        series = (*self.oscillators.position, *self.oscillators.velocity)
        for perturbation in (e for order in series for e in order):
            for _, term in additive_terms(perturbation, self.oscillators.mask):
                members = self.oscillators.members(term)
                if self.is_pulse(members) and state_powers(term, self.states) is None:
                    for arc in self.arcs(self.in_plane(term, members[0])):
                        found += [arc.start.number, arc.stop.number]
        return found

    def is_pulse(self, members: tuple[int, ...]) -> bool:
        """One oscillator alone; pulses are taken where all is in 1:1 resonance."""
        return len(members) == 1 and members[0] < self.oscillators.count and set(self.harmonics) == {1}

    def in_plane(self, term: Expression, i: int) -> Expression:
        pair = self.oscillators.pairs[i]
        plain = substitute([term], {symbol(pair.position): symbol(X), symbol(pair.velocity): symbol(Y)})[0]
        return without_kinks(plain, PLANE)

    def arcs(self, function: Expression) -> tuple[Arc, ...]:
        values = self.oscillators.model.default_parameters()
        found, _ = regions(function, self.omega, values, tuple(n for n, v in values.items() if v > 0))
        fixed = all(not (c.phi.free_symbols) for r in found for a in r.arcs for c in (a.start, a.stop))
        if len(found) > 1 or not (fixed or not state_comparisons(function)):
            raise InputError(
                "second-order averaging: conditions must be lines through the origin of one oscillator's plane, with "
                "fixed slopes (x*y > 0); thresholds such as x > c are averaged to first order only"
            )
        return found[0].arcs

    def atoms(self, position: Expression, velocity: Expression, i: int) -> list[Atom]:
        """exp(-i w t) (E - i F/w) as atoms, w the frequency of oscillator i."""
        inverse = power(self.oscillators.frequency(i), number(-1))
        found: list[Atom] = []
        for is_force, perturbation in ((True, velocity), (False, position)):
            for coefficient, term in additive_terms(perturbation, self.oscillators.mask):
                unit: complex = -1j if is_force else 1.0
                scale = mul(coefficient, inverse) if is_force else coefficient
                members = self.oscillators.members(term)
                powers = state_powers(term, self.states) if members else {}
                if powers is not None:
                    found += self.waves(scale, unit, powers, self.harmonics[i])
                elif self.is_pulse(members):
                    found += self.pulses(scale, unit, term, members[0])
                else:
                    raise InputError(
                        "second-order averaging: a force of several oscillators, or of oscillators in another "
                        "resonance than 1:1, must be polynomial in their states, and in sin and cos of the forcing"
                    )
        return found

    def waves(
        self, scale: Expression, unit: complex, powers: Mapping[tuple[int, bool], int], target: int
    ) -> list[Atom]:
        product: dict[Shape, dict[int, complex]] = {((0, 0),) * self.count: {0: 1.0 + 0.0j}}
        omegas = 0
        for (i, is_velocity), exponent in powers.items():
            omegas += exponent if is_velocity else 0
            for _ in range(exponent):
                h = self.harmonics[i]
                plus, minus = (0.5j * h, -0.5j * h) if is_velocity else (0.5, 0.5)
                raised: dict[Shape, dict[int, complex]] = defaultdict(lambda: defaultdict(complex))
                for shape, harmonics in product.items():
                    for k, c in harmonics.items():
                        for sign, factor in ((1, plus), (-1, minus)):
                            raised[_shifted(shape, i, 1, sign)][k + h * sign] += c * factor
                product = raised
        scale = mul(scale, power(self.omega, number(omegas)))
        return [
            Wave(scale, unit * c, shape, k - target)
            for shape, harmonics in product.items()
            for k, c in harmonics.items()
            if c != 0
        ]

    def pulses(self, scale: Expression, unit: complex, term: Expression, i: int) -> list[Atom]:
        """Piecewise polynomials of one oscillator."""
        states = {X: (0, False), Y: (0, True)}
        parts: dict[tuple[Expression, int, int], Complex] = {}
        phi = self.grid.phi
        for arc in self.arcs(self.in_plane(term, i)):
            inside = _inside(phi, arc)
            for coefficient, monomial in additive_terms(arc.formula, PLANE):
                powers = {} if monomial is ONE else state_powers(monomial, states)
                if powers is None:
                    raise InputError("second-order averaging: forces must be polynomials, piece by piece")
                m, n = powers.get((0, False), 0), powers.get((0, True), 0)
                monomial_values = elementary.pow(elementary.cos(phi), m) * elementary.pow(-elementary.sin(phi), n)
                shape = monomial_values * elementary.exp(-1j * phi)
                key = (mul(coefficient, power(self.omega, number(n))), m + n, 0)
                parts[key] = parts.get(key, np.zeros(phi.size, dtype=complex)) + np.where(inside, shape, 0.0)
        return [Pulse(mul(scale, c), unit, i, d, values) for (c, d, _), values in parts.items()]

    # Means ------------------------------------------------------------------------------------------------------------

    def add_mean(self, total: Sum, atoms: Sequence[Atom]) -> None:
        for atom in atoms:
            if isinstance(atom, Pulse):
                shape = self.shape({atom.source: (atom.d, 1)})
                total[shape].append((atom.coefficient, atom.number * self.grid.mean(atom.values)))
            elif atom.k == 0:
                total[atom.shape].append((atom.coefficient, atom.number))

    def shape(self, powers: Mapping[int, tuple[int, int]]) -> Shape:
        return tuple(powers.get(j, (0, 0)) for j in range(self.count))

    def add_interaction(self, total: Sum, atom: Atom, first: Sequence[Sequence[Atom]]) -> None:
        """<D(atom) w>, w of every oscillator the atom depends on. All w carry the factor 1/omega."""
        if isinstance(atom, Wave):
            for j, (d, n) in enumerate(atom.shape):
                if d:
                    self.vary_wave(total, atom, j, d, n, first[j])
        else:
            self.vary_pulse(total, atom, first[atom.source])

    def vary_wave(self, total: Sum, atom: Wave, j: int, d: int, n: int, drive: Sequence[Atom]) -> None:
        """r^d e^(i n theta) = A^m conj(A)^q: m A^(m-1) conj(A)^q w + q A^m conj(A)^(q-1) conj(w)."""
        m, q = (d + n) // 2, (d - n) // 2
        for count, conjugated in ((m, False), (q, True)):
            if not count:
                continue
            base = _shifted(atom.shape, j, -1, 1 if conjugated else -1)
            for w in drive:
                scale = mul(atom.coefficient, w.coefficient, power(self.omega, number(-1)))
                if isinstance(w, Wave):
                    if w.k == 0:
                        continue
                    k = -w.k if conjugated else w.k
                    if atom.k + k != 0:
                        continue
                    value = w.number / (1j * w.k)
                    value = value.conjugate() if conjugated else value
                    shape = _product(base, _conjugate(w.shape) if conjugated else w.shape)
                    total[shape].append((scale, count * atom.number * value))
                    continue
                integral = w.number * self.grid.antiderivative(w.values)
                turn = 1
                if conjugated:
                    integral, turn = np.conj(integral), -1
                # exp(i k omega t) = exp(i k phi_s) exp(-i k theta_s)
                mean = self.grid.mean(self.grid.harmonic(atom.k) * integral)
                shape = _product(base, self.shape({w.source: (w.d, turn - atom.k)}))
                total[shape].append((scale, count * atom.number * mean))

    def vary_pulse(self, total: Sum, atom: Pulse, drive: Sequence[Atom]) -> None:
        """r^d e^(i theta) L(phi) with dr + i r dtheta = W = e^(-i theta) w:

        e^(i theta) r^(d-1) (d <L Re W> + i <L Im W> - <L Im W'>), where the last term is <L' Im W> by parts.
        """
        s = atom.source
        for w in drive:
            scale = mul(atom.coefficient, w.coefficient, power(self.omega, number(-1)))
            if isinstance(w, Wave):
                if w.k == 0:
                    continue
                # W = e^(-i theta_s) shape e^(i k omega t)/(i k) = shape' e^(i k phi_s)
                values = w.number * self.grid.harmonic(w.k) / (1j * w.k)
                slope = w.number * self.grid.harmonic(w.k)
                shape = _shifted(w.shape, s, 0, -1 - w.k)
            elif w.source == s:
                values = w.number * self.grid.antiderivative(w.values)
                slope = w.number * (w.values - self.grid.mean(w.values))
                shape = self.shape({s: (w.d, 0)})
            else:
                raise InputError(
                    "second-order averaging: piecewise forces of two different oscillators act on one; only first order"
                )
            for own, change, at in (
                (values, slope, shape),
                (np.conj(values), np.conj(slope), _conjugate(shape)),
            ):
                # Re W = (W + conj W)/2, Im W = (W - conj W)/(2i)
                imaginary = 0.5 / 1j if own is values else -0.5 / 1j
                mean = self.grid.mean(atom.values * (atom.d * 0.5 * own + 1j * imaginary * own - imaginary * change))
                total[_shifted(at, s, atom.d - 1, 1)].append((scale, atom.number * mean))


def _inside(phi: np.ndarray, arc: Arc) -> np.ndarray:
    return (phi - arc.start.number) % (2 * math.pi) < arc.stop.number - arc.start.number


def _shifted(shape: Shape, j: int, d: int, n: int) -> Shape:
    old = shape[j]
    return (*shape[:j], (old[0] + d, old[1] + n), *shape[j + 1 :])


def _product(a: Shape, b: Shape) -> Shape:
    return tuple((p[0] + q[0], p[1] + q[1]) for p, q in zip(a, b, strict=True))


def _conjugate(shape: Shape) -> Shape:
    return tuple((d, -n) for d, n in shape)


def _half(value: int) -> Exponent:
    return Fraction(value, 2) if value % 2 else value // 2


def _equation(total: Sum, polar: bool) -> AmplitudeEquation:
    products: dict[Powers, tuple[Expression, Expression]] = {}
    largest = max((abs(value) for terms in total.values() for _, value in terms), default=1.0)
    for shape, terms in total.items():
        powers = []
        for d, n in shape:
            if (d + n) % 2 and not polar:
                raise InputError(
                    "second-order averaging: the corrections are not smooth at zero amplitude; use the form polar"
                )
            powers.append((_half(d + n), _half(d - n)))
        parts = []
        for part in ("real", "imag"):
            summed: dict[Expression, float] = defaultdict(float)
            for coefficient, value in terms:
                summed[_in_order(coefficient)] += float(getattr(value, part))
            kept = {c: v for c, v in summed.items() if abs(v) > ROUNDING * largest}
            parts.append(add(*(mul(_constant(v), c) for c, v in kept.items())) if kept else ZERO)
        if parts != [ZERO, ZERO]:
            products[tuple(powers)] = (parts[0], parts[1])
    return AmplitudeEquation({}, products, ())


def _in_order(coefficient: Expression) -> Expression:
    """mu beta and beta mu are one coefficient."""
    if coefficient.op != "mul":
        return coefficient
    return mul(*sorted(coefficient.args, key=to_text))


def _constant(value: float) -> Expression:
    """p/q, p/(q pi) or p/(q pi^2) where the number is one to rounding: means of trigonometric polynomials are."""
    for k in range(3):
        scaled = value * elementary.pow(math.pi, k)
        guess = Fraction(scaled).limit_denominator(LARGEST_DENOMINATOR)
        if abs(float(guess) - scaled) <= 2e-15 * max(1.0, abs(scaled)):
            if k == 0:
                return number(guess)
            return mul(number(guess), power(PI, number(-k)))
    return number(value)
