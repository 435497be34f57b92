"""Cycles of maps: the k-th iterate of a map as a system of its own, whose fixed points are the cycles of period k."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from contin.abi import NO_FUNCTION, Array, Vector
from contin.errors import InputError
from contin.kernels.iterates import iterate_along
from contin.systems.chain_rule import after, form_of_iterate, path_of_iterates, slope_of_iterate
from contin.systems.protocol import form_by_form, one_by_one
from contin.systems.rounded import RoundedIterates, otherwise_rounded

if TYPE_CHECKING:
    from contin.systems.protocol import Described, Limit, System

PERIOD = "period"  # the column that says how many steps a cycle has


@dataclass(frozen=True, eq=False)
class IteratedSystem:
    """u -> f(f(...f(u, p)..., p), p), `times` times, with all derivatives by the chain rule; see `iterate`.

    Observables are those of the first point of the cycle, and `period`.
    """

    base: System
    times: int

    jacobian_address = NO_FUNCTION
    kind = "map"
    is_forced = False
    limits: tuple[Limit, ...] = ()

    @property
    def model(self) -> Described:
        """The model of the map itself; its symmetries are symmetries of the iterates."""
        return self.base.model

    @property
    def n(self) -> int:
        return int(self.base.n)

    @property
    def m(self) -> int:
        return int(self.base.m)

    @property
    def p_size(self) -> int:
        return self.m

    @property
    def state_names(self) -> tuple[str, ...]:
        return tuple(self.base.state_names)

    @property
    def parameter_names(self) -> tuple[str, ...]:
        return tuple(self.base.parameter_names)

    @property
    def observable_names(self) -> tuple[str, ...]:
        return (*self.base.observable_names, PERIOD)

    @property
    def n_switches(self) -> int:
        return int(self.times * self.base.n_switches)

    # values ---------------------------------------------------------------------------------------------------------

    def orbit(self, u: ArrayLike, p: ArrayLike) -> Iterator[Array]:
        """u, f(u), ..., f^(times - 1)(u): the points of the cycle."""
        if self.base.jacobian_address != NO_FUNCTION:
            yield from self._compiled(u, p)[0][:-1]
            return
        x = np.array(u, dtype=float)
        for _ in range(self.times):
            yield x
            x = self.base.value(x, p)

    def value(self, u: ArrayLike, p: ArrayLike) -> Array:
        """f^times(u, p), (n,)."""
        if self.base.jacobian_address != NO_FUNCTION:
            return np.asarray(self._compiled(u, p)[0][-1])
        x = np.array(u, dtype=float)
        for _ in range(self.times):
            x = self.base.value(x, p)
        return x

    def observables(self, u: ArrayLike, p: ArrayLike) -> Array:
        """(N, k) at N points."""
        rows = np.atleast_2d(np.asarray(u, dtype=float))
        own = np.full((len(rows), 1), float(self.times))
        if not self.base.observable_names:
            return own
        others = np.ascontiguousarray(np.broadcast_to(np.asarray(p, dtype=float), (len(rows), self.m)))
        return np.hstack([np.atleast_2d(self.base.observables(rows, others)), own])

    def symmetry(self, name: str, u: ArrayLike, p: ArrayLike) -> Array:
        """Images of N states (N, n), or of N cycles (N, k n), point by point."""
        rows = np.atleast_2d(np.asarray(u, dtype=float))
        others = np.broadcast_to(np.asarray(p, dtype=float), (len(rows), self.m))
        points = rows.shape[1] // self.n
        repeated = np.ascontiguousarray(np.repeat(others, points, axis=0))
        return np.asarray(self.base.symmetry(name, rows.reshape(-1, self.n), repeated)).reshape(rows.shape)

    def margins(self, u: ArrayLike, p: ArrayLike) -> Array:
        """Maps hold everywhere."""
        return np.empty((len(np.atleast_2d(np.asarray(u))), 0))

    def switches(self, u: ArrayLike, p: ArrayLike) -> Array:
        """Switching functions of the map at every point of the cycle."""
        if not self.base.n_switches:
            return np.empty(0)
        return np.concatenate([self.base.switches(x, p) for x in self.orbit(u, p)])

    def why_not_finite(self, u: ArrayLike, p: ArrayLike) -> str | None:
        """Which equation is not finite at which step, or None."""
        for step, x in enumerate(self.orbit(u, p)):
            text = self.base.why_not_finite(x, p)
            if text:
                return f"step {step + 1} of {self.times}: {text}"
        return None

    def trouble_near(self, u: Array, p: Array) -> str | None:
        """As the map's."""
        text: str | None = self.base.trouble_near(u, p)
        return text

    def why_observables_not_finite(self, u: ArrayLike, p: ArrayLike) -> str | None:
        """As the map's, at the first point of the cycle."""
        text: str | None = self.base.why_observables_not_finite(u, p)
        return text

    # derivatives ----------------------------------------------------------------------------------------------------

    def jacobian(self, u: ArrayLike, p: ArrayLike) -> tuple[Array, Array]:
        """f^times (n,) and its derivative in (u, p), (n, n + m)."""
        if self.base.jacobian_address != NO_FUNCTION:
            points, slope = self._compiled(u, p)
            return points[-1], slope
        return slope_of_iterate(self.base, self.times, u, p)

    def _compiled(self, u: ArrayLike, p: ArrayLike) -> tuple[Array, Array]:
        """u and its iterates, (times + 1, n), and the last one's derivatives, (n, n + m)."""
        points = np.empty((self.times + 1, self.n))
        points[0] = u
        shape = (self.n, self.n + self.m)
        slope, matrix, fresh = np.empty(shape), np.empty(shape), np.empty(shape)
        inputs = np.ascontiguousarray(p, dtype=float)
        iterate_along(self.base.jacobian_address, points, inputs, np.empty(self.n), matrix, slope, fresh)
        return points, slope

    def jacobians(self, u: Array, p: Array) -> tuple[Array, Array]:
        """`jacobian` at N points, u (N, n) and p (N, m): (N, n) and (N, n, n + m)."""
        return one_by_one(self.jacobian, u, p)

    def derivatives(self, u: Array, p: Array, *directions: Vector) -> Vector:
        """`derivative` at N points, (N, n): u (N, n), p (N, m), directions (N, n + m)."""
        return form_by_form(self.derivative, u, p, directions)

    def derivative(self, u: ArrayLike, p: ArrayLike, *directions: ArrayLike) -> Vector:
        """D^k of the iterate along k directions (n + m,), real or complex."""
        return form_of_iterate(self.base, path_of_iterates(self.base, self.times, u, p), p, directions)

    def otherwise_rounded(self, sizes: Array | None) -> Sequence[RoundedIterates]:
        """The same with other rounding errors along the cycle, which large multipliers amplify."""
        return otherwise_rounded(self.base, self.times, sizes)

    def gradient(self, u: ArrayLike, p: ArrayLike, v: ArrayLike) -> Vector:
        """The matrix D^2 f^times [v, .], (n, n + m)."""
        along: Vector = np.asarray(v)
        x = np.array(u, dtype=float)
        slope = np.eye(self.n, self.n + self.m)
        second: Vector = np.zeros((self.n, self.n + self.m))
        for _ in range(self.times):
            value, matrix = self.base.jacobian(x, p)
            bent = self.base.gradient(x, p, along)
            with np.errstate(over="ignore", invalid="ignore"):  # whoever asks sees that it is not finite
                second = after(bent, slope) + matrix[:, : self.n] @ second
                slope = after(matrix, slope)
                along = np.concatenate([matrix @ along, along[self.n :]])
            x = value
        return second


def iterate(system: System, times: int) -> System:
    """The system of the map's `times`-th iterate (of an iterate: of the map itself, so that nothing nests)."""
    if system.kind != "map":
        raise InputError("only a map can be iterated; this is a flow")
    if isinstance(times, bool) or not isinstance(times, int) or times < 1:
        raise InputError(f"the period of a cycle is a whole number >= 1; got {times!r}")
    if isinstance(system, IteratedSystem):
        return IteratedSystem(system.base, system.times * times)
    return system if times == 1 else IteratedSystem(system, times)


def sizes_along(system: System, u: ArrayLike, p: ArrayLike) -> Array:
    """Largest moduli (n,) of the states at u and, of an iterate, at the points up to its image.

    Rounding errors of an iterate are those of all points of the cycle: at one point states may be zero.
    """
    if isinstance(system, IteratedSystem):
        return np.asarray(np.abs(list(system.orbit(u, p))).max(axis=0))
    return np.asarray(np.abs(u))
