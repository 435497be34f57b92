"""What the Python march needs of a curve of special orbits: sparse LU factors of its equations with a tangent."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array


@dataclass(frozen=True, eq=False)
class OrbitLocusLinearisation:
    """Factors of [J; t^T] in the unknowns x; the mesh, which is part of z, does not move."""

    equations: Array
    factors: Any
    where: NDArray[np.intp]  # places of x in z
    size: int  # of z

    @cached_property
    def residual(self) -> Array:
        return np.concatenate([self.equations, np.zeros(self.size - 1 - self.equations.size)])

    @cached_property
    def sign(self) -> float:
        diagonal = np.sign(self.factors.U.diagonal())
        return float(np.prod(diagonal)) * _parity(self.factors.perm_r) * _parity(self.factors.perm_c)

    @cached_property
    def log_determinant(self) -> float:
        with np.errstate(divide="ignore"):
            return float(np.sum(np.log(np.abs(self.factors.U.diagonal()))))

    def solve(self, right: Array) -> Array:
        out = np.zeros(self.size)
        out[self.where] = self.factors.solve(np.append(right[: self.equations.size], right[-1]))
        return out


def _parity(permutation: NDArray[np.int32]) -> float:
    """+1 for an even permutation, -1 for an odd one."""
    order, seen, sign = permutation.tolist(), [False] * len(permutation), 1.0
    for start in range(len(order)):
        k, length = start, 0
        while not seen[k]:
            seen[k], k, length = True, order[k], length + 1
        if length and length % 2 == 0:
            sign = -sign
    return sign


def linearisation(curve: Any, z: Array, tangent: Array, scale: Array) -> OrbitLocusLinearisation | None:
    """At z, with the border row `tangent`; None where the equations are not finite or the matrix is singular."""
    from scipy import sparse
    from scipy.sparse.linalg import splu

    try:
        equations, jacobian = curve.linearise(z, scale)
        where = places(curve, z)
        if not (np.all(np.isfinite(equations)) and np.all(np.isfinite(jacobian.data))):
            return None
        factors = splu(sparse.vstack([jacobian, tangent[where][None, :]], format="csc"))
    except (RuntimeError, ValueError):  # SuperLU: exactly singular, or not finite
        return None
    return OrbitLocusLinearisation(equations, factors, where, z.size)


def places(curve: Any, z: Array) -> NDArray[np.intp]:
    """Positions of x = (u, T, [theta], second, first) in z."""
    nu = curve.profile(z).u.size
    return np.append(np.arange(nu + 1), np.arange(z.size - 2 - curve.extra, z.size))
