"""Inner products and norms, of long vectors without BLAS.

BLAS splits a dot product of more than 10,000 numbers over threads, which on a busy machine wait milliseconds for
each other.
"""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np

from contin.abi import Array, Vector
from contin.kernels.long_rows import add_combinations, products_of_rows

LONG = 1000  # numbers; up to here BLAS stays on one thread


def dot(a: Vector, b: Vector) -> float:
    """sum a_i b_i of real vectors."""
    if a.size <= LONG:
        return float(a.dot(b))
    return float(np.einsum("i,i->", a, b))


def norm(a: Vector) -> float:
    """Euclidean norm of a real or complex vector."""
    if a.size <= LONG:
        return math.sqrt(np.vdot(a, a).real)
    return math.sqrt(float(np.einsum("i,i->", a, a.conj()).real))


def combined(columns: Array, weights: Array) -> Array:
    """sum_j w_j columns_j of long columns (n, k)."""
    return np.asarray(np.einsum("ij,j->i", columns, weights))


def products(columns: Array, x: Vector) -> Vector:
    """columns^T x (no conjugate) of long columns (n, k)."""
    return np.asarray(np.einsum("ij,i->j", columns, x))


def inner(a: Array, b: Array) -> Array:
    """<a_i, b_j> of real rows (k, n) and (l, n) that lie one after the other in memory."""
    out = np.empty((len(a), len(b)))
    products_of_rows(a, b, out)
    return out


def mixed(weights: Array, rows: Array, added_to: Array | None = None) -> Array:
    """sum_j w_ij rows_j, real (k, n), added to rows that are changed in place where there are some."""
    out = np.zeros((len(weights), rows.shape[1])) if added_to is None else added_to
    add_combinations(np.ascontiguousarray(weights), rows, out)
    return out


@lru_cache(maxsize=4)
def generic(n: int) -> Array:
    """A vector (n,) of length 1 with no pattern, the same wherever it is asked for; its last component is 0."""
    r = np.append(np.random.default_rng(7).uniform(-1.0, 1.0, n - 1), 0.0)
    return np.asarray(r / norm(r))
