"""Invariant planes of the monodromy matrix M of an orbit, the direction along the orbit taken out.

N V = V A, W^T N = A W^T, W^T V = 1 with N = Q M Q, Q = 1 - v v^T/|v|^2 and v = f(u(0)), as multipliers are those of N.
A plane is smooth where its two multipliers meet, at 1 (where that of the orbit, v, would be a third one) or at -1, so
that det A = mu_1 mu_2 and the trace are: neither a pair nor two vectors are.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

import numpy as np
from scipy.linalg import schur

from contin.abi import Array, Vector
from contin.linalg.krylov import COARSE, TOLERANCE, gmres
from contin.linalg.newton import Rules, newton
from contin.linalg.vectors import norm
from contin.problems.large_orbits.sweeps import Sweeps

NEWTON: Final = Rules(settled=1e-6, stalled=0.0, far=1.0, budget=8)  # of unit vectors; what is left is the square
Apply = Callable[[Vector], Vector]


@dataclass(frozen=True, eq=False)
class Across:
    """N and its transpose.  velocity : v (n,)."""

    sweeps: Sweeps
    velocity: Array

    def projected(self, w: Vector) -> Vector:
        """Q w"""
        v = self.velocity
        return np.asarray(w - np.einsum("i,i->", v, w) / np.einsum("i,i->", v, v) * v)

    def apply(self, w: Vector) -> Vector:
        """N w"""
        return self.projected(self.sweeps.monodromy(self.projected(w)))

    def transposed(self, w: Vector) -> Vector:
        """N^T w"""
        return self.projected(self.sweeps.transposed(self.projected(w)))

    def change(self, V: Array, moved: Array, turned: Array) -> Array:
        """(N + dN) V - N V to first order, from dM Q V = `moved` and dv = `turned`."""
        v, square = self.velocity, float(np.einsum("i,i->", self.velocity, self.velocity))

        def tilted(w: Array) -> Array:
            """dQ w"""
            along, across = np.einsum("i,ik->k", v, w) / square, np.einsum("i,ik->k", turned, w) / square
            more = 2.0 * float(np.einsum("i,i->", v, turned)) / square
            return np.outer(v, more * along - across) - np.outer(turned, along)

        def each(apply: Apply, w: Array) -> Array:
            return np.column_stack([apply(column) for column in w.T])

        inner = self.sweeps.monodromy
        first = tilted(each(inner, each(self.projected, V)))
        last = each(self.projected, each(inner, tilted(V)))
        return np.asarray(first + each(self.projected, moved) + last)


@dataclass(frozen=True, eq=False)
class Plane:
    """right V (n, 2), orthonormal, left W (n, 2) and A (2, 2)."""

    right: Array
    left: Array
    within: Array

    @property
    def product(self) -> float:
        """mu_1 mu_2"""
        return float(np.linalg.det(self.within))

    def rate(self, changed: Array) -> float:
        """d log |mu_1 mu_2| for dN V = `changed`."""
        moved = np.einsum("ij,ik->jk", self.left, changed)
        return float(np.trace(np.linalg.solve(self.within, moved)))


def plane_near(across: Across, guess: Array) -> Plane | None:
    """The invariant plane near that of the columns of `guess` (n, 2); None where Newton's method finds none."""

    def correct(V: Array) -> tuple[float, Array] | None:
        moved = np.column_stack([across.apply(w) for w in V.T])
        A = np.einsum("ij,ik->jk", V, moved)
        if not np.all(np.isfinite(A)):
            return None
        residual = moved - np.einsum("ij,jk->ik", V, A)
        triangle, U = _triangular(A)
        known = -np.einsum("ij,jk->ik", residual, U)
        change = np.real(_columns(across.apply, triangle, V, known, np.zeros((2, 2)), COARSE) @ U.conj().T)
        return norm(change.ravel()), np.linalg.qr(V + change)[0]

    found = newton(correct, np.linalg.qr(np.column_stack([across.projected(w) for w in guess.T]))[0], NEWTON)
    if found is None:
        return None
    V = found.at
    moved = np.column_stack([across.apply(w) for w in V.T])
    A = np.einsum("ij,ik->jk", V, moved)
    triangle, U = _triangular(A.T)
    left = np.real(_columns(across.transposed, triangle, V, np.zeros(V.shape), U) @ U.conj().T)
    A = np.linalg.solve(np.einsum("ij,ik->jk", left, V), np.einsum("ij,ik->jk", left, moved))
    return Plane(V, left, A) if np.all(np.isfinite(left)) and np.all(np.isfinite(A)) else None


def _triangular(A: Array) -> tuple[Vector, Vector]:
    """Schur's form: upper triangular and unitary, real where the eigenvalues are."""
    real = float(_discriminant(A)) >= 0.0
    T, U = schur(A, output="real" if real else "complex")
    return np.asarray(T), np.asarray(U)


def _discriminant(A: Array) -> float:
    """That of the characteristic polynomial of A (2, 2)."""
    half = 0.5 * (A[0, 0] - A[1, 1])
    return float(half * half + A[0, 1] * A[1, 0])


def _columns(
    apply: Apply, triangle: Vector, border: Array, known: Vector, below: Vector, tolerance: float = TOLERANCE
) -> Vector:
    """X (n, 2) with N X - X T + B G = `known`, B^T X = `below`, T upper triangular: column after column."""
    n = len(border)
    found: list[Vector] = []
    for k in range(2):
        right = known[:, k] if k == 0 else known[:, 1] + triangle[0, 1] * found[0]

        def bordered(x: Vector, k: int = k) -> Vector:
            w = x[:n]
            above = apply(w) - triangle[k, k] * w + np.einsum("ij,j->i", border, x[n:])
            return np.append(above, np.einsum("ij,i->j", border, w))

        target = np.append(right, below[:, k])
        target = target.astype(np.result_type(target, triangle))
        found.append(gmres(bordered, lambda r: r, target, tolerance)[0][:n])
    return np.column_stack(found)
