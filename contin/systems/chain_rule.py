"""Derivatives of iterates of a map, from those of the map at every point, by the chain rule."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike

from contin.abi import Array, Vector

Subset = tuple[int, ...]  # of the directions, by their places


class Steps(Protocol):
    """What is asked of a map."""

    @property
    def n(self) -> int: ...
    @property
    def m(self) -> int: ...

    def jacobian(self, u: ArrayLike, p: ArrayLike) -> tuple[Array, Array]:
        """f (n,) and [f_u f_p] (n, n + m)."""

    def derivative(self, u: ArrayLike, p: ArrayLike, *directions: ArrayLike) -> Vector:
        """D^k f along k directions (n + m,), (n,)."""

    def derivatives(self, u: Array, p: Array, *directions: Vector) -> Vector:
        """The same at N points, (N, n): u (N, n), p (N, m), directions (N, n + m)."""


def slope_of_iterate(steps: Steps, times: int, u: ArrayLike, p: ArrayLike) -> tuple[Array, Array]:
    """f^times (n,) and its derivative in (u, p), (n, n + m)."""
    x = np.array(u, dtype=float)
    slope = np.eye(steps.n, steps.n + steps.m)
    for _ in range(times):
        x, matrix = steps.jacobian(x, p)
        slope = after(matrix, slope)
    return x, slope


def path_of_iterates(steps: Steps, times: int, u: ArrayLike, p: ArrayLike) -> Iterator[tuple[Array, Array]]:
    """u, f(u), ..., each with the map's derivatives there, (n, n + m)."""
    x = np.array(u, dtype=float)
    for _ in range(times):
        value, matrix = steps.jacobian(x, p)
        yield x, matrix
        x = value


def form_of_iterate(
    steps: Steps, path: Iterable[tuple[Array, Array]], p: ArrayLike, directions: Sequence[ArrayLike]
) -> Vector:  # fmt: skip
    """D^k f^times along k directions (n + m,), real or complex, where `path` has so many points.

    With g_j the j-th iterate on (u, p), D^k g_j[V] = sum over partitions of V of D^r f [D g_{j-1}[block], ...]
    (Faa di Bruno), carried for all subsets of the directions at once.
    """
    given = [np.asarray(d) for d in directions]
    terms, n = _terms(len(given)), steps.n
    known: dict[Subset, Vector] = {s: given[s[0]] if len(s) == 1 else np.zeros(n + steps.m) for s in terms.subsets}
    for x, matrix in path:
        added = _added(steps, terms, x, np.asarray(p, dtype=float), known)
        fresh: dict[Subset, Vector] = {}
        for s in terms.subsets:
            total: Vector = matrix @ known[s]
            for value in added[s]:
                total = total + value
            fresh[s] = np.concatenate([total, known[s][n:]])  # parameters pass through every step
        known = fresh
    return known[terms.subsets[-1]][:n]


def _added(
    steps: Steps, terms: _Terms, x: Array, p: Array, known: dict[Subset, Vector]
) -> dict[Subset, list[Vector]]:  # fmt: skip
    """D^r f [D g[block], ...] for the partitions of every subset into r >= 2 blocks, in their order."""
    added: dict[Subset, list[Vector]] = {s: [] for s in terms.subsets}
    is_real = all(v.dtype.kind != "c" for v in known.values())
    for order, wanted in terms.by_order.items():
        values: Iterable[Vector]
        if is_real and len(wanted) > 1:
            rows = [np.array([known[blocks[k]] for _, blocks in wanted]) for k in range(order)]
            points, others = (np.repeat(a[None], len(wanted), axis=0) for a in (x, p))
            values = steps.derivatives(points, others, *rows)
        else:
            values = (steps.derivative(x, p, *(known[b] for b in blocks)) for _, blocks in wanted)
        for (s, _), value in zip(wanted, values, strict=True):
            added[s].append(value)
    return added


def after(matrix: Vector, slope: Array) -> Vector:
    """[f_u f_p] applied to (A, parameters as they are): f_u A + [0 f_p]."""
    n = len(matrix)
    with np.errstate(over="ignore", invalid="ignore"):  # a point that escapes has no derivatives, and says so
        result: Vector = matrix[:, :n] @ slope
        result[:, n:] += matrix[:, n:]
    return result


@dataclass(frozen=True, eq=False)
class _Terms:
    """Non-empty subsets of 0 .. k - 1, the whole set last, and their partitions by the number of blocks."""

    subsets: list[Subset]
    by_order: dict[int, list[tuple[Subset, list[Subset]]]]


@cache
def _terms(count: int) -> _Terms:
    subsets = [tuple(i for i in range(count) if mask >> i & 1) for mask in range(1, 1 << count)]
    each = [(s, blocks) for s in subsets for blocks in _partitions(s)]
    orders = range(2, count + 1)
    return _Terms(subsets, {order: [pair for pair in each if len(pair[1]) == order] for order in orders})


@cache
def _partitions(items: tuple[int, ...]) -> list[list[tuple[int, ...]]]:
    """All partitions into blocks, each block in ascending order."""
    if not items:
        return [[]]
    first, rest = items[0], items[1:]
    found = []
    for mask in range(1 << len(rest)):
        block = (first, *(r for i, r in enumerate(rest) if mask >> i & 1))
        others = tuple(r for i, r in enumerate(rest) if not mask >> i & 1)
        found += [[block, *tail] for tail in _partitions(others)]
    return found
