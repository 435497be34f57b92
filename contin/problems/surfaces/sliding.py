"""The surface on which pseudo-equilibria lie, and the motion that slides on it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from contin.abi import Array
from contin.problems.surfaces.jumps import Jump

if TYPE_CHECKING:
    from contin.problems.one_parameter import InOneParameterProblem


@dataclass(frozen=True, eq=False)
class Sliding:
    """The surface that pseudo-equilibria lie on, and the problem of the equilibria beside it."""

    regular: InOneParameterProblem
    jump: Jump

    def weights(self, problem: InOneParameterProblem, z: Array) -> Array:
        """Of the field above the surface in the sliding motion, at rows z (k, n + 1): in (0, 1) where motion slides."""
        p = np.array([problem.full_parameters(row) for row in z])
        observed = problem.system.observables(np.ascontiguousarray(z[:, : problem.n]), p)
        return np.asarray(observed[:, -1])

    def drive(self, problem: InOneParameterProblem, z: Array) -> Array:
        """L f- - L f+ at rows z, relative to the lengths of the fields and of grad h.

        Positive where both fields lead to the surface, zero where they are tangent to it.
        """
        n, found = problem.n, []
        for row in z:
            p = problem.full_parameters(row)
            below, above = self.jump.lower.value(row[:n], p), self.jump.upper.value(row[:n], p)
            normal = self.jump.height(row[:n], p)[1][:n]
            size = np.linalg.norm(normal) * (np.linalg.norm(below) + np.linalg.norm(above))
            found.append(float(normal @ (below - above)) / max(float(size), 1e-300))
        return np.array(found)
