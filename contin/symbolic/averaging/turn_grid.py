"""Numbers on one turn of an oscillation: Gauss nodes between breakpoints, means and zero-mean antiderivatives.

The functions are smooth between the breakpoints and may jump there, so that all results are accurate to rounding.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Final

import numpy as np
from numpy.typing import NDArray

from contin.machine import elementary
from contin.records import Sympy

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]
SAME: Final = 1e-9  # angles closer than this are one
NODES: Final = 32  # on an arc; exact for trigonometric polynomials far beyond any model's degree


@dataclass(frozen=True)
class TurnGrid:
    """Nodes phi (n,), weights (n,) with sum 1 (so that the mean of f is weights @ f), and the arcs' node ranges."""

    phi: Array
    weights: Array
    arcs: tuple[tuple[float, float], ...]
    integration: Array  # (NODES, NODES): integrals from -1 to each node of the polynomial through values at the nodes

    @classmethod
    def between(cls, breakpoints: Sequence[float]) -> TurnGrid:
        """A grid on [0, 2 pi) with these breakpoints."""
        ends = [0.0]
        for cut in sorted(b % (2 * np.pi) for b in breakpoints):
            if cut - ends[-1] > SAME and 2 * np.pi - cut > SAME:
                ends.append(float(cut))
        ends.append(2 * np.pi)
        arcs = tuple((a, b) for a, b in pairwise(ends))
        nodes, weights = np.polynomial.legendre.leggauss(NODES)
        phi = np.concatenate([0.5 * (a + b) + 0.5 * (b - a) * nodes for a, b in arcs])
        w = np.concatenate([0.5 * (b - a) * weights for a, b in arcs]) / (2 * np.pi)
        # coefficients in Legendre polynomials by their orthogonality, which the rule keeps exactly
        to_legendre = (np.arange(NODES) + 0.5)[:, None] * np.polynomial.legendre.legvander(nodes, NODES - 1).T * weights
        integrals = np.stack(
            [
                np.polynomial.legendre.legval(nodes, np.polynomial.legendre.legint(np.eye(NODES)[k], lbnd=-1))
                for k in range(NODES)
            ],
            axis=1,
        )
        return cls(phi, w, arcs, integrals @ to_legendre)

    def mean(self, f: Sympy) -> complex:
        """Average over the turn."""
        return complex(self.weights @ f)

    def harmonic(self, k: int) -> Complex:
        """exp(i k phi)"""
        return np.asarray(elementary.exp(1j * k * self.phi))

    def antiderivative(self, f: Complex) -> Complex:
        """The zero-mean K with dK/dphi = f - mean(f)."""
        f = f - self.mean(f)
        total: complex = 0.0
        parts = []
        for k, (a, b) in enumerate(self.arcs):
            values = f[k * NODES : (k + 1) * NODES]
            half = 0.5 * (b - a)
            parts.append(total + half * (self.integration @ values))
            total += complex(2 * np.pi * (self.weights[k * NODES : (k + 1) * NODES] @ values))
        antiderivative = np.concatenate(parts)
        return np.asarray(antiderivative - self.mean(antiderivative))
