"""Derivatives of iterates of a map, from those of the map at every point, by the chain rule."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from functools import cache
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike

from contin.abi import Array, Vector


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
    subsets, n = _subsets(len(given)), steps.n
    known: dict[tuple[int, ...], Vector] = {s: given[s[0]] if len(s) == 1 else np.zeros(n + steps.m) for s in subsets}
    for x, matrix in path:
        fresh: dict[tuple[int, ...], Vector] = {}
        for s in subsets:
            total: Vector = matrix @ known[s]
            for blocks in _partitions(s):
                if len(blocks) > 1:
                    total = total + steps.derivative(x, p, *(known[b] for b in blocks))
            parameters = known[s][n:]  # they pass through every step
            fresh[s] = np.concatenate([total, parameters])
        known = fresh
    return known[tuple(range(len(given)))][:n]


def after(matrix: Vector, slope: Array) -> Vector:
    """[f_u f_p] applied to (A, parameters as they are): f_u A + [0 f_p]."""
    n = len(matrix)
    with np.errstate(over="ignore", invalid="ignore"):  # a point that escapes has no derivatives, and says so
        result: Vector = matrix[:, :n] @ slope
        result[:, n:] += matrix[:, n:]
    return result


@cache
def _subsets(count: int) -> list[tuple[int, ...]]:
    """Non-empty subsets of 0 .. count - 1, the whole set included."""
    return [tuple(i for i in range(count) if mask >> i & 1) for mask in range(1, 1 << count)]


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
