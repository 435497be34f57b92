"""The terms of first-order perturbations sorted by how they are averaged, and averaged."""

from __future__ import annotations

from dataclasses import replace

from contin.errors import InputError, NotFiniteError
from contin.model.evaluate import evaluate
from contin.model.expression import ZERO, Expression, add, mul, neg, number, power, substitute, symbol
from contin.model.model import Model
from contin.symbolic.averaging.amplitudes import AmplitudeEquation, Complex, General, MeanEquation, SlowSystem, scaled
from contin.symbolic.averaging.oscillators import slow_values
from contin.symbolic.averaging.radial import Piece, RadialAverage, Setting, average_over_turn, combined
from contin.symbolic.averaging.resonant import Powers, StatePowers, resonant_part, state_powers
from contin.symbolic.averaging.switching_lines import X, Y
from contin.symbolic.averaging.terms import additive_terms
from contin.symbolic.averaging.weak import WeakOscillators
from contin.symbolic.calculus.shorter import cancelled


def slow_system(oscillators: WeakOscillators, reach: float | None = None) -> SlowSystem:
    """Average the first-order perturbations. A function that several oscillators share is averaged once.

    reach : amplitude up to which quadratures are checked; by default `reach_of`.
    """
    model = oscillators.model
    amplitude = reach_of(oscillators) if reach is None else reach
    slow = slow_values(model)
    values = {**model.default_parameters(), **slow}
    corners = tuple({**corner, **slow} for corner in corners_of(model))
    setting = Setting(oscillators.omega, values, amplitude, corners, frozenset(slow))
    averager = _Averager(oscillators, setting)
    first = zip(oscillators.position[0], oscillators.velocity[0], strict=True)
    equations = tuple(averager.equation(i, e, f) for i, (e, f) in enumerate(first))
    means = tuple(averager.mean(state.rate[0]) for state in oscillators.slow)
    every = [average for e in equations for average in e.radial.values()]
    every += [average for m in means for _, average in m.radial]
    presumes = dict.fromkeys(p for average in every for p in average.presumes)
    return SlowSystem(oscillators, setting, equations, means, tuple(presumes))


def corners_of(model: Model) -> tuple[dict[str, float], ...]:
    """The parameters with declared ranges all at their lower ends, and all at their upper ones."""
    ranges = {p.name: model.parameter_range(p.name) for p in model.parameters}
    ends = [{name: pair[k] for name, pair in ranges.items() if pair is not None} for k in (0, 1)]
    return tuple(model.default_parameters(end) for end in ends if end)


def reach_of(oscillators: WeakOscillators) -> float:
    """Amplitudes up to here are checked: four times the largest of the starts, at least 4."""
    model = oscillators.model
    values = model.default_parameters()
    largest = 1.0
    for start in (None, *(s.name for s in model.starts)):
        try:
            u, _ = model.start_point(start)
        except NotFiniteError:  # a start that does not exist for these parameters
            continue
        point = dict(zip(model.state_names, u, strict=True))
        for i, pair in enumerate(oscillators.pairs):
            w = float(evaluate(oscillators.frequency(i), values))
            largest = max(largest, abs(point[pair.position]), abs(point[pair.velocity]) / w)
    return 4.0 * largest


class _Averager:
    def __init__(self, oscillators: WeakOscillators, setting: Setting) -> None:
        self.oscillators, self.setting = oscillators, setting
        self.known: dict[tuple[Expression, int], RadialAverage] = {}
        self.states = oscillators.places()
        self.harmonics = oscillators.harmonics

    def equation(self, i: int, position: Expression, velocity: Expression) -> AmplitudeEquation:
        radial: dict[int, list[tuple[Expression, RadialAverage]]] = {i: []}
        parts = []
        products: dict[Powers, Complex] = {}
        general = []
        linear: list[tuple[Complex, int]] = []
        own = self.harmonics[i]
        omega = self.oscillators.frequency(i)
        for is_force, perturbation in ((True, velocity), (False, position)):
            unit = power(omega, number(-1)) if is_force else number(1)
            for coefficient, term in additive_terms(perturbation, self.oscillators.mask):
                members = self.oscillators.members(term)
                coefficient = cancelled(coefficient)
                if not members or coefficient is ZERO:
                    continue  # a constant has no mean over a turn against sin and cos
                powers = None if members == (i,) else state_powers(term, self.states)
                if any(self.oscillators.responds(k) for k in members):
                    linear += self.responding(members, powers, mul(coefficient, unit), own, is_force)
                elif powers is not None:
                    self.add_products(products, powers, mul(coefficient, unit), own, is_force)
                elif self.is_radial(members, own):
                    function = self.one_oscillator(term, members[0])
                    average = self.average(function, own)
                    parts.append((coefficient, function, average))
                    as_force = average if is_force else _as_force(average, omega)
                    radial.setdefault(members[0], []).append((coefficient, as_force))
                else:
                    general.append(General(coefficient, term, is_force))
        averages = {j: combined(terms, self.setting.positive) for j, terms in radial.items()}
        return AmplitudeEquation(averages, products, tuple(general), tuple(linear), tuple(parts))

    def responding(
        self,
        members: tuple[int, ...],
        powers: StatePowers | None,
        coefficient: Expression,
        target: int,
        is_force: bool,
    ) -> list[tuple[Complex, int]]:
        """A response enters linearly; only its first harmonic is known."""
        if powers is None or sum(powers.values()) != 1:
            raise InputError(
                "averaging: a slaved velocity with dry friction, and the sign of it, may enter other equations "
                "linearly only, with coefficients in the parameters"
            )
        single: dict[Powers, Complex] = {}
        self.add_products(single, powers, coefficient, target, is_force)
        return [(c, members[0]) for c in single.values()]

    def is_radial(self, members: tuple[int, ...], harmonic: int) -> bool:
        """One oscillator alone, with the frequency of the equation."""
        return len(members) == 1 and members[0] < self.oscillators.count and self.harmonics[members[0]] == harmonic

    def mean(self, rate: Expression) -> MeanEquation:
        """<rate>: what stays of a slow state's rate."""
        constant: list[Expression] = []
        products: dict[Powers, Complex] = {}
        radial, general = [], []
        for coefficient, term in additive_terms(rate, self.oscillators.mask):
            members = self.oscillators.members(term)
            powers = state_powers(term, self.states) if members else None
            if any(self.oscillators.responds(k) for k in members):
                self.responding(members, powers, coefficient, 0, False)
            elif not members:
                constant.append(mul(coefficient, term))
            elif powers is not None:
                self.add_products(products, powers, coefficient, 0, False)
            elif len(members) == 1 and members[0] < self.oscillators.count:
                radial.append((members[0], combined([(coefficient, self.mean_times_radius(term, members[0]))])))
            else:
                general.append(General(coefficient, term, False))
        return MeanEquation(add(*constant), products, tuple(radial), tuple(general))

    def mean_times_radius(self, term: Expression, j: int) -> RadialAverage:
        """r <f> in place of C: <f> = <f (cos^2 + sin^2)> = (<f x cos> - <f y sin>/omega)/r."""
        function = self.one_oscillator(term, j)
        omega = self.oscillators.frequency(j)
        along = self.average(mul(function, symbol(X)), self.harmonics[j])
        across = self.average(mul(function, symbol(Y)), self.harmonics[j])
        inverse = neg(power(omega, number(-1)))
        pieces = tuple(Piece(p.high, p.bound, ZERO, p.cos, p.arcs, p.nodes) for p in along.pieces)
        others = tuple(Piece(p.high, p.bound, ZERO, scaled(p.sin, inverse), p.arcs, p.nodes) for p in across.pieces)
        parts = [
            (number(1), RadialAverage(pieces, along.presumes, along.limits)),
            (number(1), RadialAverage(others, across.presumes, across.limits)),
        ]
        return combined(parts, self.setting.positive)

    def one_oscillator(self, term: Expression, i: int) -> Expression:
        pair = self.oscillators.pairs[i]
        return substitute([term], {symbol(pair.position): symbol(X), symbol(pair.velocity): symbol(Y)})[0]

    def average(self, function: Expression, harmonic: int) -> RadialAverage:
        key = (function, harmonic)
        if key not in self.known:
            setting = replace(self.setting, omega=mul(number(harmonic), self.setting.omega))
            self.known[key] = average_over_turn(function, setting)
        return self.known[key]

    def add_products(
        self,
        products: dict[Powers, Complex],
        powers: StatePowers,
        coefficient: Expression,
        target: int,
        is_force: bool,
    ) -> None:
        """The mean of coefficient * product * exp(-i target omega t), of a force times -i."""
        plain = self.harmonics[: self.oscillators.count + len(self.oscillators.phasors)]
        responds = any(self.oscillators.responds(k) for k, _ in powers)
        monomials, omegas = resonant_part(powers, self.harmonics if responds else plain, target)
        scale = mul(coefficient, power(self.setting.omega, number(omegas)))
        for key, (a, b) in monomials.items():
            if is_force:
                a, b = b, -a
            re, im = products.get(key, (ZERO, ZERO))
            products[key] = (add(re, mul(number(a), scale)), add(im, mul(number(b), scale)))


def _as_force(average: RadialAverage, omega: Expression) -> RadialAverage:
    """A perturbation E of x' = y + eps E acts like a force with S = -omega C_E and C = omega S_E."""
    pieces = tuple(
        Piece(p.high, p.bound, mul(number(-1), omega, p.cos), mul(omega, p.sin), p.arcs, p.nodes)
        for p in average.pieces
    )
    return RadialAverage(pieces, average.presumes, average.limits)
