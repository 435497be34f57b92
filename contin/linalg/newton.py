"""Newton with one unknown held at a value, to full precision."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from contin.abi import Array

BUDGET = 12


def with_one_fixed(
    linearise: Callable[[Array], tuple[Array, Array]], index: int, guess: Array, value: float, scale: Array
) -> Array | None:
    """F(z) = 0 (N - 1 equations, rows scaled like the unknowns) with z[index] = value; None where Newton fails."""
    z = guess.copy()
    z[index] = value
    free = np.delete(np.arange(len(z)), index)
    rows = scale[:-1]
    before = np.inf
    for _ in range(BUDGET):
        f, jacobian = linearise(z)
        try:
            step = np.linalg.solve((jacobian * scale / rows[:, None])[:, free], -f / rows)
        except np.linalg.LinAlgError:  # as where Newton does not converge
            return None
        size = float(np.linalg.norm(step))
        if not np.isfinite(size) or size > 1.0:
            return None
        if size >= 0.5 * before and before < 1e-8:
            return z
        z[free] += scale[free] * step
        if size < 1e-15:
            return z
        before = size
    return z if before < 1e-8 else None
