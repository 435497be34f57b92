"""The Jacobian F_u at one point as a linear operator that can be solved with, shifted and bordered."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from contin.problems.sparse_bordered import Approximate, ApproximateBordered, bordered
from contin.problems.sparse_factor import Factor, Factoriser
from contin.problems.sparse_krylov import TOLERANCE, gmres

Vector = NDArray[Any]
ACCURATE = 1e-6  # relative residual of GMRES beyond which a solution is not one


class Solution(Protocol):
    """Solves a bordered system."""

    def solve(self, right: Vector) -> Vector: ...


class Linear(Protocol):
    """A square operator A."""

    @property
    def determinant(self) -> tuple[float, float] | None:
        """Sign and logarithm of |det A|, where factors give it."""

    def apply(self, x: Vector) -> Vector:
        """A x."""

    def solve(self, right: Vector) -> Vector:
        """A^-1 right."""

    def bordered(self, columns: Vector, rows: Vector, corner: Vector) -> Solution:
        """[A B; C^T D] with B = columns (n, k), C = rows (n, k), D = corner (k, k)."""

    def shifted(self, shift: complex) -> Linear:
        """A - shift I."""


class DirectLinear:
    """A sparse matrix, factored when first needed."""

    def __init__(self, matrix: Any, factoriser: Factoriser) -> None:
        self.matrix, self.factoriser = matrix, factoriser

    @cached_property
    def factor(self) -> Factor:
        return self.factoriser.factor(self.matrix)

    @property
    def determinant(self) -> tuple[float, float] | None:
        return self.factor.sign, self.factor.log_determinant

    def apply(self, x: Vector) -> Vector:
        return np.asarray(self.matrix @ x)

    def solve(self, right: Vector) -> Vector:
        return self.factor.solve(right)

    def bordered(self, columns: Vector, rows: Vector, corner: Vector) -> Solution:
        return bordered(self.factor, columns, rows, corner)

    def shifted(self, shift: complex) -> DirectLinear:
        from scipy.sparse import identity

        value = shift if np.imag(shift) != 0.0 else float(np.real(shift))
        moved = (self.matrix - value * identity(self.matrix.shape[0], format="csc")).tocsc()
        moved.sort_indices()
        return DirectLinear(moved, Factoriser())


class KrylovLinear:
    """An operator that is only applied; solved by GMRES with a preconditioner (an approximate inverse).

    `precise` is a factor of a nearby matrix where there is one: then borders are eliminated with it (BEMW).
    """

    determinant = None

    def __init__(
        self, apply: Callable[[Vector], Vector], precondition: Callable[[Vector], Vector], precise: Factor | None = None,  # noqa: E501
        shift: complex = 0.0,
    ) -> None:  # fmt: skip
        self._apply, self._precondition, self._precise, self._shift = apply, precondition, precise, shift
        self.iterations = 0  # of the worst solve so far: when it grows, the preconditioner is out of date

    def apply(self, x: Vector) -> Vector:
        if np.iscomplexobj(x):
            value: Vector = self._apply(x.real) + 1j * self._apply(x.imag)
        else:
            value = self._apply(x)
        return value - self._shift * x if self._shift else value

    def _approximate(self, right: Vector) -> Vector:
        if np.iscomplexobj(right):
            return self._precondition(right.real) + 1j * self._precondition(right.imag)
        return self._precondition(right)

    def _finish(self, found: tuple[Vector, int, float]) -> Vector:
        x, used, residual = found
        self.iterations = max(self.iterations, used)
        return x if residual <= max(ACCURATE, TOLERANCE) else np.full_like(x, np.nan)

    def solve(self, right: Vector) -> Vector:
        return self._finish(gmres(self.apply, self._approximate, right))

    def bordered(self, columns: Vector, rows: Vector, corner: Vector) -> Solution:
        return KrylovBordered(self, columns, rows, corner)

    def shifted(self, shift: complex) -> KrylovLinear:
        return KrylovLinear(self._apply, self._precondition, None, self._shift + shift)


class KrylovBordered:
    """GMRES on the whole bordered operator, which is regular where A is singular."""

    def __init__(self, linear: KrylovLinear, columns: Vector, rows: Vector, corner: Vector) -> None:
        self.linear, self.columns, self.rows, self.corner = linear, columns, rows, corner
        complex_ = any(np.iscomplexobj(a) for a in (columns, rows, corner)) or linear._shift != 0.0
        self.complex_ = complex_
        if linear._precise is not None and not complex_:
            self.preconditioner: Any = bordered(linear._precise, columns, rows, corner)
        else:
            self.preconditioner = ApproximateBordered(Approximate(linear._approximate), columns, rows, corner)

    def _apply(self, x: Vector) -> Vector:
        n = len(self.columns)
        state, rest = x[:n], x[n:]
        return np.concatenate(
            [self.linear.apply(state) + self.columns @ rest, self.rows.T @ state + self.corner @ rest]
        )

    def solve(self, right: Vector) -> Vector:
        if self.complex_ and not np.iscomplexobj(right):
            right = right.astype(complex)
        return self.linear._finish(gmres(self._apply, self.preconditioner.solve, right))
