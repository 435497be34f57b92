"""Leading multipliers of an orbit by Arnoldi's method on the action of the monodromy matrix M.

The trivial one is taken out with its direction, v = f(u(0)): the others are those of the quotient, Q M Q with
Q = I - v v^T/|v|^2. Near a fold of cycles, where a second one comes to 1, the error of the discretisation would
otherwise enter by its square root.
"""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.sparse.linalg import ArpackNoConvergence, LinearOperator, eigs

from contin.abi import Array
from contin.linalg.vectors import norm
from contin.problems.large_orbits.sweeps import Sweeps

DENSE: Final = 40  # unknowns up to which M is formed
FIRST: Final = 6  # multipliers that are asked for at first
INSIDE: Final = 0.9  # the smallest of them must be inside this circle
REAL: Final = 1e-9  # imaginary part of a real multiplier


def leading(sweeps: Sweeps, velocity: Array) -> tuple[NDArray[np.complex128], NDArray[np.complex128]]:
    """All multipliers of modulus above `INSIDE`, and some more, without the trivial one; and their vectors (n, k)."""
    n, size = sweeps.n, norm(velocity)
    v = velocity / size if size > 0.0 else velocity

    def quotient(w: Array) -> Array:
        w = np.asarray(w, dtype=float).ravel()
        moved = sweeps.monodromy(w - (v @ w) * v)
        return np.asarray(moved - (v @ moved) * v)

    if n <= DENSE:
        values, vectors = np.linalg.eig(np.column_stack([quotient(row) for row in np.eye(n)]))
        moving = n if sweeps.mass is None else int(np.sum(np.diff(sweeps.mass.indptr) > 0))  # states without mass: 0
        order = np.argsort(-np.abs(values))[: moving - 1]
        return values[order].astype(complex), vectors[:, order].astype(complex)
    wanted = FIRST
    start = np.random.default_rng(23).normal(size=n)
    while True:
        count = min(wanted, n - 3)
        operator = LinearOperator((n, n), matvec=quotient, dtype=float)
        try:
            values, vectors = eigs(operator, k=count, v0=start, tol=1e-10, ncv=min(n - 1, max(2 * count + 2, 20)))
        except ArpackNoConvergence as error:
            values, vectors = error.eigenvalues, error.eigenvectors
        order = np.argsort(-np.abs(values))
        values, vectors = values[order], vectors[:, order]
        if not len(values) or abs(values[-1]) < INSIDE or count == n - 3:
            return values, vectors
        wanted *= 2


def tests_of(values: NDArray[np.complex128]) -> tuple[Array, int]:
    """[NS, PD, BPC], which change sign when a multiplier of their kind crosses, and the number outside the circle."""
    outside = np.abs(values) > 1.0
    pairs = (values.imag > REAL * np.abs(values)) & (values.imag > 0.0)
    real = np.abs(values.imag) <= REAL * np.abs(values)
    tests = []
    for kind in (pairs, real & (values.real < 0.0), real & (values.real > 0.0)):
        gap = float(np.min(np.abs(np.abs(values[kind]) - 1.0), initial=1.0))
        tests.append(-gap if int(np.sum(outside & kind)) % 2 else gap)
    return np.array(tests), int(np.sum(outside))
