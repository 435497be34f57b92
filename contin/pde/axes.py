"""One coordinate: its nodes, the weights of integrals over it, and its derivative matrices.

differences : equidistant nodes, second order. On an interval with both ends (h = L/(N - 1)); on a circle of
    circumference L with N nodes (h = L/N), derivatives up to the fourth.
chebyshev : x_j = (a + b)/2 - (b - a)/2 cos(pi j/(N - 1)), derivatives of the interpolating polynomial (Trefethen,
    Spectral Methods in MATLAB, ch. 6); integrals by Clenshaw and Curtis' rule.
fourier : N nodes on a circle, derivatives of the trigonometric interpolant (ch. 3 there, in matrix form).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import fsum
from typing import Final, Literal

import numpy as np
from scipy.sparse import csr_matrix, diags

from contin.abi import Array
from contin.machine import elementary

Method = Literal["differences", "chebyshev", "fourier"]
NEIGHBOURS: Final = 4  # nodes of the polynomial that gives values between nodes of a mesh of differences
_STENCILS: Final = {
    1: {-1: -0.5, 1: 0.5},
    2: {-1: 1.0, 0: -2.0, 1: 1.0},
    3: {-2: -0.5, -1: 1.0, 1: -1.0, 2: 0.5},
    4: {-2: 1.0, -1: -4.0, 0: 6.0, 1: -4.0, 2: 1.0},
}


@dataclass(frozen=True)
class Axis:
    """A coordinate `name` from `low` to `high` with `points` nodes; `periodic`: a circle, on which high is low."""

    name: str
    low: float
    high: float
    points: int
    method: Method = "differences"
    periodic: bool = False

    @property
    def length(self) -> float:
        """high - low"""
        return self.high - self.low

    @property
    def step(self) -> float:
        """Distance of equidistant nodes."""
        return self.length / (self.points if self.periodic else self.points - 1)

    @property
    def largest_order(self) -> int:
        """Order of the highest derivative that is made."""
        return 4 if self.periodic else 2

    @property
    def by_ghosts(self) -> bool:
        """True where a slope at an end enters the stencils there, so that the end's value stays an unknown."""
        return self.method == "differences" and not self.periodic

    @cached_property
    def nodes(self) -> Array:
        """(points,), ascending."""
        j = np.arange(self.points, dtype=float)
        if self.method == "chebyshev":
            return self.low + self.length * elementary.square(elementary.sin(0.5 * np.pi * j / (self.points - 1)))
        return np.asarray(self.low + self.step * j)

    @cached_property
    def weights(self) -> Array:
        """Weights (points,) of the integral over the axis."""
        if self.method == "chebyshev":
            return 0.5 * self.length * _clenshaw_curtis(self.points)
        weights = np.full(self.points, self.step)
        if not self.periodic:
            weights[[0, -1]] *= 0.5
        return weights

    def derivative(self, order: int) -> csr_matrix:
        """The matrix (points, points) of a derivative, from values at all nodes; one-sided at ends of an interval."""
        if order == 0:
            return csr_matrix(diags(np.ones(self.points)))
        if self.method == "fourier":
            return csr_matrix(_fourier(self.points, order) * (2.0 * np.pi / self.length) ** order)
        if self.method == "chebyshev":
            first = _chebyshev(self.points) * (2.0 / self.length)
            return csr_matrix(np.linalg.matrix_power(first, order))
        return self._circle(order) if self.periodic else self._interval(order)

    def with_slopes(self, order: int, ends: tuple[bool, bool]) -> tuple[csr_matrix, csr_matrix]:
        """`derivative` on a mesh of differences where the slope is known at some ends: D (points, points) and
        G (points, 2), so that the derivative is D u + G (slope at the start, slope at the end).

        With a node beyond the end that gives the slope by the central difference, u'' there is
        2 (u_1 - u_0)/h^2 - 2 u'/h at the start, and the image of it at the end.
        """
        matrix = self.derivative(order).tolil()
        slopes = np.zeros((self.points, 2))
        h = self.step
        for end, known in enumerate(ends):
            if not known or order == 0:
                continue
            row, beside, sign = (0, 1, 1.0) if end == 0 else (self.points - 1, self.points - 2, -1.0)
            matrix[row] = 0.0
            if order == 1:
                slopes[row, end] = 1.0
            else:
                matrix[row, row], matrix[row, beside] = -2.0 / h**2, 2.0 / h**2
                slopes[row, end] = -sign * 2.0 / h
        return csr_matrix(matrix), csr_matrix(slopes)

    def _circle(self, order: int) -> csr_matrix:
        n, h = self.points, self.step
        j = np.arange(n)
        rows = np.concatenate([j for _ in _STENCILS[order]])
        columns = np.concatenate([(j + offset) % n for offset in _STENCILS[order]])
        values = np.repeat(list(_STENCILS[order].values()), n) / h**order
        return csr_matrix((values, (rows, columns)), shape=(n, n))

    def _interval(self, order: int) -> csr_matrix:
        n, h = self.points, self.step
        stencil = _STENCILS[order]
        matrix = diags(list(stencil.values()), list(stencil), shape=(n, n)).tolil()
        edge = {1: [-1.5, 2.0, -0.5], 2: [2.0, -5.0, 4.0, -1.0]}[order]
        matrix[0], matrix[n - 1] = 0.0, 0.0
        for k, weight in enumerate(edge):
            matrix[0, k], matrix[n - 1, n - 1 - k] = weight, weight * (-1.0) ** order
        return csr_matrix(matrix / h**order)

    def interpolation(self, at: float) -> Array:
        """Weights (points,) that give the value at a point from those at the nodes."""
        if self.method == "fourier":
            return _dirichlet(self.points, 2.0 * np.pi * (at - self.nodes) / self.length)
        if self.method == "chebyshev":
            w = np.where(np.arange(self.points) % 2 == 0, 1.0, -1.0)
            w[[0, -1]] *= 0.5
            return _barycentric(self.nodes, w, at)
        count = min(NEIGHBOURS, self.points)
        first = int(np.floor((at - self.low) / self.step)) - (count - 1) // 2
        if not self.periodic:
            first = min(max(first, 0), self.points - count)
        chosen = first + np.arange(count)
        places: Array = self.low + self.step * chosen.astype(float)
        w = np.array([1.0 / float(np.prod(x - np.delete(places, k))) for k, x in enumerate(places)])
        weights = np.zeros(self.points)
        weights[chosen % self.points] = _barycentric(places, w, at)
        return weights


def _barycentric(nodes: Array, w: Array, at: float) -> Array:
    hit = np.flatnonzero(nodes == at)
    if hit.size:
        return np.asarray(np.eye(len(nodes))[hit[0]])
    terms = w / (at - nodes)
    return np.asarray(terms / terms.sum())


def _dirichlet(n: int, t: Array) -> Array:
    """Values at angles t of the trigonometric interpolant of (1, 0, ..., 0), for even n with cosine as highest mode."""
    total = np.ones_like(t)
    for k in range(1, (n - 1) // 2 + 1):
        total += 2.0 * elementary.cos(k * t)
    if n % 2 == 0:
        total += elementary.cos(0.5 * n * t)
    return np.asarray(total / n)


def _fourier(n: int, order: int) -> Array:
    """The matrix of a derivative (order 1 to 4) on the circle of circumference 2 pi; odd ones of the highest mode of an
    even n are zero at the nodes.

    With g = cot(x/2) for even n and 1/sin(x/2) for odd n the interpolant of (1, 0, ..., 0) is sin(n x/2) g(x)/n. Its
    derivatives at nodes are small sums of those of g: every entry is right to rounding, which a sum over modes is not
    where entries are much smaller than the largest. The diagonal is what makes derivatives of constants zero: long
    waves see of the rounding of the entries only how they differ from constants.
    """
    j = np.arange(1, n // 2 + 1)
    half = np.pi * j / n
    c, s = 1.0 / elementary.sin(half), np.where(j % 2 == 0, 1.0, -1.0)
    cot, c2 = elementary.cos(half) * c, c * c
    if n % 2 == 0:
        g = (cot, -0.5 * c2, 0.5 * c2 * cot, -0.25 * c2 * c2 - 0.5 * c2 * cot * cot)
    else:
        g = (c, -0.5 * c * cot, 0.25 * c * (cot * cot + c2), c * cot * (0.125 - 0.75 * c2))
    squared = float(n) * n
    values = s * (0.5 * g[0], g[1], 1.5 * g[2] - 0.125 * squared * g[0], 2.0 * g[3] - 0.5 * squared * g[1])[order - 1]
    parity = -1.0 if order % 2 else 1.0
    column = np.zeros(n)
    column[n - j] = parity * values
    column[j] = values if order % 2 == 0 or n % 2 else np.append(values[:-1], 0.0)
    if order % 2 == 0:
        column[0] = -fsum(column[1:])
    j = np.arange(n)
    return np.asarray(column[(j[:, None] - j[None, :]) % n])


def _chebyshev(n: int) -> Array:
    """The first derivative on (-1, 1) at ascending nodes."""
    theta = np.pi * np.arange(n) / (n - 1)
    c = np.ones(n)
    c[[0, -1]] = 2.0
    c *= (-1.0) ** np.arange(n)
    # cos a - cos b without cancellation, x = -cos(theta)
    sums, differences = 0.5 * (theta[:, None] + theta[None, :]), 0.5 * (theta[:, None] - theta[None, :])
    gap = 2.0 * elementary.sin(sums) * elementary.sin(differences)
    matrix = np.outer(c, 1.0 / c) / (gap + np.eye(n))
    np.fill_diagonal(matrix, 0.0)
    np.fill_diagonal(matrix, -matrix.sum(axis=1))
    return matrix


def _clenshaw_curtis(n: int) -> Array:
    """Weights on (-1, 1), exact for polynomials of degree n - 1."""
    k = np.arange(0, n, 2)
    moments = 2.0 / (1.0 - k.astype(float) ** 2)
    j = np.arange(n)
    table = elementary.cos(np.pi * np.outer(j, k) / (n - 1))
    halves = np.ones(len(k))
    halves[0] = 0.5
    if (n - 1) % 2 == 0:
        halves[-1] *= 0.5
    weights = (2.0 / (n - 1)) * table @ (halves * moments)
    weights[[0, -1]] *= 0.5
    return np.asarray(weights)
