"""Periodic orbits by Fourier collocation, a second method beside contin's piecewise polynomials.

At N equidistant phases s = 2 pi t / T the orbit satisfies omega D u = f(u, s) with D the spectral derivative matrix
(Trefethen, Spectral Methods in MATLAB, ch. 3); the error falls faster than any power of 1/N. Folds and period doublings
are solutions of omega D v = f_u v that are periodic or antiperiodic, found together with the orbit by Newton's method.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

Array = np.ndarray


def differentiation(count: int) -> Array:
    """d/ds of functions of period 2 pi on `count` equidistant points."""
    gap = (np.arange(count)[:, None] - np.arange(count)[None, :]) * np.pi / count
    np.fill_diagonal(gap, 1.0)
    sign = (-1.0) ** np.add.outer(np.arange(count), np.arange(count))
    matrix = 0.5 * sign / (np.sin(gap) if count % 2 else np.tan(gap))
    np.fill_diagonal(matrix, 0.0)
    return matrix


def antiperiodic_differentiation(count: int) -> Array:
    """d/ds of functions with v(s + 2 pi) = -v(s): they have the period 4 pi."""
    twice = differentiation(2 * count) / 2.0
    return twice[:count, :count] - twice[:count, count:]


def newton(residual: Callable[[Array], Array], z: Array, tolerance: float = 1e-12) -> Array:
    """A zero of `residual`, whose Jacobian comes from complex steps."""
    for _ in range(30):
        value = residual(z)
        columns = [residual(z + 1e-30j * unit).imag / 1e-30 for unit in np.eye(z.size)]
        change = np.linalg.solve(np.array(columns).T, -value)
        z = z + change
        if np.abs(change).max() < tolerance * max(1.0, np.abs(z).max()):
            return z
    raise AssertionError(f"Newton did not converge: {np.abs(value).max():.1e}")


@dataclass(frozen=True)
class Orbits:
    """u' = f(u, s, p), with slope(u, v, p) = f_u v; u, v (n, N), s (N,) the phase. omega None: it is free."""

    f: Callable[[Array, Array, float], Array]
    slope: Callable[[Array, Array, float], Array]
    n: int
    count: int
    omega: Callable[[float], float] | None = None

    def phases(self) -> Array:
        return 2 * np.pi * np.arange(self.count) / self.count

    def equations(self, u: Array, p: float, omega: float) -> Array:
        """omega D u - f, and u_1'(0) = 0 where the phase is free."""
        derivative = u @ differentiation(self.count).T
        residual = (omega * derivative - self.f(u, self.phases(), p)).ravel()
        return residual if self.omega is not None else np.append(residual, derivative[0, 0])

    def orbit(self, u: Array, p: float, omega: float) -> tuple[Array, float]:
        """The orbit near u and its frequency."""
        size = self.n * self.count
        if self.omega is not None:
            return newton(lambda z: self.equations(z.reshape(self.n, -1), p, omega), u.ravel()).reshape(u.shape), omega
        z = newton(lambda z: self.equations(z[:size].reshape(self.n, -1), p, z[size]), np.append(u.ravel(), omega))
        return z[:size].reshape(u.shape), z[size]

    def critical(self, u: Array, p: float, omega: float, *, doubling: bool) -> tuple[float, float]:
        """Parameter and frequency near the guess at which omega D v = f_u v has a solution v (anti)periodic."""
        size = self.n * self.count
        matrix = antiperiodic_differentiation(self.count) if doubling else differentiation(self.count)

        def variation(u: Array, v: Array, p: float, omega: float) -> Array:
            return (omega * v @ matrix.T - self.slope(u, v, p)).ravel()

        def residual(z: Array) -> Array:
            u, v = z[:size].reshape(self.n, -1), z[size : 2 * size].reshape(self.n, -1)
            q = z[2 * size]
            w = self.omega(q) if self.omega is not None else z[2 * size + 1]
            return np.concatenate([self.equations(u, q, w), variation(u, v, q, w), [np.sum(v * null) - 1.0]])

        linear = np.array([variation(u, unit.reshape(self.n, -1), p, omega) for unit in np.eye(size)]).T
        null = np.linalg.svd(linear)[2][-1].reshape(self.n, -1)
        tail = [p] if self.omega is not None else [p, omega]
        z = newton(residual, np.concatenate([u.ravel(), null.ravel(), tail]))
        p = float(z[2 * size])
        return p, float(self.omega(p) if self.omega is not None else z[2 * size + 1])
