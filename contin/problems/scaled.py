"""A problem in scaled unknowns y = z / scale, with its equations scaled alike: F_i / scale_i.

The u-block of its Jacobian is similar to F_u, so eigenvalues are unchanged; norms, borders and tolerances have a
meaning whatever the units of the states.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array


@dataclass(frozen=True, eq=False)
class ScaledSystem:
    """`Local` view of a problem for `contin.problems.defining`."""

    problem: Any
    scale: Array

    @property
    def n(self) -> int:
        return int(self.problem.n)

    def linearise(self, y: Array) -> tuple[Array, Array]:
        f, jacobian = self.problem.linearise(y * self.scale)
        d = self.scale[:-1]
        return f / d, jacobian * self.scale / d[:, None]

    def form(self, y: Array, *directions: NDArray[Any]) -> NDArray[Any]:
        """D^kF[d1, .., dk] in scaled unknowns."""
        return np.asarray(self.problem.form(y * self.scale, *(d * self.scale for d in directions)) / self.scale[:-1])

    def hessian(self, y: Array, v: NDArray[Any]) -> NDArray[Any]:
        matrix = self.problem.hessian(y * self.scale, v * self.scale)
        return np.asarray(matrix * self.scale / self.scale[:-1, None])
