"""A solution at a fixed value of the varying parameter, to full precision."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from contin.abi import Array

if TYPE_CHECKING:
    from contin.problems.contracts import Dense

BUDGET = 12


def at_parameter(problem: Dense, guess: Array, value: float, scale: Array) -> Array | None:
    """Newton on F(u, value) = 0 from a guess, with the problem's `linearise`; None where it does not converge."""
    z = guess.copy()
    z[-1] = value
    d = scale[:-1]
    before = np.inf
    for _ in range(BUDGET):
        f, matrix = problem.linearise(z)
        try:
            step = np.linalg.solve(matrix[:, :-1] * d / d[:, None], -f / d)
        except np.linalg.LinAlgError:  # as where Newton does not converge
            return None
        size = float(np.linalg.norm(step))
        if not np.isfinite(size) or size > 1.0:
            return None
        if size >= 0.5 * before and before < 1e-8:
            return z
        z[:-1] += d * step
        if size < 1e-15:
            return z
        before = size
    return z if before < 1e-8 else None
