"""Where the entries of an orbit's sparse matrices stand; the same for all orbits on as many intervals."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, eq=False)
class Places:
    """Rows and columns of a matrix's entries in the order in which they are written, and that of their columns."""

    shape: tuple[int, int]
    row: NDArray[np.intp]
    column: NDArray[np.intp]
    order: NDArray[np.intp]
    indices: NDArray[np.int32]
    starts: NDArray[np.int32]


@lru_cache(maxsize=16)
def matrix_places(n: int, m: int, count: int, columns: bool, phase: bool, autonomous: bool) -> Places:
    """Of the blocks, the columns T and p, periodicity (of u(1), of u(0)), and the phase condition's row."""
    nu = (count * m + 1) * n
    equations, k = np.arange(nu - n), np.arange(n)
    parts = [blocks(n, m, count)]
    if columns:
        parts += [(equations, np.full(nu - n, nu)), (equations, np.full(nu - n, nu + 1))]
    parts += [(nu - n + k, nu - n + k), (nu - n + k, k)]
    if phase:
        along = np.arange(nu) if autonomous else np.array([nu, nu + 1])
        parts.append((np.full(along.size, nu), along))
    row, column = (np.concatenate(part) for part in zip(*parts, strict=True))
    shape = nu + phase, nu + 2 * columns
    order = np.lexsort((row, column))
    starts = np.concatenate([[0], np.cumsum(np.bincount(column, minlength=shape[1]))])
    return Places(shape, row, column, order, row[order].astype(np.int32), starts.astype(np.int32))


@lru_cache(maxsize=16)
def block_places(n: int, m: int, count: int) -> Places:
    """Of the blocks alone: collocation equations by the values at the nodes."""
    row, column = blocks(n, m, count)
    nu = (count * m + 1) * n
    order = np.lexsort((row, column))
    starts = np.concatenate([[0], np.cumsum(np.bincount(column, minlength=nu))])
    return Places((nu - n, nu), row, column, order, row[order].astype(np.int32), starts.astype(np.int32))


def blocks(n: int, m: int, count: int) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Rows and columns of the entries of `OrbitLinear._local`."""
    i, r, c = np.meshgrid(np.arange(count), np.arange(m * n), np.arange((m + 1) * n), indexing="ij")
    return (i * m * n + r).ravel(), (i * m * n + c).ravel()
