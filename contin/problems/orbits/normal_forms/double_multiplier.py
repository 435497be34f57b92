"""A matrix with two eigenvalues near rho, with one eigenvector: the nearest one that has them there exactly.

A point is located to some 1e-8 in the multipliers (their sum moves as the parameter, they as its root). What is left
would be scaled up with the rows of A - rho that it alone stands in, which is how null vectors are found.
"""

from __future__ import annotations

import numpy as np

from contin.abi import Array


def with_double_eigenvalue(matrix: Array, rho: float) -> Array:
    """On the plane of both eigenvalues A becomes rho + s w v^T, |v| = |w| = 1, v . w = 0, from the singular value s."""
    right, left = _plane(matrix, rho), _plane(matrix.T, rho)
    dual = left @ np.linalg.inv(right.T @ left)  # dual^T right = 1
    inner = dual.T @ matrix @ right - rho * np.eye(2)
    u, s, vt = np.linalg.svd(inner)
    v = vt[0]
    across = np.array([-v[1], v[0]])
    w = across * np.copysign(1.0, across @ u[:, 0])
    return np.asarray(matrix + right @ (s[0] * np.outer(w, v) - inner) @ dual.T)


def _plane(matrix: Array, rho: float) -> Array:
    """Orthonormal columns of the invariant plane of the two eigenvalues next to rho."""
    from scipy.linalg import schur

    away = np.sort(np.abs(np.linalg.eigvals(matrix) - rho))
    limit = np.inf if len(away) < 3 else np.sqrt(away[1] * away[2]) if away[1] > 0.0 else 0.5 * away[2]
    _, vectors, count = schur(matrix, sort=lambda re, im=0.0: abs(re + 1j * im - rho) < limit)
    if count != 2:
        raise np.linalg.LinAlgError("no two multipliers alone are the critical ones")
    return np.asarray(vectors[:, :2])
