"""First-order averaged amplitude equations of weak oscillators, before a form is chosen.

With A = r exp(i theta), x = Re(A exp(i omega t)) and y = d/dt of that at fixed A, the equations of `WeakOscillators`
become A' = eps exp(-i omega t) (E - i F/omega). Their average over a turn has three kinds of terms: functions of one
oscillator (the own one or another), as S(r) and C(r) of an effective force; products of amplitudes; and what is
neither, which stays a function of all the amplitudes to be averaged by quadrature.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass, field

from contin.errors import InputError
from contin.model.expression import Expression, add, mul, neg, number, power
from contin.symbolic.averaging.radial import Piece, RadialAverage, Setting
from contin.symbolic.averaging.resonant import Powers
from contin.symbolic.averaging.weak import WeakOscillators

Complex = tuple[Expression, Expression]


@dataclass(frozen=True)
class General:
    """coefficient * term, a function of several oscillators without a closed average, in E or in F."""

    coefficient: Expression
    term: Expression
    is_force: bool


@dataclass(frozen=True)
class AmplitudeEquation:
    """A' in slow time: sum over j of (growth_j(r_j) + i turn_j(r_j)) exp(i theta_j), `radial`; plus c * products of
    amplitudes; plus the averages of `general`; plus c times the amplitude of the response k, `linear` = (c, k)."""

    radial: dict[int, RadialAverage]
    products: dict[Powers, Complex]
    general: tuple[General, ...]
    linear: tuple[tuple[Complex, int], ...] = ()
    parts: tuple[tuple[Expression, Expression, RadialAverage], ...] = ()
    """(coefficient, function of X and Y, its average) of every one-oscillator term, for the derivation."""


@dataclass(frozen=True)
class MeanEquation:
    """The rate of a slow state in slow time: `constant`; Re c * products of amplitudes; of `radial` (j, r_j <f>
    in place of C, a function of oscillator j); and the averages of `general`."""

    constant: Expression
    products: dict[Powers, Complex]
    radial: tuple[tuple[int, RadialAverage], ...] = ()
    general: tuple[General, ...] = ()


@dataclass(frozen=True)
class SlowSystem:
    """The averaged equations of all oscillators, and of the slow states (`means`)."""

    oscillators: WeakOscillators
    setting: Setting
    equations: tuple[AmplitudeEquation, ...]
    means: tuple[MeanEquation, ...] = ()
    presumes: tuple[str, ...] = field(default=())

    @property
    def omega(self) -> Expression:
        """The base frequency."""
        return self.oscillators.omega

    def rates(self, i: int, j: int) -> RadialAverage:
        """growth (in place of S) and turn (in place of C) of oscillator j in the equation of i:

        growth = <E cos phi> - <F sin phi>/omega, turn = -<E sin phi> - <F cos phi>/omega.
        """
        average = self.equations[i].radial[j]
        scale = neg(power(self.oscillators.frequency(i), number(-1)))
        pieces = tuple(
            Piece(p.high, p.bound, scaled(p.sin, scale), scaled(p.cos, scale), p.arcs, p.nodes) for p in average.pieces
        )
        return RadialAverage(pieces, average.presumes, average.limits)


def scaled(formula: Expression, scale: Expression) -> Expression:
    """scale * formula, term by term."""
    return add(*(mul(scale, t) for t in formula.args)) if formula.op == "add" else mul(scale, formula)


def refuse_names(model_parameters: Iterable[str], slow: Collection[str], made: Sequence[str]) -> None:
    """The names of the averaged states and observables must be free, of parameters and of slow states."""
    taken = set(model_parameters)
    twice = [name for name in slow if made.count(name) > 1]
    if twice:
        raise InputError(
            f"averaging: the averaged model calls an amplitude, a phase or an observable {twice[0]}, and so is a slow "
            f"state or a rotator; rename {twice[0]}"
        )
    for name in made:
        if name in taken:
            raise InputError(
                f"averaging: the averaged model calls a state or an observable {name}, and so is a parameter; "
                f"rename the parameter {name}"
            )
