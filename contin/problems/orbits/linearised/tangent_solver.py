"""Sparse LU factors of the equations with a tangent, as the march in Python wants them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.linalg.csc import with_rows
from contin.linalg.lu import sign_of

if TYPE_CHECKING:
    from scipy.sparse import csc_matrix


@dataclass(frozen=True, eq=False)
class Factorised:
    """Factors of [J; t^T] in the unknowns x; mesh and time, which are part of z, do not move."""

    equations: Array
    factors: Any
    where: NDArray[np.intp]  # places of x in z
    size: int  # of z

    @cached_property
    def residual(self) -> Array:
        return np.concatenate([self.equations, np.zeros(self.size - 1 - self.equations.size)])

    @cached_property
    def sign(self) -> float:
        """Of the determinant, which changes where another curve crosses."""
        return sign_of(self.factors)

    log_determinant = 0.0  # branch points of such curves are not looked for
    regular = True  # see `factorised`

    def solve(self, right: Array) -> Array:
        out = np.zeros(self.size)
        out[self.where] = self.factors.solve(np.append(right[: self.equations.size], right[-1]))
        return out


def factorised(equations: Array, jacobian: csc_matrix, where: NDArray[np.intp], tangent: Array) -> Factorised | None:
    """None where something is not finite, or the matrix singular."""
    from scipy.sparse.linalg import splu

    if not (np.all(np.isfinite(equations)) and np.all(np.isfinite(jacobian.data))):
        return None
    try:
        lu = splu(with_rows(jacobian, tangent[where][None, :]), permc_spec="MMD_AT_PLUS_A")
    except RuntimeError:  # SuperLU: exactly singular
        return None
    return Factorised(equations, lu, where, tangent.size)
