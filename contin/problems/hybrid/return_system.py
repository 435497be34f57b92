"""The map of a cycle of events as a system: its fixed points are periodic orbits of the flow with events."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from contin.abi import NO_FUNCTION, Array, Vector
from contin.normalforms.jet import expand_complex
from contin.problems.hybrid.flow import HybridFlow
from contin.problems.hybrid.landing import ACCURACY
from contin.problems.hybrid.passage import Arc, Passage, pass_through
from contin.systems.functions.derivatives import Lines
from contin.systems.protocol import form_by_form, one_by_one

if TYPE_CHECKING:
    from contin.systems.protocol import Limit, Named

KEPT: Final = 1000  # passages: a normal form, its errors and the point that follows ask for some hundred at one point
SHORTER: Final = 0.5  # differences by which those of normal forms are judged
COARSER: Final = 10.0  # ratio of the trajectories' tolerances by which places are judged
FIRST_LOOKS: Final = (1e-4, 1e-6, 1e-8)  # of the unknowns' sizes: steps that show how soon the Jacobian changes


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

    States that the last jump sets to values without states in them are no unknowns: `kept` are the others (one of
    them, where there are no others).
    sizes : of all states on the orbit.  winding : what they gain in a cycle.  stretch : of the differences' steps.
    accuracy : relative tolerance of trajectories.
    """

    flow: HybridFlow
    arcs: tuple[Arc, ...]
    winding: Array
    sizes: Array
    stretch: float = 1.0
    accuracy: float = ACCURACY

    jacobian_address = NO_FUNCTION
    kind = "map"
    is_forced = False
    n_switches = 0
    limits: tuple[Limit, ...] = ()
    observable_names: tuple[str, ...] = ()

    def rougher(self) -> ReturnSystem:
        """The same map by shorter differences and less accurate trajectories: how far its results depend on both."""
        return replace(self, stretch=SHORTER, accuracy=COARSER * ACCURACY)

    def finer(self) -> ReturnSystem:
        """The same map by more accurate trajectories."""
        return replace(self, accuracy=ACCURACY / COARSER)

    @cached_property
    def model(self) -> Returning:
        return Returning(self.flow)

    @cached_property
    def entered(self) -> NDArray[np.bool_]:
        """Of all states, those that begin a cycle with values without states in them."""
        return self.flow.is_entered((self.arcs[-1].event, *self.arcs[-1].then))

    @cached_property
    def kept(self) -> NDArray[np.intp]:
        """Places of the unknowns among all states."""
        others = np.flatnonzero(~self.entered)
        return others if len(others) else np.zeros(1, np.intp)

    def full(self, u: ArrayLike) -> Array:
        """All states; those that are no unknowns get their values when the cycle begins."""
        states = np.zeros(self.flow.n)
        states[self.kept] = u
        return states

    @property
    def n(self) -> int:
        return len(self.kept)

    @property
    def m(self) -> int:
        return self.flow.m

    @property
    def p_size(self) -> int:
        return self.m

    @property
    def state_names(self) -> tuple[str, ...]:
        return tuple(self.flow.model.state_names[k] for k in self.kept)

    @property
    def parameter_names(self) -> tuple[str, ...]:
        return self.flow.model.parameter_names

    # values ---------------------------------------------------------------------------------------------------------

    def passage(self, u: ArrayLike, p: ArrayLike) -> Passage | None:
        """The cycle from u; the last ones are kept, for they are asked for several times."""
        states, others = np.array(u, dtype=float), np.array(p, dtype=float)
        key = states.tobytes() + others.tobytes()
        if key not in self._kept:
            if len(self._kept) > KEPT:
                self._kept.clear()
            full = self.full(states)
            self._kept[key] = pass_through(self.flow, self.arcs, self.winding, full, others, self.sizes, self.accuracy)
        return self._kept[key]

    @cached_property
    def _kept(self) -> dict[bytes, Passage | None]:
        return {}

    def value(self, u: ArrayLike, p: ArrayLike) -> Array:
        """The state after the cycle, (n,)."""
        found = self.passage(u, p)
        return np.full(self.n, np.nan) if found is None else found.value[self.kept]

    def jacobian(self, u: ArrayLike, p: ArrayLike) -> tuple[Array, Array]:
        """Value and derivatives, (n, n + m)."""
        found = self.passage(u, p)
        if found is None:
            return np.full(self.n, np.nan), np.full((self.n, self.n + self.m), np.nan)
        columns = np.concatenate([self.kept, self.flow.n + np.arange(self.m)])
        return found.value[self.kept], found.matrix[np.ix_(self.kept, columns)]

    def jacobians(self, u: Array, p: Array) -> tuple[Array, Array]:
        """`jacobian` at N points."""
        return one_by_one(self.jacobian, u, p)

    def _lines(self, u: Array, p: Array, directions: Iterable[Vector]) -> Lines:
        """Directional derivatives at (u, p) by differences of the Jacobian, of offsets from there.

        Their steps are parts of the lengths over which the Jacobian changes by its own size: a burst's map may have a
        fold within a thousandth of a state's size. Those of axes along which none of the directions goes are not asked.
        """
        key = u.tobytes() + p.tobytes()
        if key not in self._lengths:
            self._lengths.clear()
            self._lengths[key] = {}
        known = self._lengths[key]
        sizes = np.concatenate([self.sizes[self.kept], np.where(p != 0.0, np.abs(p), 1.0)])
        moved = np.any([np.asarray(d) != 0.0 for d in directions], axis=0)
        for i in np.flatnonzero(moved).tolist():
            if i not in known:
                known[i] = self._bending(u, p, sizes, i)
        lengths = np.array([known.get(i, size) for i, size in enumerate(sizes.tolist())])
        return Lines(
            lambda a, b: self.value(u + a, p + b), self.stretch * lengths, False,
            lambda a, b, v: self.jacobian(u + a, p + b)[1] @ v, levels=(1.0,),
        )  # fmt: skip

    @cached_property
    def _lengths(self) -> dict[bytes, dict[int, float]]:
        return {}

    def _bending(self, u: Array, p: Array, sizes: Array, i: int) -> float:
        """Along axis i of (u, p) the length over which DP changes by its size, at most the unknown's own."""
        here, size = self.jacobian(u, p)[1] * sizes, float(sizes[i])
        for part in FIRST_LOOKS:
            step = np.where(np.arange(len(sizes)) == i, part * size, 0.0)
            sides = [self.jacobian(u + s * step[: self.n], p + s * step[self.n :])[1] * sizes for s in (1.0, -1.0)]
            change = max(float(np.abs(side - here).max()) for side in sides)
            if np.isfinite(change) and change < 0.3 * float(np.abs(here).max()):
                bend = change / (part * float(np.abs(here).max()))
                return size * min(1.0, 1.0 / bend if bend > 0.0 else 1.0)
        return FIRST_LOOKS[-1] * size

    def derivative(self, u: ArrayLike, p: ArrayLike, *directions: ArrayLike) -> Vector:
        """D^k P[d1, .., dk], directions (n + m,), real or complex."""
        nothing = np.zeros(self.n), np.zeros(self.m)
        vectors = tuple(np.asarray(d) for d in directions)
        lines = self._lines(np.array(u, dtype=float), np.array(p, dtype=float), vectors)
        with np.errstate(all="ignore"):
            return expand_complex(lambda wanted: [lines.form(*nothing, parts) for parts in wanted], vectors, self.n)

    def derivatives(self, u: Array, p: Array, *directions: Vector) -> Vector:
        """`derivative` at N points."""
        return form_by_form(self.derivative, u, p, directions)

    def gradient(self, u: ArrayLike, p: ArrayLike, v: ArrayLike) -> Vector:
        """The matrix D^2P[v, .], (n, n + m)."""
        direction = np.asarray(v)
        if np.iscomplexobj(direction):
            return self.gradient(u, p, direction.real) + 1j * self.gradient(u, p, direction.imag)
        states, others = np.array(u, dtype=float), np.array(p, dtype=float)
        beside = self._lines(states, others, (direction,))
        return beside.along(
            lambda a, b: self.jacobian(states + a, others + b)[1], np.zeros(self.n), np.zeros(self.m), direction
        )

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

    def why_not_finite(self, u: ArrayLike, p: ArrayLike) -> str | None:
        """Which event does not come."""
        if self.passage(u, p) is not None:
            return None
        done = 0
        for count in range(1, len(self.arcs)):
            if pass_through(self.flow, self.arcs[:count], self.winding, self.full(u), np.array(p), self.sizes) is None:
                break
            done = count
        return f"{self.flow.named(self.arcs[done].event)} does not come again from here"

    def why_observables_not_finite(self, u: ArrayLike, p: ArrayLike) -> str | None:
        """Nothing is observed."""
        return None

    def trouble_near(self, u: Array, p: Array) -> str | None:
        """Nothing is remembered."""
        return None
