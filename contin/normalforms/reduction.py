"""Lyapunov-Schmidt reduction at a point where F_u is singular: F(u, p) = 0 becomes k equations in k + 1 unknowns.

With the kernel's right vectors Q (n, k), left vectors P, <P, Q> = 1, and A h = -(F_p - Q <P, F_p>), <P, h> = 0, points
near (u0, p0) are u = u0 + Q x + h dp + (second order, <P, .> = 0). In y = (x, dp) the bifurcation equation is

    a01 dp + T2[y, y]/2 + T3[y, y, y]/6 + ... = 0

and T2, T3 are symmetric. For k = 1: T2 = [[b20, b11], [b11, a02]] and b30 = T3[0, 0, 0].
Golubitsky and Schaeffer, Singularities and Groups in Bifurcation Theory I (1985), ch. I.3; T3 by I.(3.23).
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from contin.abi import Vector
from contin.normalforms.jet import DerivativeJet, Jet, Real, combined, lift
from contin.normalforms.linear import singular_vectors, solve
from contin.normalforms.static import static_matrix, static_pair

KERNEL = 1e-6  # singular values of the equilibrated matrix below this fraction of the largest count as zero


@dataclass(frozen=True, eq=False)
class Reduction:
    """The reduced equation of a jet with one active parameter; `right` and `left` are (n, k)."""

    jet: Jet
    right: Real
    left: Real
    h: Real  # first-order response of the state to dp, (n,)
    a01: Real  # (k,)
    lifted: Real  # (k + 1, n + 1): directions (q_i, 0) and (h, 1)
    T2: Real  # (k, k + 1, k + 1)
    second: Real  # (k + 1, k + 1, n): W[y, y]/2 is the state's second-order part
    T3: Real = field(repr=False)  # (k, k + 1, k + 1, k + 1)

    @property
    def k(self) -> int:
        return int(self.right.shape[1])

    def coordinates(self, tangent: Vector) -> Real:
        """y of a vector (du, dp) in the span of the lifted directions; the rest is projected away."""
        dp = tangent[-1]
        return np.append(self.left.T @ (tangent[:-1] - self.h * dp), dp)

    def predictor(self, y: Real, y2: Real) -> tuple[Real, Real]:
        """(z1, z2) with z0 + s z1 + s^2 z2 on the curve up to O(s^3), for the reduced curve s y + s^2 y2."""
        z1 = y @ self.lifted
        z2 = y2 @ self.lifted
        z2[:-1] += 0.5 * np.einsum("i,j,ijn->n", y, y, self.second)
        return z1, z2


def kernel_vectors(jet: Jet, dimension: int) -> tuple[Real, Real]:
    """Right and left bases (n, k) of the kernel, <P, Q> = 1, columns of Q orthonormal (FORMATS' signs for k = 1)."""
    if dimension == 1:
        pair = static_pair(jet)
        return pair.right[:, None], pair.left[:, None]
    right, left, _ = singular_vectors(static_matrix(jet), dimension, jet.scale)
    q = np.linalg.qr(right)[0].real
    return q, np.linalg.solve(left.T @ q, left.T).T.real


def kernel_dimension(jet: Jet) -> int:
    """How many singular values of the equilibrated static matrix are zero to working accuracy (at least 1)."""
    s = singular_vectors(static_matrix(jet), 1, jet.scale)[2]
    return max(1, int(np.sum(s <= KERNEL * max(s[0], 1e-300))))


def reduce(jet: Jet, dimension: int | None = None) -> Reduction:
    """Lyapunov-Schmidt reduction to third order. Cost: one (n + k) solve and O(k^3) forms of order up to 3."""
    if jet.parameters != 1:
        raise ValueError(f"the reduction needs a jet with one active parameter; this one has {jet.parameters}")
    k = dimension or kernel_dimension(jet)
    if isinstance(jet, DerivativeJet):
        jet.prepare(2, 3)
    right, left = kernel_vectors(jet, k)
    matrix = static_matrix(jet)
    slope = jet.form(lift(np.zeros(jet.n), 1, 0))
    h = solve(matrix, -slope, right, left)
    lifted = np.vstack([np.hstack([right.T, np.zeros((k, 1))]), np.append(h, 1.0)])
    B = combined(jet, lifted, lifted)
    second = solve(matrix, -B.reshape(-1, jet.n).T, right, left).T.reshape(B.shape)
    driven = np.zeros((len(lifted) ** 2, jet.n + 1))
    driven[:, :-1] = second.reshape(-1, jet.n)
    mixed = combined(jet, lifted, driven).reshape(*[len(lifted)] * 3, jet.n)
    mixed = mixed + mixed.transpose(1, 0, 2, 3) + mixed.transpose(1, 2, 0, 3)
    T3 = (combined(jet, lifted, lifted, lifted) + mixed) @ left
    T2 = np.moveaxis(B @ left, -1, 0)
    return Reduction(jet, right, left, h, left.T @ slope, lifted, T2, second, np.moveaxis(T3, -1, 0))
