"""How far a coefficient of a centre manifold is off beside a pole, where a further eigenvalue is nearly resonant.

(A - lambda.v) h = r has a nearly singular matrix there. It is known as well as the point is, and A to rounding: an
error dM of the matrix moves h by M^-1 dM h, however small the sum of the moduli of the coefficient's terms.
"""

from __future__ import annotations

from functools import lru_cache
from typing import Final

import numpy as np

from contin.abi import Vector
from contin.normalforms.jet import Jet, Real
from contin.normalforms.linear import solve

NEAR: Final = 100.0  # times its equation's right side, in balanced units: errors of h are then those of the matrix
ROUNDED: Final = 8.0 * float(np.finfo(float).eps)  # relative, of an entry of A, which is itself a sum
PATTERNS: Final = 3
SAFETY: Final = 6.0  # times the largest of a few samples


def off_beside_pole(
    jet: Jet, matrix: Vector, borders: tuple[Vector | None, Vector | None], direction: Vector, drift: Real | None
) -> list[Vector]:
    """By how much the solution h (`direction`, with the parameters) may be off: samples, each (n,).

    matrix, borders : of the equation for h, as for `linear.solve`.
    drift : estimated errors of the states and the active parameters, (n + parameters,).
    """
    found = []
    for signs, entries in _patterns(jet.n, jet.parameters):
        moved = ROUNDED * (jet.A * entries) @ direction[: jet.n]
        if drift is not None and drift.any():
            moved = moved + jet.form(direction, drift * signs)
        found.append(SAFETY * solve(matrix, moved, *borders))
    return found


@lru_cache(maxsize=64)
def _patterns(n: int, parameters: int) -> tuple[tuple[Real, Real], ...]:
    """Signs of (states and parameters) and of the entries of A."""
    random = np.random.default_rng(1)
    return tuple(
        (random.choice([-1.0, 1.0], n + parameters), random.choice([-1.0, 1.0], (n, n))) for _ in range(PATTERNS)
    )
