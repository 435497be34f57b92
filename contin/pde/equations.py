"""u' = F(u, p) of a discretised problem: value, sparse Jacobian and multilinear forms, all exact, by arrays.

b = B(p)                    values that conditions give
g = G(s(u, b), p)           slopes that conditions give, of fields' values beside them
F_f = f(s(u, b, g), p)      every equation at the nodes where its field is unknown
0   = G(s(u, b), p) - s     where a condition for a slope s is the equation of the value at an end: its mass is 0
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_matrix, csr_matrix, vstack

from contin.abi import Array, Vector
from contin.linalg.vectors import norm
from contin.model.expression import Expression
from contin.pde.local_formula import NOTHING, Jet, LocalFormula, Values, subsets
from contin.pde.slots import Slots
from contin.pde.unknowns import Data, LinearMap, Unknowns

CHANGES = 1e-8  # slope of a state, of its size over the circle's length, that is more than rounding
_Part = tuple[NDArray[np.intp], LocalFormula]  # places of unknowns, and their equation


class Discretised:
    """The equations of all fields on a grid."""

    def __init__(self, equations: Mapping[str, Expression], slots: Slots, unknowns: Unknowns) -> None:
        self.unknowns, self.slots, self.grid = unknowns, slots, unknowns.grid
        self.n = unknowns.n
        self._maps: dict[str, LinearMap] = {}
        self._values = [self._local(d.right, d.nodes) for d in unknowns.values]
        self._slopes = [self._local(d.right, d.nodes) for d in unknowns.slopes]
        self._equations = [part for f in unknowns.fields for part in self._parts(f, equations[f])]

    def _parts(self, field: str, equation: Expression) -> list[_Part]:
        """What determines the unknowns of a field."""
        free, places = self.unknowns.free[field], self.unknowns.places[field]
        inside, found = np.ones(len(free), bool), []
        for held in self.unknowns.held:
            if held.slot.field == field:
                at = np.isin(free, held.nodes)
                inside &= ~at
                found.append((places[at], self._local(held.right - self.slots.symbol(held.slot), free[at])))
        return [(places[inside], self._local(equation, free[inside])), *found]

    @property
    def mass(self) -> Array | None:
        """(n,) ones, and zeros where a condition is the equation; None: ones alone."""
        if not self.unknowns.held:
            return None
        mass = np.ones(self.n)
        for held in self.unknowns.held:
            field = held.slot.field
            mass[self.unknowns.places[field][np.isin(self.unknowns.free[field], held.nodes)]] = 0.0
        return mass

    def shifted_along(self, u: Array) -> str | None:
        """A circle along which the state changes and no equation does: translations along it give other solutions."""
        local = [*self._values, *self._slopes, *(part for _, part in self._equations)]
        for k, axis in enumerate(self.grid.axes):
            alike = axis.periodic and not any(axis.name in part.coordinates for part in local)
            if alike and norm(self.unknowns.along(k) @ u) > CHANGES * norm(u) / axis.length:
                return axis.name
        return None

    def map_of(self, name: str) -> LinearMap:
        """The map of a slot at all nodes."""
        if name not in self._maps:
            slot = self.slots.of(name)
            assert slot is not None
            self._maps[name] = self.unknowns.map_of(slot)
        return self._maps[name]

    def _local(self, formula: Expression, nodes: NDArray[np.intp]) -> LocalFormula:
        maps = {name: self.map_of(name).rows(nodes) for name in self.slots.used([formula])}
        coordinates = {name: x[nodes] for name, x in self.grid.coordinates.items()}
        return LocalFormula(formula, maps, coordinates, len(nodes))

    def everywhere(self, formula: Expression) -> LocalFormula:
        """A formula at all nodes, for what is observed."""
        return self._local(formula, np.arange(self.grid.size))

    # values -----------------------------------------------------------------------------------------------------------

    def boundary(self, u: Vector, p: Values) -> tuple[Vector, Vector]:
        """b and g."""
        b = _across(_joined([local.value([], p) for local in self._values]), u)
        parts = [_spread(local.value(local.slot_values(u, b, None), p), u) for local in self._slopes]
        return b, _joined(parts)

    def slot_values(self, local: LocalFormula, u: Vector, p: Values) -> list[Vector]:
        """Each slot of a formula."""
        b, g = self.boundary(u, p)
        return local.slot_values(u, b, g)

    def value(self, u: Vector, p: Values) -> Vector:
        """F (n,), real or complex; (n, K) of K states u (n, K)."""
        b, g = self.boundary(u, p)
        out = np.empty((self.n, *u.shape[1:]), np.result_type(u, float, *p.values()))
        for places, local in self._equations:
            out[places] = _spread(local.value(local.slot_values(u, b, g), p), u)
        return out

    # Jacobian ---------------------------------------------------------------------------------------------------------

    @cached_property
    def _assembly(self) -> _Assembly:
        return _Assembly(self.n, self._equations, self._slopes, self.unknowns)

    def jacobian(self, u: Array, p: Values) -> csc_matrix:
        """dF/du, exact, always with the same pattern."""
        return self.jacobians(u[:, None], p)[0]

    def jacobians(self, u: Array, p: Values) -> list[csc_matrix]:
        """dF/du at K states u (n, K)."""
        b, g = self.boundary(u, p)
        outer = [_spread(a, u) for _, q in self._equations for a in q.slopes(q.slot_values(u, b, g), p)]
        inner = [_spread(a, u) for q in self._slopes for a in q.slopes(q.slot_values(u, b, None), p)]
        both = _joined(outer), _joined(inner)
        return [self._assembly.matrix(*(x[:, k] if x.ndim == 2 else x for x in both)) for k in range(u.shape[1])]

    def forms(self, u: Array, p: Values, directions: Sequence[tuple[Array, Mapping[str, float]]]) -> Array:
        """D^k F[d_1, ..., d_k], directions as (states (n,), {parameter: rate}); at K states with directions (n, K)."""
        whole = frozenset(range(len(directions)))
        rates = [rate for _, rate in directions]
        jet_u: Jet = {NOTHING: u, **{frozenset({k}): v for k, (v, _) in enumerate(directions)}}
        b = {s: _across(x, u) for s, x in _stacked([q.jet([], p, rates, whole) for q in self._values], whole).items()}
        inner = [local.jet(_slot_jets(local, jet_u, b, None), p, rates, whole) for local in self._slopes]
        g = _stacked([{s: _spread(x, u) for s, x in jet.items()} for jet in inner], whole)
        rated = [x for rate in rates for x in rate.values()]
        out = np.empty(u.shape, np.result_type(u, float, *p.values(), *rated, *(v for v, _ in directions)))
        for places, local in self._equations:
            out[places] = _spread(local.along_all(_slot_jets(local, jet_u, b, g), p, rates, whole), u)
        return out

    def fields(self, u: Array, p: Values) -> dict[str, Array]:
        """Each field at all nodes, (size,)."""
        b, _ = self.boundary(u, p)
        return {f: np.asarray(self.map_of(f).S @ u + self.map_of(f).T @ b) for f in self.unknowns.fields}


def _joined(parts: Sequence[Vector]) -> Vector:
    return np.concatenate(parts) if parts else np.empty(0)


def _across(x: Vector, u: Vector) -> Vector:
    """What is the same for all of K states u (n, K), as one column."""
    return x[:, None] if u.ndim == 2 and x.ndim == 1 else x


def _spread(x: Vector, u: Vector) -> Vector:
    """x at every one of K states."""
    return np.broadcast_to(_across(x, u), (len(x), *u.shape[1:]))


def _stacked(jets: Sequence[Jet], whole: frozenset[int]) -> Jet:
    return {s: _joined([jet[s] for jet in jets]) for s in [NOTHING, *subsets(whole)]}


def _slot_jets(local: LocalFormula, u: Jet, b: Jet, g: Jet | None) -> list[Jet]:
    found = []
    for m in local.maps:
        found.append({s: m(u.get(s), vector, None if g is None else g[s]) for s, vector in b.items()})
    return found


class _Assembly:
    """Entries of dF/du: sums of a slope times an entry of S, and of two slopes times entries of G and S.

    outer and inner: the slopes of equations and of conditions, one array for each slot, behind each other.
    """

    def __init__(
        self,
        n: int,
        equations: Sequence[_Part],
        conditions: Sequence[LocalFormula],
        unknowns: Unknowns,
    ) -> None:
        none = np.empty(0, np.intp)
        rows, columns, factors, outer, inner = [none], [none], [np.empty(0)], [none], [none]
        chain = _rows_of_slopes(conditions, unknowns.slopes)
        first = 0
        for place, local in equations:
            for m in local.maps:
                S = m.S.tocoo()
                parts = [(S.row, S.col, S.data, np.full(S.nnz, -1))]
                if m.G.nnz and chain is not None:
                    parts.append(_chained(m.G, *chain))
                for row, column, factor, second in parts:
                    rows.append(place[row])
                    columns.append(column)
                    factors.append(factor)
                    outer.append(first + row)
                    inner.append(second)
                first += local.size
        self._factor, self._outer, self._inner = (np.concatenate(x) for x in (factors, outer, inner))
        key = np.concatenate(columns).astype(np.int64) * n + np.concatenate(rows)
        kept, self._entry = np.unique(key, return_inverse=True)
        self._count, self._n = len(kept), n
        self._indices = (kept % n).astype(np.int32)
        self._indptr = np.searchsorted(kept, np.arange(n + 1, dtype=np.int64) * n).astype(np.int32)

    def matrix(self, outer: Array, inner: Array) -> csc_matrix:
        """dF/du from the slopes."""
        terms = self._factor * outer[self._outer] * np.append(inner, 1.0)[self._inner]
        data = np.bincount(self._entry, weights=terms, minlength=self._count)
        return csc_matrix((data, self._indices, self._indptr), shape=(self._n, self._n))


def _rows_of_slopes(
    conditions: Sequence[LocalFormula], data: Sequence[Data]
) -> tuple[csr_matrix, NDArray[np.intp]] | None:
    """Entries of dg/du by rows: for every slot of every condition a copy of S; and the number of each row's slope."""
    blocks: list[Any] = []
    owners, numbers, first = [], [], 0
    for local, d in zip(conditions, data, strict=True):
        for m in local.maps:
            blocks.append(m.S)
            owners.append(np.arange(d.at.start, d.at.stop))
            numbers.append(first + np.arange(local.size))
            first += local.size
    if not blocks:
        return None
    return csr_matrix(vstack(blocks)), np.stack([np.concatenate(owners), np.concatenate(numbers)])


def _chained(
    G: csr_matrix, slopes: csr_matrix, owners: NDArray[np.intp]
) -> tuple[NDArray[np.intp], NDArray[np.intp], Array, NDArray[np.intp]]:
    """Rows, columns, factors and numbers of slopes in G diag(.) S."""
    entries = G.tocoo()
    rows, columns, factors, numbers = [], [], [], []
    by_owner: dict[int, list[int]] = {}
    for k, owner in enumerate(owners[0].tolist()):
        by_owner.setdefault(owner, []).append(k)
    for i, j, value in zip(entries.row, entries.col, entries.data, strict=True):
        for k in by_owner.get(int(j), ()):
            a, z = slopes.indptr[k], slopes.indptr[k + 1]
            columns.append(slopes.indices[a:z])
            factors.append(value * slopes.data[a:z])
            rows.append(np.full(z - a, i))
            numbers.append(np.full(z - a, owners[1][k]))
    if not rows:
        return np.empty(0, np.intp), np.empty(0, np.intp), np.empty(0), np.empty(0, np.intp)
    return np.concatenate(rows), np.concatenate(columns), np.concatenate(factors), np.concatenate(numbers)
