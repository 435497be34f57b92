"""Scalars that vanish where F_u has a critical eigenvalue, with derivatives along given directions.

[A - l M  b; c^T 0] [v; g] = [0; 1] makes g(l) = 0 where l is an eigenvalue of A = F_u beside the mass matrix M, or the
identity (Griewank and Reddien 1984). Its change is dg = -<w, dA v> + <w, M v> dl, and the functional <w, r> is the last
component of the solution with the right side [r; 0]: no solve with a transpose is needed, so that matrix-free operators
serve as well as factored ones.

Folds have l = 0. Hopf points have l^2 = -kappa: the two scalars (g(l) + g(-l))/2 and (g(l) - g(-l))/(2 l) are real and
smooth functions of kappa, also where kappa < 0 (neutral saddles), so that curves run through Bogdanov-Takens points.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from contin.abi import Array, Vector
from contin.linalg.linear import Linear, Solution
from contin.machine import elementary

NEAR_ZERO = 1e-6  # relative size of kappa below which its slopes are taken beside zero
Second = Callable[[Vector, Array], Vector]  # (v, direction (n + 2,)) -> D^2F[v, direction]


@dataclass(frozen=True, eq=False)
class Singularity:
    """g(l) at one l, with its null vector v and the functional <w, .>."""

    shift: complex
    v: Vector
    g: complex
    _solver: Solution

    @classmethod
    def of(cls, linear: Linear, shift: complex, b: Array, c: Array) -> Singularity:
        operator = linear.shifted(shift) if shift != 0.0 else linear
        solver = operator.bordered(b[:, None], c[:, None], np.zeros((1, 1)))
        right = np.append(np.zeros(len(b)), 1.0)
        found = solver.solve(right.astype(complex) if np.iscomplexobj(shift) and np.imag(shift) != 0.0 else right)
        return cls(shift, found[:-1], found[-1], solver)

    def functional(self, r: Vector) -> Any:
        """<w, r>"""
        right = np.append(r, 0.0)
        return self._solver.solve(right.astype(complex) if np.iscomplexobj(self.v) else right)[-1]

    def residue(self, r: Vector) -> tuple[Vector, Any]:
        """(x, y) with (A - l M) x + b y = r and c^T x = 0."""
        found = self._solver.solve(np.append(r, 0.0))
        return found[:-1], found[-1]


class Folds:
    """g(0) = 0."""

    scalars = 1

    def __init__(self, linear: Linear, b: Array, c: Array, second: Second) -> None:
        self.at = Singularity.of(linear, 0.0, b, c)
        self._second = second

    @property
    def values(self) -> Array:
        return np.array([np.real(self.at.g)])

    def slopes(self, direction: Array) -> Array:
        """Change of the scalars along (du, dp2, dp1)."""
        return np.array([-np.real(self.at.functional(self._second(self.at.v, direction)))])


class Hopf:
    """g(l) = g(-l) = 0 with l^2 = -kappa."""

    scalars = 2

    def __init__(self, linear: Linear, kappa: float, size: float, b: Array, c: Array, second: Second) -> None:
        self.kappa, self._second, self._linear = kappa, second, linear
        self._beside = (linear, NEAR_ZERO * size, size, b, c, second) if abs(kappa) < 0.5 * NEAR_ZERO * size else None
        root = np.sqrt(abs(kappa)) if kappa != 0.0 else 1e-150
        self.root = float(root)
        self.shift: complex = 1j * root if kappa >= 0.0 else root
        shifts = [self.shift] if kappa >= 0.0 else [self.shift, -self.shift]
        self.at = [Singularity.of(linear, shift, b, c) for shift in shifts]

    def _split(self, values: list[complex]) -> Array:
        """(g(l) + g(-l))/2 and (g(l) - g(-l))/(2 l) of values at l (kappa < 0: at l and -l)."""
        if self.kappa >= 0.0:
            return np.array([np.real(values[0]), np.imag(values[0]) / self.root])
        upper, lower = (float(np.real(v)) for v in values)
        return np.array([0.5 * (upper + lower), 0.5 * (upper - lower) / self.root])

    @property
    def values(self) -> Array:
        return self._split([s.g for s in self.at])

    def slopes(self, direction: Array) -> Array:
        return self._split([-s.functional(self._second(s.v, direction)) for s in self.at])

    def kappa_slopes(self) -> Array:
        """d/dkappa from dg/dl = <w, M v>, dl/dkappa = -1/(2 l); near 0, where the quotients cancel, from beside it."""
        if self._beside is not None:
            return Hopf(*self._beside).kappa_slopes()
        rates = [complex(s.functional(self._linear.weigh(s.v))) for s in self.at]
        odd = self.values[1]
        if self.kappa >= 0.0:
            rate = rates[0]
            return np.array([-rate.imag / (2.0 * self.root), (rate.real - odd) / (2.0 * self.kappa)])
        up, low = (r.real for r in rates)
        mean, half = 0.5 * (up + low), 0.5 * (up - low)
        return np.array([-half / (2.0 * self.root), -(mean - odd) / (2.0 * elementary.square(self.root))])
