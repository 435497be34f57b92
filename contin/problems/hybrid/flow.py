"""A flow with events, made autonomous, with its surfaces, jumps and their derivatives."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.lowering.system import CompiledSystem, compile_in_time
from contin.model.expression import ZERO, Expression, depends_on, div, mul, number, substitute, symbol
from contin.model.parts import TIME, Event, State
from contin.model.printing import to_text
from contin.simulate.resets import SENSES
from contin.simulate.section import Section
from contin.symbolic.calculus.derivatives import derivative

if TYPE_CHECKING:
    from contin.model.model import Model

PHASE: Final = "phase of the forcing"  # no name in a model contains a blank
ONE: Final = number(1)
BESIDE: Final = 1e-6  # of the states' sizes: simulations are more accurate


def autonomous(model: Model) -> Model:
    """A forced flow with the phase s of the forcing, s' = 1/period, as a last state, an angle of period 1."""
    if model.forcing is None:
        return model
    period = model.forcing.period
    time = {symbol(TIME): mul(symbol(PHASE), period)}

    def change(*formulas: Expression) -> list[Expression]:
        return substitute(formulas, time)

    events = tuple(
        Event(change(e.when)[0], e.direction, dict(zip(e.jumps, change(*e.jumps.values()), strict=True)))
        for e in model.events
    )
    return model.replace(
        states=(*model.states, State(PHASE, ZERO, period=ONE)),
        equations=(*change(*model.equations), div(ONE, period)), events=events, forcing=None,
        observables=dict(zip(model.observables, change(*model.observables.values()), strict=True)),
        definitions={}, symmetries=(), starts=(), averaging=None, rotation={}, expect=(), labels={},
    )  # fmt: skip


@dataclass(frozen=True, eq=False)
class Surface:
    """At one state: h (`when`), its gradient by (u, p), (n + m,), and its rate along the flow."""

    value: float
    gradient: Array
    rate: float


@dataclass(frozen=True, eq=False)
class HybridFlow:
    """The flow of `given`, a model with events; states are those of the model, and of a forced one the phase."""

    given: Model

    def __reduce__(self) -> tuple[object, ...]:
        return HybridFlow, (self.given,)

    @cached_property
    def model(self) -> Model:
        return autonomous(self.given)

    @property
    def forced(self) -> bool:
        return self.given.forcing is not None

    @cached_property
    def n(self) -> int:
        return len(self.model.states)

    @cached_property
    def m(self) -> int:
        return len(self.model.parameters)

    @cached_property
    def described(self) -> CompiledSystem:
        """The model as it was given, without its events: names, observables."""
        return compile_in_time(self.given.replace(events=()))

    @cached_property
    def system(self) -> CompiledSystem:
        """The flow; observables are the model's, then h of every event and its gradient, and the values it sets."""
        names = [*self.model.state_names, *self.model.parameter_names]
        seen = dict(self.model.observables)
        for k, event in enumerate(self.model.events):
            for j, formula in enumerate((event.when, *event.jumps.values())):
                seen[f"event {k} {j}"] = formula
                seen |= {f"event {k} {j} by {i}": derivative(formula, name) for i, name in enumerate(names)}
        return compile_in_time(self.model.replace(events=(), observables=seen))

    @cached_property
    def _places(self) -> tuple[int, ...]:
        """Where among the observables each event's begin."""
        width, counts = 1 + self.n + self.m, [1 + len(e.jumps) for e in self.model.events]
        return tuple(len(self.model.observables) + width * sum(counts[:k]) for k in range(len(counts)))

    def seen(self, u: Array, p: Array) -> Array:
        """All observables at states (T, n)."""
        return np.asarray(self.system.observables(u, p)).reshape(len(u), len(self.system.observable_names))

    def _seen_here(self, k: int, u: Array, p: Array) -> Array:
        """What event k adds to the observables, at one state."""
        return np.asarray(self.system.observables(u, p))[self._places[k] :]

    def heights(self, k: int, u: Array, p: Array) -> Array:
        """h of event k at states (T, n)."""
        return self.seen(u, p)[:, self._places[k]]

    def surface(self, k: int, u: Array, p: Array) -> Surface:
        """The surface of event k at a state."""
        row = self._seen_here(k, u, p)
        gradient = row[1 : 1 + self.n + self.m]
        return Surface(float(row[0]), gradient, float(gradient[: self.n] @ self.system.value(u, p)))

    def is_on(self, k: int, u: Array, p: Array, sizes: Array) -> bool:
        """Whether a state of a simulation, whose states have these sizes, is on the surface of event k."""
        here = self.surface(k, u, p)
        return abs(here.value) <= BESIDE * float(np.abs(here.gradient[: self.n]) @ sizes)

    @cached_property
    def _planes(self) -> tuple[bool, ...]:
        """Of every event: whether `when` is of degree one in the states."""
        names = self.model.state_names
        return tuple(not any(depends_on(derivative(e.when, i), names) for i in names) for e in self.model.events)

    def plane(self, k: int, p: Array) -> Section | None:
        """The surface of event k in its direction at parameters p; None where it is no plane."""
        if not self._planes[k]:
            return None
        with np.errstate(all="ignore"):  # what other formulas are at the origin
            row = self._seen_here(k, np.zeros(self.n), p)
        section = Section(row[1 : 1 + self.n], -float(row[0]), int(sum(SENSES[self.model.events[k].direction])))
        return section if np.isfinite(row[: 1 + self.n]).all() and section.normal.any() else None

    def jumped(self, k: int, u: Array, p: Array) -> tuple[Array, Array]:
        """The state after event k, and its derivatives by (u, p), (n, n + m)."""
        width = 1 + self.n + self.m
        row = self._seen_here(k, u, p)
        after, matrix = u.copy(), np.eye(self.n, self.n + self.m)
        for j, name in enumerate(self.model.events[k].jumps):
            at = self.model.state_names.index(name)
            entry = row[(1 + j) * width : (2 + j) * width]
            after[at], matrix[at] = entry[0], entry[1:]
        return after, matrix

    def entered(self, events: tuple[int, ...], u: Array, p: Array) -> tuple[Array, Array]:
        """u with what these events set to values that no state enters, and its derivatives by (u, p), (n, n + m).

        A cycle that ends with them begins there. What a state has before it is set counts for nothing, but may count
        for very much in derivatives that are never used: those of a neuron's potential in its upstroke.
        """
        begun, matrix = np.array(u, dtype=float), np.eye(self.n, self.n + self.m)
        for k in events:
            after, jump = self.jumped(k, begun, p)
            for at in np.flatnonzero(self.is_entered(events) & self.is_entered((k,))):
                begun[at], matrix[at] = after[at], jump[at]
        return begun, matrix

    def is_entered(self, events: tuple[int, ...]) -> NDArray[np.bool_]:
        """(n,) true for the states that the last of these events to set them sets to such values."""
        found = np.zeros(self.n, bool)
        for k in events:
            for name, formula in self.model.events[k].jumps.items():
                found[self.model.state_names.index(name)] = not depends_on(formula, self.model.state_names)
        return found

    def named(self, k: int) -> str:
        """An event in words."""
        return f"event {k + 1} ({to_text(self.given.events[k].when)[:60]})"
