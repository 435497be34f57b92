"""Projections to the invariant subspaces of saddles, and their leading eigenvalues."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array


def left_subspace(matrix: Array, count: int, stable: bool, reference: Array | None = None) -> Array:
    """Basis (n, count) of the left invariant subspace of the `count` most stable (unstable) eigenvalues.

    Orthonormal; with a reference R (n, count) scaled to R^T L = 1, so that it varies smoothly with the matrix.
    """
    from scipy.linalg.lapack import zgees

    if count == 0:
        return np.zeros((len(matrix), 0))
    values = np.sort(np.linalg.eigvals(matrix).real)
    if not stable:
        values = -values[::-1]
    limit = np.inf if count == len(values) else 0.5 * (values[count - 1] + values[count])
    sign = 1.0 if stable else -1.0
    _, found, _, vectors, _, info = zgees(lambda x: sign * x.real < limit, matrix.T.astype(complex), sort_t=1)
    if found != count or info:
        raise np.linalg.LinAlgError("the eigenvalues of the saddle do not separate")
    basis = _real_basis(vectors[:, :count])
    return basis if reference is None else np.asarray(np.linalg.solve((reference.T @ basis).T, basis.T).T)


def _real_basis(vectors: NDArray[np.complex128]) -> Array:
    """Orthonormal real basis of a subspace that contains the conjugates of its vectors."""
    left, _, _ = np.linalg.svd(np.hstack([vectors.real, vectors.imag]), full_matrices=False)
    return np.asarray(left[:, : vectors.shape[1]])


@dataclass(frozen=True, eq=False)
class Leading:
    """The eigenvalue next to the imaginary axis on one side, with right and left eigenvector (real ones as reals)."""

    value: complex
    right: Array
    left: Array

    @property
    def is_real(self) -> bool:
        return self.value.imag == 0.0


def leading(matrix: Array, count: int, stable: bool) -> Leading:
    """Of the `count` most stable (unstable) eigenvalues, the slowest."""
    values, right = np.linalg.eig(matrix)
    order = np.argsort(values.real if stable else -values.real)[:count]
    k = int(max(order, key=lambda i: values[i].real if stable else -values[i].real))
    others, left = np.linalg.eig(matrix.T)
    j = int(np.argmin(np.abs(others - values[k])))
    scale = float(np.abs(values).max())
    value = complex(values[k])
    if abs(value.imag) <= 1e-12 * scale:
        value = complex(value.real)
    return Leading(value, np.real(right[:, k]), np.real(left[:, j]))


def aligned(vector: Array, reference: Array | None) -> Array:
    return vector if reference is None or float(vector @ reference) >= 0.0 else -vector
