"""Second-order averaging: the corrections of order eps to the averaged equations.

For A' = eps f(A, t) + eps^2 g(A, t) with period T in t, let w be the zero-mean integral of f - <f> over t. Then
the averaged variables obey A' = eps <f> + eps^2 (<g> + <Df w>) (Sanders, Verhulst and Murdock, Averaging Methods in
Nonlinear Dynamical Systems, 2nd ed., sec. 2.9). The variables are the amplitudes, the slow states and the rotators.

Forces may be polynomial, and polynomial between lines in one oscillator's plane, where they may jump: the oscillation
crosses such a line with non-zero speed, and Df has a jump there times the shift of the crossing. That holds away from
r = 0 and from the amplitudes that only just reach a threshold. A force on one oscillator that depends piecewise on
another one which is itself driven piecewise by a third is refused.

Everything is a sum of terms c * prod r_j^d_j exp(i n_j theta_j); c are formulas in the parameters, and of the amplitude
of one oscillator where the cuts of its turn depend on it.
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Final

from contin.errors import InputError
from contin.machine import elementary
from contin.model.expression import ONE, PI, ZERO, Expression, add, mul, number, power, substitute, symbol
from contin.model.parts import Limit
from contin.model.printing import to_text
from contin.symbolic.averaging.amplitudes import AmplitudeEquation, MeanEquation, SlowSystem
from contin.symbolic.averaging.build_form import build_form
from contin.symbolic.averaging.complex_formulas import Complex, plus, times
from contin.symbolic.averaging.cut_turn import CutTurn, Quasi, conjugated, product
from contin.symbolic.averaging.form_polar import polar_names
from contin.symbolic.averaging.forms import AveragedForm
from contin.symbolic.averaging.pulses import PiecewiseTurn, Pulse
from contin.symbolic.averaging.radial import R, Setting
from contin.symbolic.averaging.resonant import Exponent, Powers, state_powers
from contin.symbolic.averaging.switching_lines import PLANE, X, Y
from contin.symbolic.averaging.terms import additive_terms, without_kinks
from contin.symbolic.averaging.weak import WeakOscillators
from contin.symbolic.calculus.derivatives import derivative

Shape = tuple[tuple[int, int], ...]  # for each oscillator (d, n): r^d exp(i n theta)
Entry = tuple[Expression, complex]
Mean = Callable[[int, CutTurn], Complex]  # of the turn of a region
Driven = Callable[[int, CutTurn], tuple[Sequence[Quasi], Sequence[Quasi]]]
HALF: Final = number(Fraction(1, 2))
ROUNDING: Final = 1e-13
NOT_SMOOTH: Final = "second-order averaging: the corrections are not smooth at zero amplitude; use the form polar"
LARGEST_DENOMINATOR: Final = 20000  # fractions with smaller ones are 2.5e-9 apart


@dataclass(frozen=True)
class Wave:
    """c * shape * exp(i k omega t): a term of a polynomial force."""

    coefficient: Expression
    number: complex
    shape: Shape
    k: int


Atom = Wave | Pulse
Sum = dict[Shape, list[Entry]]


def second_order_terms(
    oscillators: WeakOscillators, system: SlowSystem, form: AveragedForm
) -> tuple[AveragedForm, tuple[Limit, ...]]:
    """The form of the terms of order eps in slow time (eps^2 in t) alone: its equations, and observables of rates.

    And where they hold.
    """
    if oscillators.kicks:
        raise InputError(
            f"averaging model {oscillators.model.name} to second order takes no kicks: the event where "
            f"{to_text(oscillators.kicks[0].when)} crosses zero. Use `order: 1`, or write the kick as a pulse of small "
            "width: a force with conditions, `k/d if 0 < x < d and y > 0 else 0`"
        )
    builder = _Builder(oscillators, system.setting, form.name == "polar")
    first = builder.first_order()
    equations, means = [], []
    for i in range(oscillators.count):
        own = builder.atoms(oscillators.velocity[1][i], oscillators.harmonics[i], oscillators.frequency(i))
        own += builder.atoms(oscillators.position[1][i], oscillators.harmonics[i])
        equations.append(_equation(builder.corrections(own, first[i], first), form.name == "polar"))
    for state, atoms in zip(oscillators.slow, first[len(oscillators.harmonics) :], strict=True):
        total = builder.corrections(builder.atoms(state.rate[1], 0), atoms, first)
        means.append(MeanEquation(ZERO, _equation(total, form.name == "polar").products))
    corrections = SlowSystem(oscillators, system.setting, tuple(equations), tuple(means))
    return builder.finished(build_form(corrections, form.name), form)


class _Builder:
    def __init__(self, oscillators: WeakOscillators, setting: Setting, polar: bool) -> None:
        self.oscillators, self.setting, self.polar = oscillators, setting, polar
        self.harmonics = oscillators.harmonics
        self.count = len(self.harmonics)
        self.omega = oscillators.omega
        self.inverse = power(self.omega, number(-1))
        self.states = oscillators.places()
        self.formulas: dict[Expression, tuple[int, Expression]] = {}  # symbol -> (oscillator, formula in R)
        self.at_rest: set[Expression] = set()  # those that are not 0 at small amplitudes
        self.turns = self.piecewise_turns()

    # The force as a sum of atoms --------------------------------------------------------------------------------------

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
        return replace(atom, number=1j * atom.number, shape=_shifted(atom.shape, j, 1, 1))

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
                            raised[_shifted(shape, i, 1, sign)][k + h * sign] += c * factor
                product = raised
        scale = mul(scale, power(self.omega, number(omegas)))
        return [
            Wave(scale, unit * c, shape, k - target)
            for shape, harmonics in product.items()
            for k, c in harmonics.items()
            if c != 0
        ]

    # Means ------------------------------------------------------------------------------------------------------------

    def corrections(self, second: Sequence[Atom], own: Sequence[Atom], first: Sequence[Sequence[Atom]]) -> Sum:
        """<g> + <Df w>, f the atoms `own` and g those of `second`."""
        total: Sum = defaultdict(list)
        for atom in second:
            if isinstance(atom, Pulse):
                mean = self.mean_on(atom.source, _mean_with(atom.pieces, 0))
                self.put(total, self.shape({atom.source: (atom.d, atom.h)}), atom.coefficient, atom.number, mean)
            elif atom.k == 0:
                total[atom.shape].append((atom.coefficient, atom.number))
        for atom in own:
            if isinstance(atom, Wave):
                for j, (d, n) in enumerate(atom.shape):
                    if d:
                        self.vary_wave(total, atom, j, d, n, first[j])
            else:
                self.vary_pulse(total, atom, first[atom.source])
            for state, drive in zip(self.oscillators.slow, first[self.count :], strict=True):
                slope = ZERO if state.turns else derivative(atom.coefficient, state.name)
                if slope is not ZERO:
                    self.vary_coefficient(total, replace(atom, coefficient=slope), drive)
        return total

    def put(self, total: Sum, shape: Shape, scale: Expression, factor: complex, mean: Sequence[Entry]) -> None:
        for formula, value in mean:
            at = shape
            if formula is not ONE:
                # powers of the amplitude into the formula, so that none is left to divide by
                source, inner = self.formulas[formula]
                d, n = shape[source]
                if not self.polar and formula in self.at_rest and (d < abs(n) or (d - n) % 2):
                    raise InputError(NOT_SMOOTH)
                self.formulas[formula] = (source, mul(inner, _amplitude_to(d - abs(n))))
                at = _shifted(shape, source, abs(n) - d, 0)
            total[at].append((mul(scale, formula), factor * value))

    def shape(self, powers: Mapping[int, tuple[int, int]]) -> Shape:
        return tuple(powers.get(j, (0, 0)) for j in range(self.count))

    def mean_on(self, source: int, of: Mean) -> list[Entry]:
        """A mean over the turn of an oscillator; formulas get a symbol of their own until all is done."""
        turn = self.turns[source]
        found: list[Entry] = []
        for formula, value, from_rest in turn.chained(lambda k: of(k, turn.turns[k])):
            named = formula
            if formula is not ONE:
                named = symbol(f"@mean{len(self.formulas)}")
                self.formulas[named] = (source, formula)
                self.at_rest |= {named} if from_rest else set()
            found.append((named, value))
        return found

    def vary_wave(self, total: Sum, atom: Wave, j: int, d: int, n: int, drive: Sequence[Atom]) -> None:
        """r^d e^(i n theta) = A^m conj(A)^q: m A^(m-1) conj(A)^q w + q A^m conj(A)^(q-1) conj(w)."""
        m, q = (d + n) // 2, (d - n) // 2
        for count, sign in ((m, 1), (q, -1)):
            if count:
                self.add_wave(total, atom, count, _shifted(atom.shape, j, -1, -sign), drive, sign)

    def add_wave(self, total: Sum, atom: Wave, count: int, base: Shape, drive: Sequence[Atom], sign: int) -> None:
        """count * base * <exp(i k omega t) w>, for sign = -1 with conj(w)."""
        for w in drive:
            scale = mul(atom.coefficient, w.coefficient, self.inverse)
            factor = count * atom.number * (w.number if sign > 0 else w.number.conjugate())
            if isinstance(w, Wave):
                if w.k == 0 or atom.k + sign * w.k != 0:
                    continue
                shape = _product(base, w.shape if sign > 0 else _conjugate(w.shape))
                total[shape].append((scale, factor / (1j * sign * w.k)))
            elif atom.k:
                # exp(i k omega t) = exp(i k phi) exp(-i k theta); <exp(i k phi) W> = -<exp(i k phi) W'>/(i k)
                pieces = [p if sign > 0 else conjugated(p) for p in w.pieces]
                mean = self.mean_on(w.source, _mean_with(pieces, atom.k))
                shape = _product(base, self.shape({w.source: (w.d, sign * w.h - atom.k)}))
                self.put(total, shape, scale, 1j * factor / atom.k, mean)

    def vary_pulse(self, total: Sum, atom: Pulse, drive: Sequence[Atom]) -> None:
        """r^d e^(i h theta) L(phi) with dr + i r dtheta = W = e^(-i theta) w:

        e^(i h theta) r^(d-1) (d <L Re W> + i h <L Im W> - <L Im W'>), where the last term is <L' Im W> by parts, and
        the shifts of the cuts with r. Re W = (W + conj W)/2, Im W = (W - conj W)/(2i).
        """
        s = atom.source
        for w, shape, of in self.driven(drive, s):
            scale = mul(atom.coefficient, w.coefficient, self.inverse)
            base = _shifted(shape, s, 0, -1)
            for sign in (1, -1):
                share = number(Fraction(atom.d + sign * atom.h, 2))

                def mean(
                    at: int, turn: CutTurn, of: Driven = of, sign: int = sign, share: Expression = share
                ) -> Complex:
                    own, moved = atom.pieces[at], of(at, turn)
                    values, slope = moved if sign > 0 else (conjugated(moved[0]), conjugated(moved[1]))
                    whole = turn.mean(product(own, values))
                    change = times((ZERO, number(Fraction(sign, 2))), turn.mean_product(own, slope))
                    shifts = turn.shifts(own, values, atom.jumps[at])
                    return plus(plus(times((share, ZERO), whole), change), times((mul(HALF, R), ZERO), shifts))

                at_angle = _shifted(base if sign > 0 else _conjugate(base), s, atom.d - 1, atom.h)
                factor = atom.number * (w.number if sign > 0 else w.number.conjugate())
                self.put(total, at_angle, scale, factor, self.mean_on(s, mean))

    def vary_coefficient(self, total: Sum, atom: Atom, drive: Sequence[Atom]) -> None:
        """<atom w>, w of a slow state on which the coefficient depends."""
        if isinstance(atom, Wave):
            self.add_wave(total, atom, 1, atom.shape, drive, 1)
            return
        for w, shape, of in self.driven(drive, atom.source):

            def mean(at: int, turn: CutTurn, of: Driven = of) -> Complex:
                return turn.mean(product(atom.pieces[at], of(at, turn)[0]))

            scale = mul(atom.coefficient, w.coefficient, self.inverse)
            at_angle = _shifted(shape, atom.source, atom.d, atom.h)
            self.put(total, at_angle, scale, atom.number * w.number, self.mean_on(atom.source, mean))

    def driven(self, drive: Sequence[Atom], s: int) -> Iterator[tuple[Atom, Shape, Driven]]:
        """w as a shape times a function of the phase of oscillator s: on the arcs, and its slope up to a constant."""
        for w in drive:
            if isinstance(w, Wave):
                if w.k:
                    yield w, _shifted(w.shape, s, 0, -w.k), _driven_by_wave(w.k)
            elif w.source == s:
                yield w, self.shape({s: (w.d, w.h)}), _driven_by_pulse(w.pieces)
            else:
                raise InputError(
                    "second-order averaging: piecewise forces of two different oscillators act on one; use order: 1"
                )

    def finished(self, form: AveragedForm, first: AveragedForm) -> tuple[AveragedForm, tuple[Limit, ...]]:
        """With the formulas in place of their symbols, in the form's states; and the limits of those."""
        radii, _ = polar_names(self.oscillators.count)
        modulus = [symbol(n) if n in form.states else first.observables[n] for n in radii]
        known = {name: substitute([f], {R: modulus[i]})[0] for name, (i, f) in self.formulas.items()}

        def put_in(formulas: Mapping[str, Expression]) -> dict[str, Expression]:
            return dict(zip(formulas, substitute(list(formulas.values()), known), strict=True))

        small = symbol(self.oscillators.small)
        limits: dict[Expression, Limit] = {}
        for i in dict.fromkeys(i for i, _ in self.formulas.values()):
            for limit in (*self.turns[i].limits, *self.turns[i].grazing(small)):
                margin = substitute([limit.margin], {R: modulus[i]})[0]
                limits[margin] = replace(limit, margin=margin)
        done = replace(
            form, equations=tuple(substitute(list(form.equations), known)), observables=put_in(form.observables)
        )
        return done, tuple(limits.values())


def _amplitude_to(d: int) -> Expression:
    """R^d"""
    return power(R, number(d)) if d >= 0 else power(power(R, number(2)), number(Fraction(d, 2)))


def _mean_with(pieces: Sequence[Sequence[Quasi]], k: int) -> Mean:
    """<L exp(i k phi)>"""

    def mean(at: int, turn: CutTurn) -> Complex:
        return turn.mean(product(pieces[at], _wave(k, turn, ONE)))

    return mean


def _driven_by_wave(k: int) -> Driven:
    """exp(i k phi)/(i k)"""
    inverse = number(Fraction(-1, k))

    def of(_: int, turn: CutTurn) -> tuple[Sequence[Quasi], Sequence[Quasi]]:
        return _wave(k, turn, ZERO, inverse), _wave(k, turn, ONE)

    return of


def _driven_by_pulse(pieces: Sequence[Sequence[Quasi]]) -> Driven:
    """The zero-mean antiderivative."""

    def of(at: int, turn: CutTurn) -> tuple[Sequence[Quasi], Sequence[Quasi]]:
        return turn.antiderivative(pieces[at]), pieces[at]

    return of


def _wave(k: int, turn: CutTurn, re: Expression, im: Expression = ZERO) -> tuple[Quasi, ...]:
    """(re + i im) exp(i k phi) on every arc."""
    return tuple({(0, k): (re, im)} for _ in turn.arcs)


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
                raise InputError(NOT_SMOOTH)
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
