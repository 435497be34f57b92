"""Derivatives of the return (Poincare) map of a cycle, of any order, on a section across it.

The flow over the period, phi, has D^k phi [d_1, .., d_k] = v_D(T) for the directions D = {d_1, .., d_k} at gamma(0):

    v_D' = f_u v_D + sum D^j f [v_B1, .., v_Bj]     over the partitions of D into j >= 2 blocks (Faa di Bruno),

v_D(0) = d of one direction, 0 of several. All orders have one matrix; with the collocation equations of the orbit's own
mesh the errors at its ends are of order 2 m, as the orbit's (the whole is one system of equations, collocated).

The trajectory through phi(y) comes to the section <n, x - gamma(0)> = 0, n along f in the states' sizes, after a time
tau(y) more: w(1) of w' = tau f(w) (in theta = t / tau), w(0) = phi(y). The derivatives of w along D are polynomials in
theta of degree |D|, those of tau follow from <n, w_D(1)> = 0. Of a forced cycle phi is the map.

Coordinates: an orthonormal basis of the section, in the states' sizes. What goes once round the cycle is the
discretisation's own (`AlongCycle`).
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from functools import cached_property, lru_cache
from typing import Final, Protocol

import numpy as np

from contin.abi import Array
from contin.kernels.collocation_basis import basis
from contin.normalforms.jet import DerivativeJet, Real
from contin.problems.orbits.linearised.linear import OrbitLinear
from contin.problems.orbits.normal_forms.normal_form import Forms

HIGHEST: Final = 5  # order; of Gauss points in theta, with which polynomials of that degree are integrated

Key = tuple[int, ...]  # directions, by number, in order; of several that are equal each is named


class AlongCycle(Protocol):
    """The linearised flow along a cycle, in the states' sizes; functions are their values at the mesh's points."""

    @property
    def is_forced(self) -> bool: ...

    @property
    def field_at_start(self) -> Array:
        """f at the first node, (n,)."""

    def once_round(self, start: Array, right: Array | None) -> tuple[Array, Array]:
        """The solution from `start` (n,) with a right-hand side at the points: there, and at the end (n,)."""

    def apply(self, *functions: Array) -> Array:
        """D^k f [w_1, .., w_k] at the points."""

    def apply_at_start(self, *functions: Array) -> Array:
        """The same at the first node, functions (K, n)."""


@dataclass(frozen=True, eq=False)
class Collocated:
    """That of an orbit by collocation, with its own equations."""

    linear: OrbitLinear

    @property
    def is_forced(self) -> bool:
        return not self.linear.problem.autonomous

    @cached_property
    def field_at_start(self) -> Array:
        return np.asarray(self.linear.field[0] / self.linear.sizes)

    @cached_property
    def _forms(self) -> Forms:
        return Forms(self.linear)

    @cached_property
    def _local(self) -> tuple[Array, Array]:
        """Of each interval: the inverse for all nodes but the first, and what it makes of the first node's values."""
        profile, sizes = self.linear.profile, self.linear.sizes
        n, m, count = profile.n, profile.m, profile.intervals
        blocks = self.linear._local(self.linear.state_derivatives, -profile.h * profile.period, True)
        blocks = (blocks * sizes / sizes[:, None, None]).reshape(count, m * n, (m + 1) * n)
        inverse = np.asarray(np.linalg.inv(blocks[:, :, n:]), float)
        return inverse, -inverse @ blocks[:, :, :n]

    def apply(self, *functions: Array) -> Array:
        sizes = self.linear.sizes
        return self._forms.apply(*(v * sizes for v in functions)) / sizes

    def once_round(self, start: Array, right: Array | None) -> tuple[Array, Array]:
        profile, (inverse, transfer) = self.linear.profile, self._local
        n, m, count = profile.n, profile.m, profile.intervals
        forced: Array = np.zeros((count, m * n))
        if right is not None:
            scaled = (profile.h * profile.period)[:, None, None] * right
            forced = np.einsum("iab,ib->ia", inverse, scaled.reshape(count, m * n))
        ends = np.empty((count + 1, n))
        ends[0] = start
        for k in range(count):
            ends[k + 1] = transfer[k, -n:] @ ends[k] + forced[k, -n:]
        inner = (np.asarray(np.einsum("iab,ib->ia", transfer, ends[:-1])) + forced).reshape(count, m, n)
        nodes = np.concatenate([ends[:-1, None], inner], axis=1)
        return np.asarray(np.einsum("cj,ijk->ick", basis(m).values, nodes)), ends[-1]

    def apply_at_start(self, *functions: Array) -> Array:
        problem, sizes, count = self.linear.problem, self.linear.sizes, len(functions[0])
        u = np.tile(self.linear.profile.u[0], (count, 1))
        p = np.tile(problem.full_parameters(self.linear.z), (count, 1))
        still = np.zeros((count, problem.system.p_size))
        found = problem.system.derivatives(u, p, *(np.hstack([w * sizes, still]) for w in functions))
        return np.asarray(found / sizes)


@dataclass(frozen=True, eq=False)
class ReturnMap:
    """The map of a cycle at the first node of its mesh.

    like : the map of a cycle nearby, whose coordinates these are near to.
    """

    cycle: AlongCycle
    like: ReturnMap | None = None
    _starts: list[Array] = field(default_factory=list)  # directions, (n,) in the states' sizes
    _numbers: dict[bytes, int] = field(default_factory=dict)
    _along: dict[Key, tuple[Array, Array]] = field(default_factory=dict)  # v_D at the Gauss points, and at the end
    _across: dict[Key, tuple[Array, Array]] = field(default_factory=dict)  # w_D likewise
    _times: dict[Key, float] = field(default_factory=dict)  # tau_D

    @cached_property
    def axis(self) -> int:
        """Of the largest component of f."""
        return int(np.argmax(np.abs(self.cycle.field_at_start))) if self.like is None else self.like.axis

    @cached_property
    def section(self) -> Array:
        """Orthonormal columns, (n, n - 1): those of the reflection that takes n to an axis; forced: all axes."""
        n = len(self.cycle.field_at_start)
        if self.cycle.is_forced:
            return np.eye(n)
        normal = self.cycle.field_at_start / np.linalg.norm(self.cycle.field_at_start)
        mirror = normal.copy()
        mirror[self.axis] += np.copysign(1.0, normal[self.axis])
        reflection = np.eye(n) - 2.0 * np.outer(mirror, mirror) / (mirror @ mirror)
        return np.delete(reflection, self.axis, axis=1)

    def coordinates(self, x: Array) -> Array:
        """Of a vector at the first node (n,), in the states' sizes, moved along f into the section, (n - 1,)."""
        return np.asarray(x @ self.section)

    def jet(self) -> DerivativeJet:
        """The map's derivatives at its fixed point."""
        unit = np.eye(self.section.shape[1])
        matrix = np.column_stack([self._column(d) for d in unit])
        return DerivativeJet(without_rounding(matrix), self.derivative, kind="map", scale=np.ones(len(unit)))

    def _column(self, direction: Real) -> Real:
        """The derivative along a direction in which no other is wanted: nothing is kept of it."""
        column = self.derivative((direction,))
        for kept in (self._numbers, self._starts, self._along, self._across, self._times):
            kept.clear()
        return column

    def derivative(self, directions: tuple[Real, ...]) -> Real:
        """D^k of the map along directions in the section."""
        key = tuple(sorted(self._number(d) for d in directions))
        end = self._flow(key)[1] if self.cycle.is_forced else self._returned(key)[1]
        return np.asarray(end @ self.section)

    def _number(self, direction: Real) -> int:
        known = direction.tobytes()
        if known not in self._numbers:
            self._numbers[known] = len(self._starts)
            self._starts.append(self.section @ direction)
        return self._numbers[known]

    # -- once round the cycle -----------------------------------------------------------------------------------------

    def _flow(self, key: Key) -> tuple[Array, Array]:
        if key not in self._along:
            if len(key) == 1:
                self._along[key] = self.cycle.once_round(self._starts[key[0]], None)
            else:
                right = np.asarray(_sum_over_partitions(key, self.cycle.apply, lambda block: self._flow(block)[0]))
                self._along[key] = self.cycle.once_round(np.zeros(len(self.cycle.field_at_start)), right)
        return self._along[key]

    # -- on to the section --------------------------------------------------------------------------------------------

    def _returned(self, key: Key) -> tuple[Array, Array]:
        if key not in self._across:
            f, count = self.cycle.field_at_start, len(key)
            right = np.zeros((HIGHEST, len(f)))
            for chosen in range(1, 2**count - 1):
                time = tuple(d for k, d in enumerate(key) if chosen >> k & 1)
                rest = tuple(d for k, d in enumerate(key) if not chosen >> k & 1)
                self._returned(time)
                right += self._times[time] * self._field_along(rest)
            inside, end = self._integrated(self._flow(key)[1], right)
            tau = -float(f @ end) / float(f @ f)
            self._times[key] = tau
            self._across[key] = inside + tau * np.outer(basis(HIGHEST).gauss, f), end + tau * f
        return self._across[key]

    def _field_along(self, key: Key) -> Array:
        """The derivative of f(w) along directions, at the Gauss points in theta."""
        whole = self.cycle.apply_at_start(self._returned(key)[0])
        return whole + _sum_over_partitions(key, self.cycle.apply_at_start, lambda block: self._returned(block)[0])

    @staticmethod
    def _integrated(start: Array, right: Array) -> tuple[Array, Array]:
        """The polynomial in theta from `start` with this derivative at the Gauss points: there, and at 1."""
        scheme = basis(HIGHEST)
        nodes = np.vstack([start, start + np.linalg.solve(scheme.slopes[:, 1:], right)])
        return scheme.values @ nodes, nodes[-1]


def without_rounding(matrix: Array) -> Array:
    """Zero for the entries that are rounding errors beside others of their row and of their column.

    What is left of states that do not act on each other (1e-100, say) would pass for a coupling where rows are scaled.
    """
    size = np.abs(matrix)
    beside = np.minimum(size.max(axis=1)[:, None], size.max(axis=0))
    return np.where(size > np.finfo(float).eps * beside, matrix, 0.0)


def _sum_over_partitions(key: Key, apply: Callable[..., Array], function: Callable[[Key], Array]) -> Array | float:
    """Of D^j f [v_B1, .., v_Bj] over the partitions into j >= 2 blocks; 0 where there is none."""
    total: Array | float = 0.0
    for blocks, times in partitions(key):
        total = total + times * apply(*(function(block) for block in blocks))
    return total


@lru_cache(maxsize=1024)
def partitions(key: Key) -> tuple[tuple[tuple[Key, ...], int], ...]:
    """Partitions into two or more blocks, and how many there are of each where directions are equal.

    >>> partitions((0, 0, 1))
    ((((0,), (0, 1)), 2), (((0, 0), (1,)), 1), (((0,), (0,), (1,)), 1))
    """
    counted = Counter(tuple(sorted(blocks)) for blocks in _partitions(key) if len(blocks) > 1)
    return tuple(sorted(counted.items(), key=lambda item: (len(item[0]), item[0])))


def _partitions(key: Key) -> Iterator[tuple[Key, ...]]:
    if not key:
        yield ()
        return
    first, rest = key[0], key[1:]
    for blocks in _partitions(rest):
        yield ((first,), *blocks)
        for k, block in enumerate(blocks):
            yield (*blocks[:k], (first, *block), *blocks[k + 1 :])
