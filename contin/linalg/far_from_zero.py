"""Eigenvalues at the right edge of the spectrum of an operator known by products alone, by Arnoldi's method without an
inverse.

What is nearest to zero is found by solving; a pair that becomes unstable far from zero, where no bound of the matrix's
entries tells how far to look, lies apart from the others and is found by a few products.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array, Vector
from contin.linalg.eigen import CONVERGED, MEMORY, Spectrum
from contin.linalg.orthonormal import INDEPENDENT
from contin.linalg.vectors import norm

PRODUCTS: Final = 40
WATCHED: Final = 0.2  # an eigenvalue l matters to stability where Re l > -WATCHED |l|
SAME: Final = 1e-2  # relative distance of two approximations of one eigenvalue


def with_far_ones(found: Spectrum, apply: Callable[[Vector], Vector], n: int) -> Spectrum:
    """Eigenvalues nearest to zero, and those farther away that are unstable or nearly so, as far as they lie apart.

    apply : v -> A v.  Costs `PRODUCTS` of them.
    """
    values, vectors = _edge(apply, n)
    reach = float(np.abs(found.values).max(initial=0.0))
    far = (values.real > -WATCHED * np.abs(values)) & (np.abs(values) > (1.0 + SAME) * reach)
    both = np.concatenate([found.values, values[far]])
    return replace(found, values=both, vectors=np.hstack([found.vectors, vectors[:, far]]))


def _edge(apply: Callable[[Vector], Vector], n: int) -> tuple[NDArray[np.complex128], NDArray[np.complex128]]:
    """Ritz values that have converged, nearest to zero first, and their vectors (columns)."""
    most = int(min(n, PRODUCTS, max(1.0, MEMORY / n)))
    basis: Array = np.empty((most + 1, n))
    hessenberg = np.zeros((most + 1, most))
    start = np.random.default_rng(17).normal(size=n)
    basis[0] = start / norm(start)
    size = most
    for k in range(most):
        w = apply(basis[k])
        if not np.all(np.isfinite(w)):
            return np.zeros(0, complex), np.zeros((n, 0), complex)
        whole = norm(w)
        for _ in range(2):
            h = np.einsum("ij,j->i", basis[: k + 1], w)
            w = w - np.einsum("i,ij->j", h, basis[: k + 1])
            hessenberg[: k + 1, k] += h
        left = norm(w)
        if not left > INDEPENDENT * whole:  # an invariant subspace
            size = k + 1
            break
        hessenberg[k + 1, k] = left
        basis[k + 1] = w / left
    theta, ritz = np.linalg.eig(hessenberg[:size, :size])
    good = np.flatnonzero(np.abs(hessenberg[size, size - 1] * ritz[-1]) <= CONVERGED * np.abs(theta))
    good = good[np.argsort(np.abs(theta[good]), kind="stable")]
    return theta[good].astype(complex), (basis[:size].T @ ritz[:, good]).astype(complex)
