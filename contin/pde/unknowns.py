"""Which values are unknowns, and every derivative at every node as a linear function of them and of boundary data.

With u (n,) the unknowns, b the right-hand sides at nodes that conditions determine, g the slopes at ends of meshes of
differences, a slot is s = S u + T b + G g. A value that a condition gives leaves the unknowns; so does
every node at an end of a Chebyshev axis where conditions for slopes can be solved for the values at the ends once for
all: the slope is a number times the value, plus what depends on no field. Where it is more the end's value stays an
unknown, and the condition is its equation (`held`): an algebraic one, whose mass is 0. On a mesh
of differences with a given slope the end's value stays an unknown, and the slope enters the stencil.
At a corner a value goes before a slope, and the first axis before the second.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_matrix, identity, vstack
from scipy.sparse.linalg import splu

from contin.abi import Vector
from contin.errors import InputError
from contin.model.evaluate import evaluate
from contin.model.expression import ZERO, Expression, substitute, symbol, symbols_in
from contin.pde.conditions import SideCondition
from contin.pde.grid import Grid
from contin.pde.slots import Slot
from contin.symbolic.calculus.derivatives import derivative


@dataclass(frozen=True, eq=False)
class Data:
    """Boundary data of one condition: `right` at `nodes`, in the places `at` of b or g."""

    right: Expression
    nodes: NDArray[np.intp]
    at: slice


@dataclass(frozen=True, eq=False)
class Held:
    """A condition that is the equation of values at the ends of an axis: the slope `slot` of a field is `right`."""

    slot: Slot
    right: Expression
    nodes: NDArray[np.intp]


@dataclass(frozen=True, eq=False)
class LinearMap:
    """s = S u + T b + G g at all nodes."""

    S: csr_matrix
    T: csr_matrix
    G: csr_matrix

    def __call__(self, u: Vector | None, b: Vector, g: Vector | None) -> Vector:
        """s, without what is given as None."""
        total = self.T @ b if u is None else self.S @ u
        if u is not None and self._counts[0]:
            total = total + self.T @ b
        return np.asarray(total + self.G @ g if g is not None and self._counts[1] else total)

    @cached_property
    def _counts(self) -> tuple[int, int]:
        """Entries of T and G, which scipy counts anew each time."""
        return int(self.T.nnz), int(self.G.nnz)

    def rows(self, nodes: NDArray[np.intp]) -> LinearMap:
        """The same at some nodes."""
        return LinearMap(self.S[nodes], self.T[nodes], self.G[nodes])


@dataclass(frozen=True, eq=False)
class _Determined:
    """A field's nodes that conditions determine: B U = b there."""

    nodes: NDArray[np.intp]
    rows: csr_matrix  # (nodes, all nodes)
    data: list[Data]


class Unknowns:
    """The layout of u, b and g, and the maps of all fields."""

    def __init__(self, grid: Grid, fields: Sequence[str], conditions: Sequence[SideCondition]) -> None:
        self.grid, self.fields = grid, tuple(fields)
        self.values: list[Data] = []  # b
        self.slopes: list[Data] = []  # g
        self.held: list[Held] = []
        self._conditions = {f: [c for c in conditions if c.field == f] for f in fields}
        self._next = {"b": 0, "g": 0}
        determined = {f: self._determined(f) for f in fields}
        self.free = {f: np.setdiff1d(np.arange(grid.size), determined[f].nodes) for f in fields}
        self._slope_at = {f: self._ghosts(f) for f in fields}
        order = np.concatenate([self.free[f] * len(fields) + k for k, f in enumerate(fields)])
        rank = np.empty(len(order), np.intp)
        rank[np.argsort(order)] = np.arange(len(order))  # by node, then by field: a narrow band
        ends = np.cumsum([0, *(len(self.free[f]) for f in fields)])
        self.places = {f: rank[ends[k] : ends[k + 1]] for k, f in enumerate(fields)}
        self.n = len(order)
        if self.n == 0:
            raise InputError("the conditions determine every value; give the domain more points")
        self._values = {f: self._extended(f, determined[f]) for f in fields}

    def _counted(self, kind: str, count: int) -> slice:
        first = self._next[kind]
        self._next[kind] += count
        return slice(first, first + count)

    def _determined(self, field: str) -> _Determined:
        grid = self.grid
        taken = np.zeros(grid.size, bool)
        nodes, rows, data = [], [], []
        for condition in sorted(self._conditions[field], key=lambda c: (c.kind == "slope", c.side.axis)):
            axis = grid.axes[condition.side.axis]
            if condition.kind == "slope" and axis.by_ghosts:
                continue
            at = grid.nodes_of(condition.side)
            at = at[~taken[at]]
            taken[at] = True
            right = condition.right
            row = csr_matrix(identity(grid.size))[at]
            if condition.kind == "slope":
                affine = _affine(condition, self.fields)
                if affine is None:
                    orders = tuple(int(k == condition.side.axis) for k in range(len(grid.axes)))
                    self.held.append(Held(Slot(field, orders), right, at))
                    continue
                own, right = affine
                row = grid.along(condition.side.axis, axis.derivative(1))[at] - own * row
            if len(at):
                nodes.append(at)
                rows.append(row)
                data.append(Data(right, at, self._counted("b", len(at))))
        self.values += data
        stacked = csr_matrix(np.zeros((0, grid.size))) if not rows else csr_matrix(vstack(rows))
        return _Determined(np.concatenate([np.empty(0, np.intp), *nodes]), stacked, data)

    def _ghosts(self, field: str) -> dict[tuple[int, int], tuple[NDArray[np.intp], slice]]:
        """Slopes that enter stencils: (axis, end) -> nodes and places in g."""
        found = {}
        for condition in self._conditions[field]:
            side = condition.side
            if condition.kind == "slope" and self.grid.axes[side.axis].by_ghosts:
                nodes = np.intersect1d(self.grid.nodes_of(side), self.free[field])
                place = self._counted("g", len(nodes))
                self.slopes.append(Data(condition.right, nodes, place))
                found[side.axis, side.end] = nodes, place
        return found

    @property
    def counts(self) -> tuple[int, int]:
        """Lengths of b and g."""
        return self._next["b"], self._next["g"]

    def _extended(self, field: str, found: _Determined) -> tuple[csr_matrix, csr_matrix]:
        """(P, Q) with U = P u + Q b at all nodes."""
        size, free, places = self.grid.size, self.free[field], self.places[field]
        P = csr_matrix((np.ones(len(free)), (free, places)), shape=(size, self.n))
        Q = csr_matrix((size, self.counts[0]))
        if not len(found.nodes):
            return P, Q
        solve = splu(found.rows[:, found.nodes].tocsc()).solve
        into = csr_matrix((np.ones(len(found.nodes)), (found.nodes, np.arange(len(found.nodes)))),
                          shape=(size, len(found.nodes)))  # fmt: skip
        at = np.concatenate([np.arange(d.at.start, d.at.stop) for d in found.data])
        place = csr_matrix((np.ones(len(at)), (np.arange(len(at)), at)), shape=(len(at), self.counts[0]))
        inverse = csr_matrix(solve(np.eye(len(found.nodes))))
        P = P - into @ (inverse @ (found.rows @ P))
        return csr_matrix(P), csr_matrix(into @ (inverse @ place))

    def along(self, axis: int) -> csr_matrix:
        """d/dx along an axis, on the unknowns (n, n), where no value is given at its sides."""
        total = csr_matrix((self.n, self.n))
        for field in self.fields:
            orders = tuple(int(k == axis) for k in range(len(self.grid.axes)))
            rows = self.map_of(Slot(field, orders)).S[self.free[field]]
            places = self.places[field]
            put = csr_matrix((np.ones(len(places)), (places, np.arange(len(places)))), shape=(self.n, len(places)))
            total = total + put @ rows
        return csr_matrix(total)

    def map_of(self, slot: Slot) -> LinearMap:
        """A field's derivative at all nodes."""
        P, Q = self._values[slot.field]
        axes = [k for k, order in enumerate(slot.orders) if order]
        G = csr_matrix((self.grid.size, self.counts[1]))
        if not axes:
            return LinearMap(P, Q, G)
        ghosts = self._slope_at[slot.field]
        matrix = csr_matrix(identity(self.grid.size))
        for k in axes:
            axis, order = self.grid.axes[k], slot.orders[k]
            if not axis.by_ghosts:
                matrix = self.grid.along(k, axis.derivative(order)) @ matrix
                continue
            matrix = self._ghosted(k, order, ghosts)
            G = self._slope_part(k, order, ghosts)
        return LinearMap(csr_matrix(matrix @ P), csr_matrix(matrix @ Q), G)

    def _ghosted(
        self, k: int, order: int, ghosts: dict[tuple[int, int], tuple[NDArray[np.intp], slice]]
    ) -> csr_matrix:
        """The derivative along a mesh of differences, with stencils that use slopes where these are known."""
        axis = self.grid.axes[k]
        one_sided = self.grid.along(k, axis.derivative(order)).tolil()
        known = self.grid.along(k, axis.with_slopes(order, ((k, 0) in ghosts, (k, 1) in ghosts))[0]).tolil()
        for end in (0, 1):
            if (k, end) in ghosts:
                nodes = ghosts[k, end][0]
                one_sided[nodes] = known[nodes]
        return csr_matrix(one_sided)

    def _slope_part(
        self, k: int, order: int, ghosts: dict[tuple[int, int], tuple[NDArray[np.intp], slice]]
    ) -> csr_matrix:
        axis = self.grid.axes[k]
        rows, columns, values = [], [], []
        for end in (0, 1):
            if (k, end) not in ghosts:
                continue
            nodes, place = ghosts[k, end]
            slopes = axis.with_slopes(order, (end == 0, end == 1))[1]
            rows.append(nodes)
            columns.append(np.arange(place.start, place.stop))
            values.append(np.full(len(nodes), slopes[-end, end]))
        shape = (self.grid.size, self.counts[1])
        if not rows:
            return csr_matrix(shape)
        return csr_matrix((np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))), shape=shape)


def _affine(condition: SideCondition, fields: Sequence[str]) -> tuple[float, Expression] | None:
    """(k, rest) of a slope k u + rest at the end of a Chebyshev axis, k a number; None where it is more than that."""
    own = derivative(condition.right, condition.field)
    rest = substitute([condition.right], {symbol(condition.field): ZERO})[0]
    if symbols_in([own]) or set(fields) & set(symbols_in([rest])):
        return None
    return float(evaluate(own, {})), rest
