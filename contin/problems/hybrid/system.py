"""The map of a cycle of events as a system: its fixed points are periodic orbits of the flow with events."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from contin.abi import NO_FUNCTION, Array, Vector
from contin.normalforms.jet import expand_complex
from contin.problems.functions.derivatives import Lines
from contin.problems.hybrid.flow import HybridFlow
from contin.problems.hybrid.passage import Arc, Passage, pass_through
from contin.systems.protocol import form_by_form, one_by_one

if TYPE_CHECKING:
    from contin.systems.protocol import Limit, Named


@dataclass(frozen=True, eq=False)
class Returning:
    """What reports ask of the model behind the map."""

    flow: HybridFlow
    symmetries: tuple[Named, ...] = ()

    @property
    def name(self) -> str:
        return self.flow.given.name

    def periods(self, overrides: Mapping[str, float] | None = None) -> Array:
        """Nothing is taken modulo a period here: what an angle gains in a cycle is the map's `winding`."""
        return np.zeros(self.flow.n)

    def parameter_range(self, name: str, overrides: Mapping[str, float] | None = None) -> tuple[float, float] | None:
        return self.flow.given.parameter_range(name, overrides)

    def default_parameters(self, overrides: Mapping[str, float] | None = None) -> dict[str, float]:
        return self.flow.given.default_parameters(overrides)


@dataclass(frozen=True, eq=False)
class ReturnSystem:
    """u -> the state after the cycle `arcs` of events, with derivatives by variations and by differences of those.

    sizes (n,) : of the states on the orbit.  winding (n,) : what the states gain in a cycle.
    """

    flow: HybridFlow
    arcs: tuple[Arc, ...]
    winding: Array
    sizes: Array

    jacobian_address = NO_FUNCTION
    kind = "map"
    is_forced = False
    n_switches = 0
    limits: tuple[Limit, ...] = ()
    observable_names: tuple[str, ...] = ()

    @cached_property
    def model(self) -> Returning:
        return Returning(self.flow)

    @property
    def n(self) -> int:
        return self.flow.n

    @property
    def m(self) -> int:
        return self.flow.m

    @property
    def p_size(self) -> int:
        return self.m

    @property
    def state_names(self) -> tuple[str, ...]:
        return self.flow.model.state_names

    @property
    def parameter_names(self) -> tuple[str, ...]:
        return self.flow.model.parameter_names

    # values ---------------------------------------------------------------------------------------------------------

    def passage(self, u: ArrayLike, p: ArrayLike) -> Passage | None:
        """The cycle from u; the last ones are kept, for they are asked for several times."""
        states, others = np.array(u, dtype=float), np.array(p, dtype=float)
        key = states.tobytes() + others.tobytes()
        if key not in self._kept:
            if len(self._kept) > 64:
                self._kept.clear()
            self._kept[key] = pass_through(self.flow, self.arcs, self.winding, states, others, self.sizes)
        return self._kept[key]

    @cached_property
    def _kept(self) -> dict[bytes, Passage | None]:
        return {}

    def value(self, u: ArrayLike, p: ArrayLike) -> Array:
        """The state after the cycle, (n,)."""
        found = self.passage(u, p)
        return np.full(self.n, np.nan) if found is None else found.value.copy()

    def jacobian(self, u: ArrayLike, p: ArrayLike) -> tuple[Array, Array]:
        """Value and derivatives, (n, n + m)."""
        found = self.passage(u, p)
        if found is None:
            return np.full(self.n, np.nan), np.full((self.n, self.n + self.m), np.nan)
        return found.value.copy(), found.matrix.copy()

    def jacobians(self, u: Array, p: Array) -> tuple[Array, Array]:
        """`jacobian` at N points."""
        return one_by_one(self.jacobian, u, p)

    @cached_property
    def lines(self) -> Lines:
        """Directional derivatives by differences of the Jacobian."""
        values = np.array(list(self.flow.given.default_parameters().values()))
        sizes = np.concatenate([self.sizes, np.where(values != 0.0, np.abs(values), 1.0)])
        return Lines(lambda u, p: self.value(u, p), sizes, False, lambda u, p, v: self.jacobian(u, p)[1] @ v)

    def derivative(self, u: ArrayLike, p: ArrayLike, *directions: ArrayLike) -> Vector:
        """D^k P[d1, .., dk], directions (n + m,), real or complex."""
        states, others = np.array(u, dtype=float), np.array(p, dtype=float)
        vectors = tuple(np.asarray(d) for d in directions)
        with np.errstate(all="ignore"):
            return expand_complex(
                lambda wanted: [self.lines.form(states, others, parts) for parts in wanted], vectors, self.n
            )

    def derivatives(self, u: Array, p: Array, *directions: Vector) -> Vector:
        """`derivative` at N points."""
        return form_by_form(self.derivative, u, p, directions)

    def gradient(self, u: ArrayLike, p: ArrayLike, v: ArrayLike) -> Vector:
        """The matrix D^2P[v, .], (n, n + m)."""
        direction = np.asarray(v)
        if np.iscomplexobj(direction):
            return self.gradient(u, p, direction.real) + 1j * self.gradient(u, p, direction.imag)
        states, others = np.array(u, dtype=float), np.array(p, dtype=float)
        return self.lines.along(lambda a, b: self.jacobian(a, b)[1], states, others, direction)

    # what a map of events does not have -----------------------------------------------------------------------------

    def observables(self, u: ArrayLike, p: ArrayLike) -> Array:
        """None: columns are those of the orbit."""
        return np.empty((len(np.atleast_2d(np.asarray(u))), 0))

    def symmetry(self, name: str, u: ArrayLike, p: ArrayLike) -> Array:
        """None is known."""
        raise KeyError(name)

    def switches(self, u: ArrayLike, p: ArrayLike) -> Array:
        """The map is smooth where the cycle keeps its events."""
        return np.empty(0)

    def margins(self, u: ArrayLike, p: ArrayLike) -> Array:
        """The equations are exact."""
        return np.empty((len(np.atleast_2d(np.asarray(u))), 0))

    def explain(self, u: ArrayLike, p: ArrayLike) -> str | None:
        """Which event does not come."""
        if self.passage(u, p) is not None:
            return None
        done = 0
        for count in range(1, len(self.arcs)):
            if pass_through(self.flow, self.arcs[:count], 0.0 * self.winding, np.array(u), np.array(p), self.sizes) is None:
                break
            done = count
        return f"{self.flow.named(self.arcs[done].event)} does not come again from here"

    def explain_observables(self, u: ArrayLike, p: ArrayLike) -> str | None:
        """Nothing is observed."""
        return None

    def trouble_near(self, u: Array, p: Array) -> str | None:
        """Nothing is remembered."""
        return None
