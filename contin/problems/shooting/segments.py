"""The segments of an orbit: where each ends, and how its end depends on its start, the parameter and its times."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.kernels.floquet import deflate, multipliers
from contin.problems.shooting.layout import Nodes, moving
from contin.problems.shooting.sizes import absolute_tolerances
from contin.simulate.flight import Flight, fly
from contin.simulate.natural import filled

if TYPE_CHECKING:
    from contin.problems.shooting.shot_family import ShotFamily



@dataclass(frozen=True, eq=False)
class Segments:
    """All segments integrated with their variational equations; None values where a flight failed.

    R_i = phi(u_i) - u_(i+1) (the last: minus the winding and u_1), then normal . u_1 - offset, or T - forcing period.
    """

    problem: ShotFamily
    nodes: Nodes
    flights: tuple[Flight, ...]
    others: tuple[int, ...] = ()  # further parameters that derivatives are carried for

    @classmethod
    def of(cls, problem: ShotFamily, z: Array, others: tuple[int, ...] = ()) -> Segments | None:
        """None where the trajectory does not come to the end of a segment."""
        nodes = Nodes.of(z, problem.n)
        if not (nodes.period > 0.0 and np.all(np.isfinite(z))):
            return None
        n, p = problem.n, problem.full_parameters(z)
        identity = np.hstack([np.eye(n), np.zeros((n, 1 + len(others)))])
        columns = np.append(np.full(n, -1), n + np.array([problem.active, *others]))
        length = nodes.period / nodes.count
        atol = absolute_tolerances(problem, nodes, p, problem.accuracy)
        flights = []
        for i, u in enumerate(nodes.u if problem.fixed is None else problem.fixed.onto(nodes.u)):
            flight = fly(
                problem.system, u, p, length, start=i * length, variations=identity, columns=columns,
                rtol=problem.accuracy, atol=atol, budget=problem.budget, pieces=problem.held.get(i),
            )  # fmt: skip
            if flight.outcome != "done" or not np.all(np.isfinite(flight.end)):
                return None
            flights.append(flight)
        return cls(problem, nodes, tuple(flights), others)

    @cached_property
    def transitions(self) -> Array:
        """Fundamental matrices of the segments, (M, n, n)."""
        n = self.problem.n
        found = np.array([f.variations[:, :n] for f in self.flights])
        return found if self.problem.fixed is None else self.problem.fixed.split(found)

    @cached_property
    def ends(self) -> Array:
        """States at the ends of the segments, (M, n)."""
        return self._kept(np.array([f.end[: self.problem.n] for f in self.flights]))

    def _kept(self, vectors: Array) -> Array:
        """Changes of states (K, n) in the fixed space of the orbits, where they have one."""
        return vectors if self.problem.fixed is None else self.problem.fixed.onto(vectors)

    @cached_property
    def directions(self) -> Array:
        """The vector field at the nodes, (M, n)."""
        return self._field(self.nodes.u, 0)

    def _field(self, states: Array, shift: int) -> Array:
        problem, p = self.problem, self.problem.full_parameters(self.nodes.vector())
        length = self.nodes.period / self.nodes.count
        values = []
        for i, u in enumerate(states):
            if problem.system.is_forced:
                p[-1] = (i + shift) * length
            values.append(problem.system.value(u, p))
        return np.array(values)

    @cached_property
    def residual(self) -> Array:
        """(M n + 1,), in the model's units."""
        nodes = self.nodes
        following = np.vstack([nodes.u[1:], nodes.u[:1] + self.problem.winding])
        return np.append(self._kept(self.ends - following).ravel(), self._phase[0])

    @cached_property
    def _phase(self) -> tuple[float, Array]:
        """The last equation and its row (M n + 2,)."""
        problem, nodes, n = self.problem, self.nodes, self.problem.n
        row = np.zeros(nodes.u.size + 2)
        if problem.autonomous:
            row[:n] = nodes.normal
            return float(nodes.normal @ nodes.u[0] - nodes.offset), row
        period, derivative = problem.forcing_period(nodes.parameter)
        row[-2], row[-1] = 1.0, -derivative
        return nodes.period - period, row

    @cached_property
    def jacobian(self) -> Array:
        """(M n + 1, M n + 2) by (states, T, p), in the model's units."""
        nodes, n = self.nodes, self.problem.n
        count, size = nodes.count, nodes.u.size
        matrix = np.zeros((size + 1, size + 2))
        ending = self._field(self.ends, 1)
        for i in range(count):
            rows = slice(i * n, (i + 1) * n)
            matrix[rows, rows] += self.transitions[i]
            after = (i + 1) % count
            matrix[rows, after * n : (after + 1) * n] -= np.eye(n)
            matrix[rows, size] = (i + 1) / count * ending[i] - i / count * self.transitions[i] @ self.directions[i]
            matrix[rows, size + 1] = self._kept(self.flights[i].variations[:, n])
        matrix[-1] = self._phase[1]
        return matrix

    @cached_property
    def by_others(self) -> Array:
        """(M n + 1, k) by the further parameters, in the model's units."""
        problem, n = self.problem, self.problem.n
        end = np.zeros((1, len(self.others)))
        if not problem.autonomous:
            z = self.nodes.vector()
            for k, other in enumerate(self.others):
                across = problem.with_active(problem.system.parameter_names[other], z)
                end[0, k] = -across.forcing_period(float(across.base[other]))[1]
        return np.vstack([*(self._kept(f.variations[:, n + 1 :].T).T for f in self.flights), end])

    def row_units(self, scale: Array) -> Array:
        """Units of the equations, (M n + 1,)."""
        nodes, n = self.nodes, self.problem.n
        sizes = scale[:n] / np.sqrt(n * nodes.count)
        row = self._phase[1] * scale[moving(len(scale), n)]
        return np.append(np.tile(sizes, nodes.count), max(float(np.linalg.norm(row)), 1e-300))

    def scaled(self, scale: Array) -> tuple[Array, Array]:
        """Residual and Jacobian in scaled unknowns and equations."""
        units = self.row_units(scale)
        return self.residual / units, self.jacobian * scale[moving(len(scale), self.problem.n)] / units[:, None]

    def multipliers(self) -> NDArray[np.complex128]:
        """Multipliers, the trivial one of an autonomous system first; NaN where they cannot be computed."""
        n, skip = self.problem.n, 1 if self.problem.autonomous else 0
        turning = np.abs(self.directions) * self.nodes.period / (2.0 * np.pi)  # a state may be 0 at the only node
        sizes = np.maximum(np.abs(self.nodes.u), turning).max(axis=0)
        if np.all(np.isfinite(self.transitions)):
            sizes = filled(sizes, np.abs(self.transitions).mean(axis=0))[0]  # those that are next to zero
        sizes = np.where(sizes > 0.0, sizes, 1.0)
        matrices = np.ascontiguousarray(self.transitions * sizes / sizes[:, None])
        values = np.full(n, np.nan, complex)
        directions = np.ascontiguousarray(self.directions / sizes)
        if skip:
            if not np.all(np.linalg.norm(directions, axis=1) > 0.0):
                return values
            values[0] = deflate(matrices, directions)
        re, im = np.full(n - skip, np.nan), np.full(n - skip, np.nan)
        basis = np.full((n - skip, n - skip), np.nan)
        if n > skip and not multipliers(matrices, skip, basis, re, im):
            re[:] = np.nan
        values[skip:] = re + 1j * im
        return values
