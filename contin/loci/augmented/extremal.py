"""Extrema of a column along a curve, held while further parameters vary (successive extremum continuation).

An extremum of phi over the solutions of E = 0, with the newest parameters fixed: D phi vanishes on the null space W of
E' in which these do not vary. With m directions in W that makes m scalars, so one more parameter gives a curve of
extrema, and an extremum of phi on that curve is one in two parameters, and so on (Kernevez and Doedel 1987).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Array
from contin.continuation.corrector import is_singular
from contin.loci.augmented.elimination import Scalars, first_rows, null_space, orthonormal

if TYPE_CHECKING:
    from contin.loci.augmented.curve_equations import CurveEquations

STEP: Final = 1e-3  # scaled, of the five-point differences of the column
ROUNDS: Final = 3


@dataclass(frozen=True)
class Extremal:
    """`column` is stationary while the parameter `newest` of the curve is fixed."""

    column: str
    newest: str

    @property
    def text(self) -> str:
        return f"extrema of {self.column}"

    def near(self, problem: CurveEquations, z: Array, scale: Array) -> Scalars:
        base = problem.base
        fixed = np.zeros((1, z.size))
        fixed[0, -1 - base.names.index(self.newest)] = 1.0
        count = base.varying - base.conditions - 1
        across = first_rows(count, z.size)

        def directions(at: Array, rows: Array) -> Array | None:
            here = base.linearise(at, scale, np.vstack([fixed, rows]))
            if here is None or is_singular(here):
                return None
            return null_space(here, count + 1)[:, 1:]

        for _ in range(ROUNDS):
            found = directions(z, across)
            if found is not None and np.all(np.isfinite(found)):
                across = orthonormal(found.T)
        place = base.names.index(self.column) if self.column in base.names else None

        def values(at: Array) -> Array:
            w = directions(at, across)
            if w is None:
                return np.full(count, np.nan)
            if place is not None:
                return np.asarray(w[-1 - place])
            steps = STEP * scale[:, None] * w
            stencil = np.concatenate([at + k * step for step in steps.T for k in (-2.0, -1.0, 1.0, 2.0)])
            found = base.column(self.column, stencil.reshape(-1, z.size)).reshape(count, 4)
            far, near = found[:, 3] - found[:, 0], found[:, 2] - found[:, 1]
            return np.asarray((8.0 * near - far) / (12.0 * STEP))

        return values
