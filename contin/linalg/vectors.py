"""Inner products and norms, of long vectors without BLAS.

BLAS splits a dot product of more than 10,000 numbers over threads, which on a busy machine wait milliseconds for
each other.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from functools import lru_cache

import numpy as np

from contin.abi import Array, Vector
from contin.kernels import long_rows
from contin.machine.threads import PART, in_parts

LONG = 1000  # numbers; up to here BLAS stays on one thread


def dot(a: Vector, b: Vector) -> float:
    """sum a_i b_i of real vectors."""
    if a.size <= LONG:
        return float(a.dot(b))
    if _are_long(a, b):
        return float(inner(a[None], b[None])[0, 0])
    return float(np.einsum("i,i->", a, b))


def norm(a: Vector) -> float:
    """Euclidean norm of a real or complex vector."""
    if a.size <= LONG:
        return math.sqrt(np.vdot(a, a).real)
    if _are_long(a):
        return math.sqrt(float(inner(a[None], a[None])[0, 0]))
    return math.sqrt(float(np.einsum("i,i->", a, a.conj()).real))


def norm_in_units(a: Array, units: Array) -> float:
    """|a / units|"""
    if not _are_long(a, units):
        return norm(a / units)

    def add(first: int, last: int, out: Array) -> None:
        out[0] = long_rows.square_in_units(a, units, first, last)

    return math.sqrt(float(_summed(a.size, add, (1,))[0]))


def combined(columns: Array, weights: Array) -> Array:
    """sum_j w_j columns_j of long columns (n, k)."""
    return np.asarray(np.einsum("ij,j->i", columns, weights))


def plus_combined(x: Array, columns: Array, weights: Array, out: Array) -> None:
    """out = x + sum_j w_j columns_j; out may be longer."""
    n, count = columns.shape
    if count == 1 and _are_long(x, column := columns[:, 0]) and weights.dtype == float:
        _add_multiple(x, column, float(weights[0]), out)
    else:
        np.add(x, combined(columns, weights), out=out[:n])


def _add_multiple(x: Array, row: Array, weight: float, out: Array) -> None:
    """out = x + weight row"""
    in_parts(0, len(row), lambda a, b: long_rows.add_multiple(x, row, weight, a, b, out))


def products(columns: Array, x: Vector) -> Vector:
    """columns^T x (no conjugate) of long columns (n, k)."""
    if columns.shape[1] == 1 and _are_long(x, column := columns[:, 0]):
        return np.asarray(inner(column[None], x[None])[0])
    return np.asarray(np.einsum("ij,i->j", columns, x))


def inner(a: Array, b: Array) -> Array:
    """<a_i, b_j> of real rows (k, n) and (l, n) that lie one after the other in memory."""
    return _summed(
        a.shape[1], lambda first, last, out: long_rows.products_of_rows(a, b, first, last, out), (len(a), len(b))
    )


def mixed(weights: Array, rows: Array, added_to: Array | None = None) -> Array:
    """sum_j w_ij rows_j, real (k, n), added to rows that are changed in place where there are some."""
    out = np.zeros((len(weights), rows.shape[1])) if added_to is None else added_to
    weights = np.ascontiguousarray(weights)
    in_parts(0, rows.shape[1], lambda a, b: long_rows.add_combinations(weights, rows, a, b, out))
    return out


def combination(weights: Vector, rows: Sequence[Vector]) -> Vector:
    """sum_j w_j rows_j (n,)."""
    if not (_are_long(*rows) and weights.dtype == float):
        return np.asarray(np.einsum("i,ij->j", weights, np.array(rows)))
    total = float(weights[0]) * rows[0]
    for weight, row in zip(weights[1:].tolist(), rows[1:], strict=True):
        _add_multiple(total, row, weight, total)
    return np.asarray(total)


def added_and_multiplied(weights: Array, rows: Array, w: Array) -> Array:
    """w + sum_j weights_j rows_j, in place; its products with the rows (k, n), and behind them with itself."""
    return _summed(
        w.size, lambda first, last, out: long_rows.add_and_multiply(weights, rows, w, first, last, out),
        (len(rows) + 1,),
    )  # fmt: skip


def _are_long(*vectors: Array) -> bool:
    """Real, one number after the other, and so many that it pays to share them among threads."""
    return all(v.size > PART and v.dtype == float and v.flags.c_contiguous for v in vectors)


def _summed(n: int, add: Callable[[int, int, Array], None], shape: tuple[int, ...]) -> Array:
    """The sum of what `add(first, last, out)` makes of each part of n numbers, in their order."""
    if n <= PART:
        total: Array = np.empty(shape)
        add(0, n, total)
        return total
    found = np.empty((-(-n // PART), *shape))
    in_parts(0, n, lambda first, last: add(first, last, found[first // PART]))
    total = found[0]
    for one in found[1:]:
        total += one
    return total


@lru_cache(maxsize=4)
def generic(n: int) -> Array:
    """A vector (n,) of length 1 with no pattern, the same wherever it is asked for; its last component is 0."""
    r = np.append(np.random.default_rng(7).uniform(-1.0, 1.0, n - 1), 0.0)
    return np.asarray(r / norm(r))
