"""Zeros of the reduced equations on a sphere, where ker J has dimension above 2, by Newton from many starts."""

from __future__ import annotations

from typing import Final

import numpy as np

from contin.abi import Array
from contin.problems.equilibria.branching.reduced import ReducedEquations

STARTS: Final = 120  # a dimension of the kernel
ROUNDS: Final = 3  # ... so often again while the degree says that one is missing
SAME: Final = 1e-7  # of the radius: zeros this near are one
DISTINCT: Final = 1e-5  # ... and must otherwise be this far apart


def sphere_zeros(reduced: ReducedEquations, radius: float) -> list[Array] | None:
    """The zeros with |c| = radius, as points; None where they are not isolated, or one is missing by the degree of h.

    Degree 0 does not prove that all are there: two of opposite sign may be missing.
    """
    generator = np.random.default_rng(7)
    m = reduced.kernel.shape[1]
    found: list[Array] = []
    signs = 0.0
    for _ in range(ROUNDS):
        for _ in range(STARTS * (m - 1)):
            c = generator.normal(size=m)
            c = c * radius / float(np.linalg.norm(c))
            _add(found, reduced.on_sphere(reduced.y + reduced.kernel @ c, radius), radius)
        distances = [float(np.linalg.norm(a - b)) for i, a in enumerate(found) for b in found[:i]]
        if len(found) > 6 * 3**m or min(distances, default=1.0) < DISTINCT:
            return None  # a continuum, or as good as one
        signs = sum(reduced.sign(at) for at in found)
        if signs == 0.0:
            return found
    return None


def _add(found: list[Array], at: Array | None, radius: float) -> None:
    if at is not None and all(float(np.linalg.norm(at - other)) > SAME * radius for other in found):
        found.append(at)
