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

from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from typing import Final

from contin.errors import InputError
from contin.model.expression import ONE, ZERO, Expression, mul, number, power, substitute, symbol
from contin.model.parts import Limit
from contin.model.printing import to_text
from contin.symbolic.averaging.amplitudes import MeanEquation, SlowSystem
from contin.symbolic.averaging.build_form import build_form
from contin.symbolic.averaging.complex_formulas import Complex, plus, times
from contin.symbolic.averaging.cut_turn import CutTurn, conjugated, product
from contin.symbolic.averaging.form_polar import polar_names
from contin.symbolic.averaging.forms import AveragedForm
from contin.symbolic.averaging.pulses import Pulse
from contin.symbolic.averaging.radial import R, Setting
from contin.symbolic.averaging.second_order_drives import Driven, Mean, driven_by_pulse, driven_by_wave, mean_with
from contin.symbolic.averaging.second_order_forces import WeakForces
from contin.symbolic.averaging.second_order_terms import (
    NOT_SMOOTH,
    Atom,
    Entry,
    Shape,
    Sum,
    Wave,
    conjugate_of,
    equation,
    product_of,
    shifted,
)
from contin.symbolic.averaging.weak import WeakOscillators
from contin.symbolic.calculus.derivatives import derivative

HALF: Final = number(Fraction(1, 2))


def second_order_terms(
    oscillators: WeakOscillators, system: SlowSystem, form: AveragedForm
) -> tuple[AveragedForm, tuple[Limit, ...]]:
    """The terms of order eps in slow time (eps^2 in t) alone, as a form, and the limits within which they hold.

    The form has the equations of these terms, and observables of rates.
    """
    if oscillators.kicks:
        raise InputError(
            f"averaging model {oscillators.model.name} to second order takes no kicks: the event where "
            f"{to_text(oscillators.kicks[0].when)} crosses zero. Use `order: 1`, or write the kick as a pulse of small "
            "width: a force with conditions, `k/d if 0 < x < d and y > 0 else 0`"
        )
    builder = _Builder(oscillators, system.setting, form.name == "polar")
    forces = builder.forces
    first = forces.first_order()
    equations, means = [], []
    for i in range(oscillators.count):
        own = forces.atoms(oscillators.velocity[1][i], oscillators.harmonics[i], oscillators.frequency(i))
        own += forces.atoms(oscillators.position[1][i], oscillators.harmonics[i])
        equations.append(equation(builder.corrections(own, first[i], first), form.name == "polar"))
    for state, atoms in zip(oscillators.slow, first[len(oscillators.harmonics) :], strict=True):
        total = builder.corrections(forces.atoms(state.rate[1], 0), atoms, first)
        means.append(MeanEquation(ZERO, equation(total, form.name == "polar").products))
    corrections = SlowSystem(oscillators, system.setting, tuple(equations), tuple(means))
    return builder.finished(build_form(corrections, form.name), form)


class _Builder:
    """Collects <g> + <Df w>, and the formulas on the arcs of piecewise turns under names of their own."""

    def __init__(self, oscillators: WeakOscillators, setting: Setting, polar: bool) -> None:
        self.oscillators, self.polar = oscillators, polar
        self.forces = WeakForces(oscillators, setting)
        self.turns = self.forces.turns
        self.count = self.forces.count
        self.inverse = power(oscillators.omega, number(-1))
        self.formulas: dict[Expression, tuple[int, Expression]] = {}  # symbol -> (oscillator, formula in R)
        self.at_rest: set[Expression] = set()  # those that are not 0 at small amplitudes

    # Means ------------------------------------------------------------------------------------------------------------

    def corrections(self, second: Sequence[Atom], own: Sequence[Atom], first: Sequence[Sequence[Atom]]) -> Sum:
        """<g> + <Df w>, f the atoms `own` and g those of `second`."""
        total: Sum = defaultdict(list)
        for atom in second:
            if isinstance(atom, Pulse):
                mean = self.mean_on(atom.source, mean_with(atom.pieces, 0))
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
                at = shifted(shape, source, abs(n) - d, 0)
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
                self.add_wave(total, atom, count, shifted(atom.shape, j, -1, -sign), drive, sign)

    def add_wave(self, total: Sum, atom: Wave, count: int, base: Shape, drive: Sequence[Atom], sign: int) -> None:
        """count * base * <exp(i k omega t) w>, for sign = -1 with conj(w)."""
        for w in drive:
            scale = mul(atom.coefficient, w.coefficient, self.inverse)
            factor = count * atom.number * (w.number if sign > 0 else w.number.conjugate())
            if isinstance(w, Wave):
                if w.k == 0 or atom.k + sign * w.k != 0:
                    continue
                shape = product_of(base, w.shape if sign > 0 else conjugate_of(w.shape))
                total[shape].append((scale, factor / (1j * sign * w.k)))
            elif atom.k:
                # exp(i k omega t) = exp(i k phi) exp(-i k theta); <exp(i k phi) W> = -<exp(i k phi) W'>/(i k)
                pieces = [p if sign > 0 else conjugated(p) for p in w.pieces]
                mean = self.mean_on(w.source, mean_with(pieces, atom.k))
                shape = product_of(base, self.shape({w.source: (w.d, sign * w.h - atom.k)}))
                self.put(total, shape, scale, 1j * factor / atom.k, mean)

    def vary_pulse(self, total: Sum, atom: Pulse, drive: Sequence[Atom]) -> None:
        """r^d e^(i h theta) L(phi) with dr + i r dtheta = W = e^(-i theta) w:

        e^(i h theta) r^(d-1) (d <L Re W> + i h <L Im W> - <L Im W'>), where the last term is <L' Im W> by parts, and
        the shifts of the cuts with r. Re W = (W + conj W)/2, Im W = (W - conj W)/(2i).
        """
        s = atom.source
        for w, shape, of in self.driven(drive, s):
            scale = mul(atom.coefficient, w.coefficient, self.inverse)
            base = shifted(shape, s, 0, -1)
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

                at_angle = shifted(base if sign > 0 else conjugate_of(base), s, atom.d - 1, atom.h)
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
            at_angle = shifted(shape, atom.source, atom.d, atom.h)
            self.put(total, at_angle, scale, atom.number * w.number, self.mean_on(atom.source, mean))

    def driven(self, drive: Sequence[Atom], s: int) -> Iterator[tuple[Atom, Shape, Driven]]:
        """w as a shape times a function of the phase of oscillator s: on the arcs, and its slope up to a constant."""
        for w in drive:
            if isinstance(w, Wave):
                if w.k:
                    yield w, shifted(w.shape, s, 0, -w.k), driven_by_wave(w.k)
            elif w.source == s:
                yield w, self.shape({s: (w.d, w.h)}), driven_by_pulse(w.pieces)
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
