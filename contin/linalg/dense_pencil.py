"""The finite eigenvalues of a small dense pencil A - l M, where M may be singular."""

from __future__ import annotations

from typing import Any, Final

import numpy as np

from contin.abi import Array, Vector
from contin.linalg.vectors import norm

RANK: Final = 1e-11  # part of the largest singular value below which one is zero
SHIFT: Final = 0.83 + 0.56j  # direction in which the pencil is shifted: no eigenvalue is there but by chance
ROUNDED: Final = 1e-9  # part of a vector's length that its real part has where it is rounding


def every_of_pencil(matrix: Array, mass: Array) -> tuple[Vector, Vector]:
    """All finite eigenvalues of a small regular pencil and their vectors (columns), nearest to zero first.

    With X = (A - s M)^-1, the zeros of M X are deflated by restriction to its range, until there are none: the infinite
    eigenvalues of any index are gone then, to orthogonal transformations. s is at first as large as A beside M, then as
    the eigenvalues are.
    """
    size = float(np.linalg.norm(matrix) / max(np.linalg.norm(mass), np.finfo(float).tiny))
    values, vectors = _finite(matrix, mass, SHIFT * size)
    typical = float(np.median(np.abs(values))) if values.size else 0.0
    if typical > 0.0:
        values, vectors = _finite(matrix, mass, SHIFT * typical)
    values, vectors = _real_again(values, vectors)
    order = np.argsort(np.abs(values), kind="stable")
    return values[order], vectors[:, order]


def _finite(matrix: Array, mass: Array, shift: complex) -> tuple[Vector, Vector]:
    inverse = np.linalg.inv(matrix - shift * mass)
    basis = _range(mass.astype(complex))
    while basis.shape[1]:
        reduced = basis.conj().T @ (mass @ (inverse @ basis))
        inner = _range(reduced)
        if inner.shape[1] == basis.shape[1]:
            break
        basis = basis @ inner
    if not basis.shape[1]:
        return np.empty(0, complex), np.empty((len(mass), 0), complex)
    theta, w = np.linalg.eig(reduced)
    vectors = inverse @ (basis @ w)
    return shift + 1.0 / theta, vectors / np.linalg.norm(vectors, axis=0)


def _range(matrix: Vector) -> Vector:
    """An orthonormal basis (columns) of what the matrix makes."""
    u, s, _ = np.linalg.svd(matrix)
    return np.asarray(u[:, : int(np.sum(s > RANK * s[0]))]) if s.size and s[0] > 0.0 else np.asarray(u[:, :0])


def _real_again(values: Vector, vectors: Vector) -> tuple[Vector, Vector]:
    """Real eigenvalues, and pairs that are conjugate, of a real pencil that was shifted by a complex number."""
    values, vectors = values.copy(), vectors.copy()
    free = list(range(len(values)))
    while free:
        k = free.pop(0)
        partner = min(free, key=lambda j: abs(values[j] - np.conj(values[k])), default=None)
        if partner is None or abs(values[k].imag) <= abs(values[partner] - np.conj(values[k])):
            v = vectors[:, k] * np.conj(_phase(vectors[:, k]))
            values[k], vectors[:, k] = values[k].real, v.real / max(norm(v.real), ROUNDED)
            continue
        free.remove(partner)
        values[partner], vectors[:, partner] = np.conj(values[k]), vectors[:, k].conj()
    return values, vectors


def _phase(v: Vector) -> Any:
    largest = v[int(np.argmax(np.abs(v)))]
    return largest / abs(largest)

