"""Orthogonal collocation on one interval: Gauss points, Lobatto nodes, and the matrices between them.

A piece of the solution is the polynomial of degree m through its values at m + 1 Gauss-Lobatto nodes of [0, 1] (the
ends are shared with the neighbours). The differential equation holds at the m Gauss points. Then the error is of order
m + 1 inside the intervals and of order 2 m at their ends (de Boor and Swartz 1973). Lobatto nodes, and not equidistant
ones, because their quadrature weights are positive for every m: they make the diagonal metric in which lengths are
measured. The matrices are computed in rational numbers and rounded once.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache
from math import factorial, fsum, prod

import numpy as np
from numpy.polynomial import legendre

from contin.abi import Array
from contin.errors import InputError

LARGEST = 7  # points an interval; beyond that rounding in the top derivative spoils the error estimate


@dataclass(frozen=True, eq=False)
class Basis:
    """Matrices of the m-point scheme on [0, 1]; u holds values at the m + 1 nodes."""

    m: int
    nodes: Array  # (m + 1,) Gauss-Lobatto, 0 and 1 included
    node_weights: Array  # (m + 1,) quadrature with them, all positive, sum 1
    gauss: Array  # (m,)
    gauss_weights: Array  # (m,)
    values: Array  # (m, m + 1): values @ u at the Gauss points
    slopes: Array  # (m, m + 1): slopes @ u, derivative at the Gauss points
    top: Array  # (m + 1,): top @ u, the m-th derivative (constant)
    error: float  # largest |u - exact| inside an interval of length h is about error * h^(m + 1) |u^(m + 1)|


@lru_cache(maxsize=8)
def basis(m: int) -> Basis:
    """The scheme with m Gauss points an interval, 2 <= m <= 7."""
    if not 2 <= m <= LARGEST:
        raise InputError(f"settings.points (Gauss points an interval) must be in 2 .. {LARGEST}; got {m}")
    gauss, weights = legendre.leggauss(m)
    gauss, weights = 0.5 * (gauss + 1.0), 0.5 * weights
    top_legendre = np.zeros(m + 1)
    top_legendre[m] = 1.0
    inner = np.sort(np.real(legendre.legroots(legendre.legder(top_legendre))))
    x = np.concatenate([[-1.0], inner, [1.0]])
    nodes = 0.5 * (x + 1.0)
    node_weights = 1.0 / (m * (m + 1) * legendre.legval(x, top_legendre) ** 2)
    values, slopes, top = _lagrange(nodes, gauss)
    defect = np.polynomial.Polynomial.fromroots(gauss).integ()
    sampled = defect(np.linspace(0.0, 1.0, 401)) - defect(0.0)
    error = float(np.max(np.abs(sampled))) / factorial(m)
    return Basis(m, nodes, node_weights, gauss, weights, values, slopes, top, error)


def interpolation(m: int, at: Array) -> Array:
    """(len(at), m + 1): values at points `at` of [0, 1] from the values at the nodes."""
    differences = np.asarray(at) - basis(m).nodes[:, None]  # a row for every node: columns of few are slow to multiply
    out = np.repeat(normalisation(m)[:, None], differences.shape[1], axis=1)
    for k, difference in enumerate(differences):
        out[:k] *= difference
        out[k + 1 :] *= difference
    return np.ascontiguousarray(out.T)


@lru_cache(maxsize=8)
def normalisation(m: int) -> Array:
    """1 / prod_k (x_j - x_k) for every node x_j, k != j."""
    nodes = basis(m).nodes
    return np.asarray(1.0 / np.prod(np.where(np.eye(m + 1), 1.0, nodes[:, None] - nodes), axis=1))


def _lagrange(nodes: Array, points: Array) -> tuple[Array, Array, Array]:
    """What a polynomial of degree m takes from its values at the m + 1 nodes, computed exactly and rounded once.

    A constant must have slope zero: what rounding leaves of it is a growth rate in every interval, of the same sign in
    all, which grows as they get shorter (row sums of 6e-14 moved folds of cycles by 2e-13).

    Returns
    -------
    Its values at `points` and its slopes there, each (len(points), m + 1), and its m-th derivative, (m + 1,).
    """
    x, m = [Fraction(node) for node in nodes.tolist()], len(nodes) - 1
    weights = [1 / prod(x[j] - x[k] for k in range(m + 1) if k != j) for j in range(m + 1)]
    values, slopes = np.zeros((len(points), m + 1)), np.zeros((len(points), m + 1))
    for i, t in enumerate(Fraction(point) for point in points.tolist()):
        for j in range(m + 1):
            away = [t - x[k] for k in range(m + 1) if k != j]
            values[i, j] = float(weights[j] * prod(away))
            slopes[i, j] = float(weights[j] * sum(prod(away[:k]) * prod(away[k + 1 :]) for k in range(m)))
        values[i] = _summing_to(1.0, values[i])
        slopes[i] = _summing_to(0.0, slopes[i])
    return values, slopes, _summing_to(0.0, np.array([float(factorial(m) * weight) for weight in weights]))


def _summing_to(total: float, row: Array) -> Array:
    """The row with its smallest entry moved by the rounding errors of all, so that its sum is the total."""
    moved = row.copy()
    moved[np.argmin(np.abs(row))] -= fsum([*row.tolist(), -total])
    return moved
