"""Weakly nonlinear oscillators with what moves beside them, as the averaging pass takes them.

    x_i' = y_i + eps E_i,   y_i' = -(h_i omega)^2 x_i + eps F_i,   w' = eps G,   theta' = h omega + eps G

with one base frequency omega and whole numbers h_i (1:1 resonance: all 1). Forcing and rotators enter as phasors: pairs
of symbols that stand for cos and -h omega sin of their phase, like an oscillator of amplitude 1.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from contin.model.expression import Expression, mask_of, mul, number
from contin.model.model import Model
from contin.model.parts import Limit, Oscillator
from contin.model.symbol_masks import symbol_bit


@dataclass(frozen=True)
class Phasor:
    """`pair` are the symbols of cos(phase) and -h omega sin(phase); `state` is a rotator's phase, None for forcing."""

    pair: Oscillator
    state: str | None = None


@dataclass(frozen=True)
class SlowState:
    """A state with a rate of order eps (a slow one, or a rotator's phase); `rate[k]` is the coefficient of eps^(k + 1).

    turns : h of a rotator's phase, 0 for others.
    """

    name: str
    rate: tuple[Expression, ...]
    turns: int = 0


@dataclass(frozen=True)
class Response:
    """The symbol that replaces sign(V) of a velocity with dry friction, V' = sum p_j x_j + q_j y_j - level sign(V).

    `pair` are its symbols, like an oscillator's; `drive` is {j: (p_j, q_j)}.
    """

    pair: Oscillator
    drive: Mapping[int, tuple[Expression, Expression]]
    level: Expression


@dataclass(frozen=True)
class Kick:
    """Where `when`, linear in what turns, crosses zero in this direction, states change by eps times `changes`."""

    when: Expression
    direction: str
    changes: Mapping[str, Expression]


@dataclass(frozen=True)
class WeakOscillators:
    """The oscillators' perturbations as power series in eps.

    `position[k][i]` and `velocity[k][i]` are the coefficients of eps^(k + 1) in the equations of oscillator i;
    `detuned` lists the oscillators whose own frequency was moved into F because it differs from h_i omega by order eps.
    `slaved` gives the linear states that follow the oscillators, in leading order, `limits` where they do.
    """

    model: Model
    small: str
    pairs: tuple[Oscillator, ...]
    omega: Expression
    position: tuple[tuple[Expression, ...], ...]
    velocity: tuple[tuple[Expression, ...], ...]
    detuned: tuple[int, ...] = ()
    phasors: tuple[Phasor, ...] = ()
    slow: tuple[SlowState, ...] = ()
    slaved: Mapping[str, Expression] = field(default_factory=dict)
    limits: tuple[Limit, ...] = ()
    kicks: tuple[Kick, ...] = ()
    responses: tuple[Response, ...] = ()

    @property
    def count(self) -> int:
        """Number of oscillators."""
        return len(self.pairs)

    @property
    def turning(self) -> tuple[Oscillator, ...]:
        """The oscillators, then the phasors, then the responses."""
        return (*self.pairs, *(p.pair for p in self.phasors), *(r.pair for r in self.responses))

    @property
    def harmonics(self) -> tuple[int, ...]:
        """h of all that turns."""
        return tuple(pair.harmonic for pair in self.turning)

    @property
    def mask(self) -> int:
        """The bits of all states that turn."""
        return mask_of(name for pair in self.turning for name in (pair.position, pair.velocity))

    @property
    def is_forced(self) -> bool:
        """True where time stands in the equations: phases count from the forcing's."""
        return any(phasor.state is None for phasor in self.phasors)

    @property
    def is_plain(self) -> bool:
        """Oscillators in 1:1 resonance, and nothing else."""
        return not (self.phasors or self.slow or self.slaved or self.kicks) and set(self.harmonics) == {1}

    def responds(self, i: int) -> bool:
        """True where i of `turning` is a response: its amplitude is a function of the others."""
        return i >= self.count + len(self.phasors)

    def frequency(self, i: int) -> Expression:
        """h_i omega"""
        return mul(number(self.turning[i].harmonic), self.omega)

    def members(self, term: Expression) -> tuple[int, ...]:
        """The oscillators and phasors whose symbols occur in a term."""
        return tuple(
            i
            for i, pair in enumerate(self.turning)
            if term.mask & (symbol_bit(pair.position) | symbol_bit(pair.velocity))
        )

    def places(self) -> dict[str, tuple[int, bool]]:
        """Symbol -> (which of `turning`, is it the velocity)."""
        found: dict[str, tuple[int, bool]] = {}
        for i, pair in enumerate(self.turning):
            found |= {pair.position: (i, False), pair.velocity: (i, True)}
        return found
