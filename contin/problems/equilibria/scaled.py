"""A problem in scaled unknowns y = z / scale, with its equations scaled alike: F_i / scale_i.

The u-block of its Jacobian is similar to F_u, so eigenvalues are unchanged; norms, borders and tolerances have a
meaning whatever the units of the states. Equations that are orders of magnitude faster than others are also divided by
their rate, `rated`: F_i / (scale_i rate_i), and F_u - lambda I becomes diag(1 / rate) (F_u - lambda I). Equations that
have no time always are: which state belongs to which is a matter of their order, and their units are their own.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Array, Vector
from contin.machine.elementary import log
from contin.problems.equilibria.defining_in_kernel import BorderedEquations, bordered_equations
from contin.problems.equilibria.solved_to_rounding import generic
from contin.systems.accuracy import error_of_grain

if TYPE_CHECKING:
    from contin.problems.equilibria.equations import AlgebraicEquations

BESIDE: Final = 1e-2  # scaled
ALIKE: Final = 0.9  # correlation of the rates' logarithms at a point and around it
FAR_APART: Final = 100.0  # ratio of the rows' sizes from which equations are divided by their rates


@dataclass(frozen=True, eq=False)
class ScaledSystem:
    """`Local` view of a problem for `contin.problems.equilibria.defining`."""

    problem: AlgebraicEquations
    scale: Array
    rates: Array | None = None

    @property
    def n(self) -> int:
        return int(self.problem.n)

    @property
    def grained(self) -> bool:
        """Values are rounded to some digits, or noisy."""
        return error_of_grain(self.problem.system) > 0.0

    @property
    def identity(self) -> Array:
        """What the states' identity matrix becomes, (n, n)."""
        return np.eye(self.n) if self.rates is None else np.diag(1.0 / self.rates)

    def rated(self, y: Array) -> ScaledSystem:
        """The same with fast equations divided by their rates, as they are around y.

        At y itself an equation may have no derivatives at all (a branch point), beside it only in special directions.
        """
        beside = BESIDE * generic(len(y))
        rows = np.abs(self.linearised(np.array([y, y + beside, y - beside]))[1]).max(axis=2)
        here, around = rows[0], np.maximum(rows[1], rows[2])
        if self.problem.is_timeless:
            return self._equilibrated(np.maximum(here, around))
        extents = [(min(sizes), max(sizes)) for sizes in (here.tolist(), around.tolist())]
        if not (np.isfinite(rows).all() and min(least for least, _ in extents) > 0.0):
            return self
        if min(most / least for least, most in extents) <= FAR_APART:
            return self
        logs = [log(sizes) - log(sizes).mean() for sizes in (here, around)]
        if logs[0] @ logs[1] <= ALIKE * np.linalg.norm(logs[0]) * np.linalg.norm(logs[1]):  # not rates, but bad scales
            return self
        return replace(self, rates=around if self.rates is None else around * self.rates)

    def _equilibrated(self, rows: Array) -> ScaledSystem:
        """The same with every equation divided by its row's size; equations of size zero stay."""
        if not np.all(np.isfinite(rows)):
            return self
        sizes = np.where(rows > 0.0, rows, 1.0)
        return replace(self, rates=sizes if self.rates is None else sizes * self.rates)

    def linearise(self, y: Array) -> tuple[Array, Array]:
        f, jacobian = self.problem.linearise(y * self.scale)
        d = self._rows
        return f / d, jacobian * self.scale / d[:, None]

    def linearised(self, y: Array) -> tuple[Array, Array]:
        """`linearise` at m places (m, n + 1): (m, n) and (m, n, n + 1)."""
        f, jacobians = self.problem.linearised(y * self.scale)
        d = self._rows
        return f / d, jacobians * self.scale / d[:, None]

    def form(self, y: Array, *directions: Vector) -> Vector:
        """D^kF[d1, .., dk] in scaled unknowns."""
        return np.asarray(self.problem.form(y * self.scale, *(d * self.scale for d in directions)) / self._rows)

    def hessian(self, y: Array, v: Vector) -> Vector:
        matrix = self.problem.hessian(y * self.scale, v * self.scale)
        return np.asarray(matrix * self.scale / self._rows[:, None])

    def bordered(
        self, kind: int, b: Vector, c: Vector, shift: float = 0.0, unit: float = 1.0
    ) -> BorderedEquations | None:
        return bordered_equations(self, kind, b, c, shift, unit)

    @property
    def _rows(self) -> Array:
        return self.scale[:-1] if self.rates is None else self.scale[:-1] * self.rates
