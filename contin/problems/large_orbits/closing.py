"""The direction in which an orbit at a branch point does not close, whatever its unknowns and the parameter do.

There [P - 1, v; v^T, 0], P the monodromy matrix and v the velocity, is singular, whether the period changes along the
family that crosses or not, and its left null vector is (p, 0).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from contin.abi import Array
from contin.linalg.vectors import norm
from contin.problems.large_orbits.cycle import Monodromy

if TYPE_CHECKING:
    from contin.problems.large_orbits.large_orbit_equations import LargeOrbitEquations


def across_closing(problem: LargeOrbitEquations, z: Array) -> Array | None:
    """p (n,) of length 1, from one solve with random borders; None where an equation is not finite."""
    sweeps, velocity = problem.sweeps(z), problem.velocity(z)
    if sweeps is None or not norm(velocity) > 0.0:
        return None
    generator = np.random.default_rng(37)
    b, c = (np.column_stack([velocity / norm(velocity), generator.normal(size=problem.n)]) for _ in range(2))
    left = Monodromy(sweeps, 1.0, b, c).adjoint(np.append(np.zeros(problem.n + 1), 1.0))[: problem.n]
    return left / norm(left) if np.all(np.isfinite(left)) and norm(left) > 0.0 else None
