"""Defining systems of equilibria and fixed points as kernels evaluate them: few states, compiled equations."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final, Protocol

import numpy as np

from contin.abi import NO_FUNCTION, Array, Vector
from contin.kernels import defining as kernel
from contin.kernels.defining import BRANCH, FOLD, PAIR
from contin.lowering.system import CompiledSystem

if TYPE_CHECKING:
    from contin.problems.equilibria.equations import AlgebraicEquations

MOST: Final = 20  # states: beyond, LAPACK's blocks are faster than plain loops
NONE: Final = np.empty(0)
NO_MATRICES: Final = np.empty((0, 0, 0))


class Scaled(Protocol):
    """What kernels are told of equations in scaled unknowns (`contin.problems.equilibria.scaled`)."""

    @property
    def problem(self) -> AlgebraicEquations: ...
    @property
    def n(self) -> int: ...
    @property
    def scale(self) -> Array: ...
    @property
    def rates(self) -> Array | None: ...


@dataclass(frozen=True, eq=False)
class BorderedEquations:
    """The residuals of `contin.kernels.defining`, their Jacobian and the sizes of their terms, at places x."""

    arguments: tuple[Any, ...]  # of the kernel, up to x
    further: tuple[Any, ...]  # ... after x
    memory: tuple[Any, ...]
    count: int  # of residuals

    def at(self, x: Array) -> tuple[Array, Array]:
        """Residuals (k,) and Jacobian (k, unknowns)."""
        residuals, matrices = np.empty((1, self.count)), np.empty((1, self.count, len(x)))
        kernel.evaluate(*self.arguments, x[None], *self.further, residuals, matrices, NONE, *self.memory)
        return residuals[0], matrices[0]

    def values(self, x: Array) -> Array:
        """Residuals at rows x, (m, k)."""
        residuals = np.empty((len(x), self.count))
        kernel.evaluate(*self.arguments, x, *self.further, residuals, NO_MATRICES, NONE, *self.memory)
        return residuals

    def terms(self, x: Array) -> Array:
        """Sizes of the terms that the residuals at x are made of, (k,)."""
        residuals, terms = np.empty((1, self.count)), np.empty(self.count)
        kernel.evaluate(*self.arguments, x[None], *self.further, residuals, NO_MATRICES, terms, *self.memory)
        return terms

    def around(self, x: Array) -> tuple[Array, Array, Array]:
        """Residuals at rows x, Jacobians at the first two, and sizes of the terms at the first."""
        residuals, matrices = np.empty((len(x), self.count)), np.empty((2, self.count, x.shape[1]))
        terms = np.empty(self.count)
        kernel.evaluate(*self.arguments, x, *self.further, residuals, matrices, terms, *self.memory)
        return residuals, matrices, terms


def bordered_equations(
    local: Scaled, kind: int, b: Vector, c: Vector, shift: float = 0.0, unit: float = 1.0
) -> BorderedEquations | None:
    """The equations with these borders, (n, 1) and (columns, 1), of BRANCH (n + 1, 2); None where Python has them."""
    problem, n = local.problem, local.n
    system = problem.system
    if not isinstance(system, CompiledSystem) or n > MOST or system.jacobian_address == NO_FUNCTION:
        return None
    parameters = problem.base.copy()
    rows = local.scale[:-1] if local.rates is None else local.scale[:-1] * local.rates
    left, right = np.zeros((2, n)), np.zeros((2, n + 1))
    left[0], right[0, : len(c)] = b[:, 0].real, c[:, 0].real
    if kind == BRANCH:
        right[1] = c[:, 1]
    if kind == PAIR:
        left[1], right[1, : len(c)] = b[:, 0].imag, c[:, 0].imag
    return BorderedEquations(
        (system.jacobian_address, system.gradient_address, problem.is_map, kind),
        (
            parameters, problem.active, local.scale, rows, np.ones(n) if local.rates is None else 1.0 / local.rates,
            left, right, shift, unit,
        ),
        kernel.memory(n, len(parameters), kind),
        n + 1 if kind == FOLD else n + 2,
    )  # fmt: skip
