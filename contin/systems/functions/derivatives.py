"""Derivatives of a user's function along straight lines: complex steps where analytic, else high-order differences.

phi(t) = F(z + t v), z = (u, p). With F analytic and written so that it takes complex arguments, the Taylor coefficients
of phi come from the trapezoidal rule on a circle of relative radius r = 0.1 (Fornberg 1981): an error of about
k! 1e-16 / r^k, none for the first derivative (a complex step). Otherwise central stencils of order 6 to 8 are used, on
the user's Jacobian where there is one (one order less to difference).
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from itertools import product
from typing import Any

import numpy as np

from contin.abi import Array, Vector
from contin.machine import elementary

TINY = float(np.finfo(float).tiny)
COMPLEX_STEP = 1e-30
CIRCLE = 0.1  # radius of the circle, relative to the size of the unknowns
CIRCLE_POINTS = 16
STEPS = {1: 2e-3, 2: 1e-2, 3: 2e-2, 4: 4e-2, 5: 6e-2}  # of stencils, relative: rounding and truncation balance
HALF_WIDTHS = {1: 3, 2: 4, 3: 5, 4: 5, 5: 6}
NARROWER = (1.0, 0.1, 1e-2, 1e-3, 1e-4)  # stencils of the first derivative, where wider ones cross a corner
ROUGH = 1e-4  # relative difference of a stencil and its inner pair, beyond which the function is not smooth across it
AGREEMENT = 1e-5  # relative difference of a complex step and a real one, beyond which F is not analytic

Function = Callable[[Vector, Vector], Vector]


@cache
def stencil(order: int) -> tuple[tuple[int, float], ...]:
    """Offsets and weights of the central difference for the derivative of this order on unit spacing."""
    half = HALF_WIDTHS[order]
    offsets = np.arange(-half, half + 1, dtype=float)
    powers = np.vander(offsets / half, increasing=True).T  # scaled, so that the system is well conditioned
    right = np.zeros(len(offsets))
    right[order] = math.factorial(order) / elementary.pow(half, order)
    weights = np.linalg.solve(powers, right)
    return tuple((int(o), float(w)) for o, w in zip(offsets, weights, strict=True) if abs(w) > 1e-13)


@cache
def circle(order: int) -> tuple[tuple[complex, float, complex], ...]:
    """w, weight and w^-order at the nodes of the upper half of the unit circle; the lower is its conjugate."""
    half = CIRCLE_POINTS // 2
    nodes = [elementary.exp(1j * np.pi * j / half) for j in range(half + 1)]
    return tuple((w, 1.0 if j in (0, half) else 2.0, w**-order) for j, w in enumerate(nodes))


@dataclass(frozen=True, eq=False)
class Lines:
    """Directional derivatives of F(u, p), both vectors; `sizes` (n + m,) are typical sizes of u and p.

    analytic : F takes complex arguments and is analytic (see `is_analytic`).
    slope : D F(u, p)[v] by the user's Jacobian, v (n + m,), or None.
    wider : than usual, of the stencils for derivatives of second and higher order; how much these differ tells errors.
    """

    function: Function
    sizes: Array
    analytic: bool
    slope: Callable[[Array, Array, Array], Array] | None = None
    wider: float = 1.0

    def first(self, u: Array, p: Array, v: Array) -> Array:
        """D F[v]."""
        if self.analytic:
            h = COMPLEX_STEP * self._reach(u, p, v)
            n = len(u)
            return np.asarray(np.imag(self.function(u + 1j * h * v[:n], p + 1j * h * v[n:])) / h)
        if self.slope is not None:
            return self.slope(u, p, v)
        return self.pure(u, p, v, 1)

    def columns(self, u: Array, p: Array) -> Array:
        """[dF/du dF/dp] (n, n + m) by complex steps, of an analytic F: `first` along all axes, with its sizes once."""
        n = len(u)
        steps = COMPLEX_STEP * np.maximum(np.abs(np.concatenate([u, p])), self.sizes)
        states, others = u.astype(complex), p.astype(complex)
        found = np.empty((n, len(steps)))
        for j, h in enumerate(steps.tolist()):
            moved, k = (states.copy(), j) if j < n else (others.copy(), j - n)
            moved[k] += 1j * h
            value = self.function(moved, others) if j < n else self.function(states, moved)
            found[:, j] = np.imag(value) / h
        return found

    def pure(self, u: Array, p: Array, v: Array, order: int) -> Array:
        """D^k F[v, ..., v], k = `order`."""
        n = len(u)
        reach = self._reach(u, p, v)
        if reach == 0.0:
            return np.zeros(n)
        if self.analytic:
            r = CIRCLE * reach
            total = np.zeros(n)
            along, across = v[:n], v[n:]
            for w, weight, turned_back in circle(order):
                step = r * w
                value = np.asarray(self.function(u + step * along, p + step * across), dtype=complex)
                total += weight * (value * turned_back).real
            power = CIRCLE_POINTS * elementary.pow(r, order)
            return total * (math.factorial(order) / power) if power > TINY else np.full(n, np.nan)  # v is endless
        if order == 1:
            return self._slope_between_corners(u, p, v, reach)
        lower = 1 if self.slope is not None and order > 1 else 0
        k = order - lower
        h = STEPS[k] * reach * self.wider
        total = np.zeros(n)
        for offset, weight in stencil(k):
            t = offset * h
            at = u + t * v[:n], p + t * v[n:]
            value = self.slope(*at, v) if lower and self.slope is not None else self.function(*at)
            total += weight * np.asarray(value, dtype=float)
        return total / elementary.pow(h, k)

    def _slope_between_corners(self, u: Array, p: Array, v: Array, reach: float) -> Array:
        """D F[v] by the widest stencil that crosses no corner: its inner pair alone gives nearly the same there."""
        n, widest, gap_before = len(u), np.empty(0), np.inf
        for narrower in NARROWER:
            h = STEPS[1] * reach * narrower
            values = {k: np.asarray(self.function(u + k * h * v[:n], p + k * h * v[n:]), dtype=float)
                      for k, _ in stencil(1)}  # fmt: skip
            slope = np.zeros(n)
            for k, weight in stencil(1):
                slope += weight * values[k]
            slope /= h
            inner = (values[1] - values[-1]) / (2.0 * h)
            rounding = 1e-14 * float(np.max(np.abs(values[1]), initial=0.0)) / h
            gap = float(np.max(np.abs(slope - inner), initial=0.0))
            if not gap > ROUGH * float(np.max(np.abs(slope), initial=0.0)) + rounding:  # so that NaN ends it too
                return slope
            widest = widest if gap >= gap_before else slope
            gap_before = min(gap, gap_before)
        return widest

    def form(self, u: Array, p: Array, directions: Sequence[Array]) -> Array:
        """D^k F[d1, ..., dk], real directions (n + m,), by polarisation: 2^(k-1) pure ones, or one if all are equal."""
        k = len(directions)
        if k == 1:
            return self.first(u, p, directions[0])
        norms = [self._reach(u, p, d) for d in directions]
        if any(size == 0.0 for size in norms):
            return np.zeros(len(u))
        if all(d is directions[0] or np.array_equal(d, directions[0]) for d in directions[1:]):
            return self.pure(u, p, directions[0], k)
        units = [d * size for d, size in zip(directions, norms, strict=True)]  # comparable in size
        total = np.zeros(len(u))
        for signs in product((1.0, -1.0), repeat=k - 1):
            v = units[0] + sum(s * d for s, d in zip(signs, units[1:], strict=True))
            total += float(np.prod(signs)) * self.pure(u, p, np.asarray(v), k)
        return total / (2.0 ** (k - 1) * math.factorial(k) * float(np.prod(norms)))

    def along(self, matrix: Callable[[Array, Array], Array], u: Array, p: Array, v: Array) -> Array:
        """d/dt of a matrix-valued function at (u, p) + t v, t = 0, by a stencil."""
        n = len(u)
        h = STEPS[1] * self._reach(u, p, v)
        if h == 0.0:
            return np.zeros_like(matrix(u, p))
        total: Any = 0.0
        for offset, weight in stencil(1):
            total = total + (weight / h) * matrix(u + offset * h * v[:n], p + offset * h * v[n:])
        return np.asarray(total)

    def _reach(self, u: Array, p: Array, v: Array) -> float:
        """How far along v an unknown changes by its own size; 0 for v = 0."""
        size = np.maximum(np.abs(np.concatenate([u, p])), self.sizes)
        largest = float(np.max(np.abs(v) / size))
        return 0.0 if largest == 0.0 else 1.0 / largest


def is_analytic(function: Function, u: Array, p: Array, sizes: Array) -> bool:
    """True where the function takes complex arguments and its complex step agrees with a real difference.

    Tried beside (u, p) in two generic directions, so that what vanishes at a symmetric start does not hide anything.
    """
    n = len(u)
    generator = np.random.default_rng(7)
    real = Lines(function, sizes, False)
    complex_ = Lines(function, sizes, True)
    for _ in range(2):
        v = sizes * generator.uniform(-1.0, 1.0, sizes.size)
        shift = 0.01 * sizes * generator.uniform(-1.0, 1.0, sizes.size)
        z_u, z_p = u + shift[:n], p + shift[n:]
        try:
            with np.errstate(all="ignore"), warnings.catch_warnings():
                warnings.simplefilter("error", np.exceptions.ComplexWarning)  # imaginary parts thrown away
                by_step = complex_.first(z_u, z_p, v)
                by_circle = complex_.pure(z_u, z_p, v, 1)
        except (TypeError, ValueError, AttributeError, np.exceptions.ComplexWarning):
            return False  # no complex arguments: differences are taken instead
        with np.errstate(all="ignore"):
            by_difference = real.pure(z_u, z_p, v, 1)
        largest = float(np.max(np.abs(by_difference), initial=0.0))
        if not (np.all(np.isfinite(by_step)) and np.all(np.isfinite(by_circle)) and np.isfinite(largest)):
            return False
        gap = max(float(np.max(np.abs(by_step - by_difference))), float(np.max(np.abs(by_circle - by_difference))))
        if gap > AGREEMENT * largest + 1e-300:
            return False
    return True
