"""Weak forces as sums of atoms, for averages of second order: waves of polynomial forces, pulses of piecewise ones."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping
from dataclasses import replace

from contin.errors import InputError
from contin.model.expression import ONE, Expression, mul, number, power, substitute, symbol
from contin.symbolic.averaging.pulses import PiecewiseTurn, Pulse
from contin.symbolic.averaging.radial import Setting
from contin.symbolic.averaging.resonant import state_powers
from contin.symbolic.averaging.second_order_terms import Atom, Shape, Wave, shifted
from contin.symbolic.averaging.switching_lines import PLANE, X, Y
from contin.symbolic.averaging.terms import additive_terms, without_kinks
from contin.symbolic.averaging.weak import WeakOscillators


class WeakForces:
    """The perturbations of weak oscillators as atoms, and the turns on which pulses are defined."""

    def __init__(self, oscillators: WeakOscillators, setting: Setting) -> None:
        self.oscillators, self.setting = oscillators, setting
        self.harmonics = oscillators.harmonics
        self.count = len(self.harmonics)
        self.omega = oscillators.omega
        self.states = oscillators.places()
        self.turns = self.piecewise_turns()

    def piecewise_turns(self) -> dict[int, PiecewiseTurn]:
        """The common turn of all that each oscillator drives piecewise."""
        found: dict[int, dict[Expression, None]] = {}
        series = [*self.oscillators.position, *self.oscillators.velocity, *(s.rate for s in self.oscillators.slow)]
        for perturbation in (e for order in series for e in order):
            for _, term in additive_terms(perturbation, self.oscillators.mask):
                members = self.oscillators.members(term)
                if self.is_pulse(members) and state_powers(term, self.states) is None:
                    found.setdefault(members[0], {})[self.in_plane(term, members[0])] = None
        known: dict[tuple[Expression, ...], PiecewiseTurn] = {}
        turns = {}
        for i, terms in found.items():
            key = tuple(terms)
            if key not in known:
                known[key] = PiecewiseTurn.of(key, self.omega, self.setting.values, self.setting.positive)
            turns[i] = known[key]
        return turns

    def is_pulse(self, members: tuple[int, ...]) -> bool:
        """One oscillator alone; pulses are taken where all is in 1:1 resonance."""
        return len(members) == 1 and members[0] < self.oscillators.count and set(self.harmonics) == {1}

    def in_plane(self, term: Expression, i: int) -> Expression:
        pair = self.oscillators.pairs[i]
        plain = substitute([term], {symbol(pair.position): symbol(X), symbol(pair.velocity): symbol(Y)})[0]
        for state in self.oscillators.slow:
            if plain.mask & symbol(state.name).mask:
                raise InputError(
                    f"second-order averaging: {state.name}, which is slow, may multiply a force with conditions, and "
                    "not stand inside of it (write w*(1 if x > 0 else 0)); otherwise average with `order: 1`"
                )
        return without_kinks(plain, PLANE)

    def first_order(self) -> list[list[Atom]]:
        """What drives the oscillators, the phasors (of rotators), then the slow states."""
        found: list[list[Atom]] = []
        for i in range(self.oscillators.count):
            h = self.harmonics[i]
            atoms = self.atoms(self.oscillators.velocity[0][i], h, self.oscillators.frequency(i))
            found.append([*atoms, *self.atoms(self.oscillators.position[0][i], h)])
        slow = {state.name: self.atoms(state.rate[0], 0) for state in self.oscillators.slow}
        for j, phasor in enumerate(self.oscillators.phasors, start=self.oscillators.count):
            found.append([] if phasor.state is None else [self.turning(atom, j) for atom in slow[phasor.state]])
        return [*found, *slow.values()]

    def turning(self, atom: Atom, j: int) -> Atom:
        """The rate of a phase as that of its phasor: i exp(i theta) theta'."""
        if isinstance(atom, Pulse):
            raise InputError(
                "second-order averaging: a rotator's phase may not be driven by a force with conditions; use order: 1"
            )
        return replace(atom, number=1j * atom.number, shape=shifted(atom.shape, j, 1, 1))

    def atoms(self, perturbation: Expression, h: int, frequency: Expression | None = None) -> list[Atom]:
        """exp(-i h w t) E as atoms; with the frequency of the oscillator, -i/frequency times that of a force."""
        unit: complex = 1.0 if frequency is None else -1j
        inverse = ONE if frequency is None else power(frequency, number(-1))
        found: list[Atom] = []
        for coefficient, term in additive_terms(perturbation, self.oscillators.mask):
            scale = mul(coefficient, inverse)
            members = self.oscillators.members(term)
            if any(self.oscillators.responds(j) for j in members):
                raise InputError("averaging to second order takes no dry friction with its stick set; use order: 1")
            powers = state_powers(term, self.states) if members else {}
            if powers is not None:
                found += self.waves(mul(scale, term) if not members else scale, unit, powers, h)
            elif self.is_pulse(members):
                i = members[0]
                found += self.turns[i].pulses(scale, unit, self.in_plane(term, i), i, h)
            else:
                raise InputError(
                    "second-order averaging: a force of several oscillators, or of oscillators in another "
                    "resonance than 1:1, must be polynomial in their states, and in sin and cos of the forcing; "
                    "average with `order: 1`"
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
                            raised[shifted(shape, i, 1, sign)][k + h * sign] += c * factor
                product = raised
        scale = mul(scale, power(self.omega, number(omegas)))
        return [
            Wave(scale, unit * c, shape, k - target)
            for shape, harmonics in product.items()
            for k, c in harmonics.items()
            if c != 0
        ]
