"""The mass matrix of a user's function, M u' = F(u, p): read, checked, and divided by where that loses nothing."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import ArrayLike

from contin.abi import Array, Vector
from contin.errors import InputError
from contin.linalg.factor import Factoriser
from contin.linalg.linear import DirectLinear

if TYPE_CHECKING:
    from scipy.sparse import csc_matrix

SINGULAR: Final = 1e-10  # reciprocal condition number, up to which M is not divided by

Function = Callable[..., Any]


@dataclass(frozen=True, eq=False)
class Mass:
    """A constant M (n, n), regular or not."""

    matrix: csc_matrix

    @classmethod
    def of(cls, given: Any, n: int) -> Mass:
        """From a vector (its diagonal), an array or a scipy.sparse matrix."""
        from scipy.sparse import csc_matrix, diags, issparse

        if not issparse(given):
            try:
                given = np.asarray(given, dtype=float)
            except (TypeError, ValueError):
                raise InputError(
                    f"mass must be a vector, an array or a scipy.sparse matrix of numbers; got {type(given).__name__} "
                    "(a mass matrix that changes with states or parameters: give M^-1 F as the residual)"
                ) from None
            if given.ndim == 1:
                given = diags(given)
        matrix = csc_matrix(given, dtype=float)
        if matrix.shape != (n, n):
            raise InputError(f"mass must have shape ({n}, {n}), or ({n},) for a diagonal; got {np.shape(given)}")
        matrix.sum_duplicates()
        matrix.eliminate_zeros()
        if not np.all(np.isfinite(matrix.data)):
            raise InputError("mass must hold finite numbers")
        if not matrix.nnz:
            raise InputError("mass is zero: nothing moves; for solutions of F = 0 alone leave it out")
        return cls(matrix)

    @property
    def words(self) -> str:
        """What is singular about it."""
        still = np.flatnonzero(np.diff(self.matrix.tocsr().indptr) == 0)
        if not still.size:
            return "its rows depend on each other"
        named = ", ".join(map(str, still[:6])) + (", ..." if still.size > 6 else "")
        return f"equations {named} are algebraic" if still.size > 1 else f"equation {named} is algebraic"

    @cached_property
    def is_diagonal(self) -> bool:
        matrix = self.matrix.tocoo()
        return bool(np.all(matrix.row == matrix.col))

    @cached_property
    def is_regular(self) -> bool:
        """Whether M can be divided by."""
        if self.is_diagonal:
            return bool(np.all(self._diagonal != 0.0))
        rows, columns = (np.asarray(abs(self.matrix).sum(axis=axis)).ravel() for axis in (0, 1))
        if not (np.all(rows > 0.0) and np.all(columns > 0.0)):
            return False
        generator = np.random.default_rng(7)
        x = generator.choice([-1.0, 1.0], self.matrix.shape[0])
        size = float(abs(self.matrix).sum(axis=0).max())
        with np.errstate(all="ignore"):
            y = self.divide(self.divide_transposed(x / np.abs(x).sum()))
        return bool(np.all(np.isfinite(y))) and float(np.abs(y).sum()) * size * size * SINGULAR * SINGULAR < 1.0

    @cached_property
    def _diagonal(self) -> Array:
        return np.asarray(self.matrix.diagonal())

    @cached_property
    def _linear(self) -> DirectLinear:
        return DirectLinear(self.matrix, Factoriser())

    def divide(self, right: Vector) -> Vector:
        """M^-1 right, of columns too."""
        if self.is_diagonal:
            return np.asarray((np.asarray(right).T / self._diagonal).T)
        if np.ndim(right) == 1:
            return np.asarray(self._linear.solve(np.asarray(right)))
        return np.column_stack([self._linear.solve(column) for column in np.asarray(right).T])

    def divide_transposed(self, right: Array) -> Array:
        """M^-T right."""
        return self._linear.factor.solve_transposed(right)


@dataclass(frozen=True, eq=False)
class Divided:
    """A function's parts, made into those of u' = M^-1 F."""

    mass: Mass
    n: int

    def vectors(self, function: Function | None) -> Function | None:
        """(...) -> (n,), of the residual, the slope by a parameter, the higher derivatives."""
        if function is None:
            return None

        def divided(*arguments: Any) -> Any:
            value = np.asarray(function(*arguments))
            fits = value.shape[:1] == (self.n,) and value.dtype.kind in "biufc"  # else it is said where it is checked
            return self.mass.divide(value) if fits else value

        return divided

    def jacobian(self, function: Function | None) -> Function | None:
        """(u, p) -> dF/du, dense, sparse (where M is diagonal it stays so) or a `LinearOperator`."""
        if function is None:
            return None
        from scipy.sparse import diags, issparse
        from scipy.sparse.linalg import LinearOperator

        def divided(u: Array, p: Any) -> Any:
            matrix = function(u, p)
            if np.shape(matrix) != (self.n, self.n):
                return matrix
            if isinstance(matrix, LinearOperator):
                return LinearOperator(
                    (self.n, self.n), matvec=lambda v: self.mass.divide(np.asarray(matrix @ v)), dtype=float
                )
            if issparse(matrix):
                if self.mass.is_diagonal:
                    return (diags(1.0 / self.mass.matrix.diagonal()) @ matrix).tocsc()
                matrix = matrix.toarray()
            return self.mass.divide(np.asarray(matrix, dtype=float))

        return divided

    def preconditioner(self, function: Function | None) -> Function | None:
        """(u, p) -> r -> about (M^-1 dF/du)^-1 r."""
        if function is None:
            return None

        def divided(u: Array, p: Any) -> Callable[[Array], ArrayLike]:
            apply = function(u, p)
            return lambda r: apply(self.mass.matrix @ r)

        return divided


def as_sparse(jacobian: Function) -> Function:
    """The same with arrays as scipy.sparse matrices."""
    from scipy.sparse import csc_matrix

    def sparse(u: Array, p: Any) -> Any:
        matrix = jacobian(u, p)
        return csc_matrix(matrix) if isinstance(matrix, np.ndarray) and matrix.ndim == 2 else matrix

    return sparse
