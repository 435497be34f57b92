"""Functions whose arrays are not numpy's (cupy, jax, torch): they get theirs, and what they return is taken back.

Nothing else touches their arrays, so that a module which refuses to be converted by numpy (cupy) works as it is.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from contin.abi import Array, Vector
from contin.errors import InputError

if TYPE_CHECKING:
    from scipy.sparse.linalg import LinearOperator

Function = Callable[..., Any]


@dataclass(frozen=True, eq=False)
class Elsewhere:
    """`give` makes the user's array of a numpy vector, `take` a numpy vector of the user's array."""

    give: Function
    take: Function

    @classmethod
    def of(cls, arrays: object) -> Elsewhere:
        """From a pair such as (cupy.asarray, cupy.asnumpy)."""
        if not isinstance(arrays, tuple) or len(arrays) != 2 or not all(callable(one) for one in arrays):
            raise InputError(
                "arrays must be a pair of functions, from numpy and back to it, such as (cupy.asarray, cupy.asnumpy); "
                f"got {arrays!r}"
            )
        return cls(*arrays)

    def function(self, function: Function) -> Function:
        """(u, p, ...) -> array, arrays of numpy on the outside; names and parameters pass."""

        def called(u: Vector, p: object, *others: object) -> Vector:
            return np.asarray(self.take(function(self.give(u), p, *(self._given(one) for one in others))))

        return called

    def record(self, function: Function) -> Function:
        """(u, p) -> {name: number}."""
        return lambda u, p: {name: float(value) for name, value in function(self.give(u), p).items()}

    def image(self, function: Function) -> Function:
        """u -> array."""
        return lambda u: np.asarray(self.take(function(self.give(u))))

    def product(self, jacobian: Function, n: int) -> Function:
        """(u, p) -> the function v -> dF/du v, or what has `@`, as a `LinearOperator` of numpy vectors."""
        from scipy.sparse.linalg import LinearOperator

        def operator(u: Array, p: object) -> LinearOperator:
            made = jacobian(self.give(u), p)
            apply = made if callable(made) else lambda v: made @ v
            return LinearOperator((n, n), matvec=self.image(apply), dtype=float)

        return operator

    def preconditioner(self, made: Function) -> Function:
        """(u, p) -> the function r -> about (dF/du)^-1 r."""
        return lambda u, p: self.image(made(self.give(u), p))

    def _given(self, one: object) -> object:
        return self.give(one) if isinstance(one, np.ndarray) else one
