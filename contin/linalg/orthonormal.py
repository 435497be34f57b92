"""Orthonormal bases of the span of a few long rows, and what is left of rows outside of one."""

from __future__ import annotations

import numpy as np

from contin.abi import Array
from contin.linalg.vectors import inner, mixed, norm

INDEPENDENT = 1e-8  # part of a vector outside of others from which it is not one of their combinations
ORTHONORMAL = 1e-14  # by which products of rows that are may differ from 0 and 1
OBLIQUE = 1e-3  # smallest eigenvalue of the cosines between rows that are turned all at once
TURNS = 3


def outside(w: Array, basis: Array) -> Array:
    """What is left of rows w (n,) or (k, n) outside of the span of orthonormal rows; projected twice."""
    rows = np.array(w, ndmin=2, order="C")
    for _ in range(2):
        mixed(-inner(rows, basis), basis, added_to=rows)
    return rows.reshape(w.shape)


def orthonormal(vectors: Array, basis: Array | None = None) -> Array:
    """Orthonormal rows that span the same, outside a basis; what depends on the others is left out.

    Rows that are far from depending on each other are turned all at once, others one by one.
    """
    rows = np.ascontiguousarray(vectors)
    if not len(rows):
        return rows.copy()
    whole = np.einsum("ij,ij->i", rows, rows)
    if basis is not None and len(basis):
        rows = outside(rows, basis)
    turned = _turned(rows, whole)
    return _one_by_one(vectors, basis) if turned is None else turned


def _turned(rows: Array, whole: Array) -> Array | None:
    """By Cholesky factors of their products, until these are those of orthonormal rows; None where rows depend on each
    other, or where little is left of them beside their squared lengths `whole` before."""
    if not np.all((whole > 0.0) & (whole < np.inf)):
        return None
    left = inner(rows, rows)
    for _ in range(TURNS):
        square = np.diagonal(left)
        if not np.all(square > INDEPENDENT * INDEPENDENT * whole):
            return None
        if float(np.abs(left - np.eye(len(left))).max()) <= ORTHONORMAL:
            return rows
        unit = 1.0 / np.sqrt(square)
        cosines = left * unit * unit[:, None]
        if not float(np.linalg.eigvalsh(cosines)[0]) > OBLIQUE:
            return None
        rows = mixed(np.linalg.inv(np.linalg.cholesky(cosines)) * unit, rows)
        whole, left = np.ones(len(rows)), inner(rows, rows)
    return rows


def _one_by_one(vectors: Array, basis: Array | None) -> Array:
    """Gram-Schmidt, twice, on rows that lie one after the other in memory."""
    given = 0 if basis is None else len(basis)
    rows = np.empty((given + len(vectors), vectors.shape[1]))
    if basis is not None:
        rows[:given] = basis
    count = given
    for vector in vectors:
        size = norm(vector)
        if not size > 0.0:
            continue
        w = outside(vector / size, rows[:count]) if count else vector / size
        left = norm(w)
        if left > INDEPENDENT:
            rows[count] = w / left
            count += 1
    return rows[given:count].copy()
