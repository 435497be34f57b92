"""Equations of a large system at many states: one by one, or at once where the model offers that."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol, runtime_checkable

import numpy as np
from scipy.sparse import csc_matrix

from contin.abi import Array
from contin.problems.sparse.jacobian import JacobianSource
from contin.records import Record
from contin.systems.functions.function_system import FunctionSystem

Apply = Callable[[Array], Array]  # v -> J v


@runtime_checkable
class AtOnce(Protocol):
    """A model that takes K states (n, K) at once."""

    def at_states(self, u: Array, p: Record) -> Array:
        """F (n, K)."""

    def jacobians_at(self, u: Array, p: Record) -> list[csc_matrix]:
        """dF/du, K of them."""

    def parameter_slopes_at(self, u: Array, p: Record, name: str) -> Array:
        """dF/dp_name (n, K)."""


@dataclass(frozen=True, eq=False)
class Points:
    """Values and derivatives at the rows of u (K, n), at parameters p (m,)."""

    system: FunctionSystem
    source: JacobianSource

    @cached_property
    def _at_once(self) -> AtOnce | None:
        """The model, where it takes many states; asked once, for that is slow."""
        model: object = self.system.model
        return model if isinstance(model, AtOnce) else None

    def weighed(self, v: Array) -> Array:
        """M v of rows (..., n), with the mass matrix or the identity."""
        mass = self.source.mass
        return v if mass is None else np.asarray((mass @ v.reshape(-1, v.shape[-1]).T).T.reshape(v.shape))

    def _named(self, p: Array) -> dict[str, float]:
        return dict(zip(self.system.parameter_names, p.tolist(), strict=True))

    def values(self, u: Array, p: Array) -> Array:
        """F (K, n), NaN where there is none."""
        if self._at_once is not None:
            return np.asarray(self._at_once.at_states(u.T, self._named(p)).T)
        return self.system.values(u, p)

    def jacobians(self, u: Array, p: Array) -> list[csc_matrix] | None:
        """dF/du; None where one of them is not finite."""
        if self._at_once is not None:
            found: Sequence[csc_matrix | None] = self._at_once.jacobians_at(u.T, self._named(p))
        else:
            found = [self._matrix(row, p) for row in u]
        made = [J for J in found if J is not None and np.all(np.isfinite(J.data))]
        return made if len(made) == len(found) else None

    def _matrix(self, u: Array, p: Array) -> csc_matrix | None:
        matrix: csc_matrix | None = self.system.attempt("Jacobian", lambda: self.source.matrix(u, p), None, u, p)
        return matrix

    def products(self, u: Array, p: Array) -> Sequence[Apply] | None:
        """v -> dF/du v, for a few v: no entries are made where the function gives products; None as above."""
        model = self.system.model
        if self._at_once is not None or (model.method == "sparse" and model.jacobian is not None):
            matrices = self.jacobians(u, p)
            return None if matrices is None else [J.__matmul__ for J in matrices]
        found = [self._product(row, p) for row in u]
        made = [product for product in found if product is not None]
        return made if len(made) == len(found) else None

    def _product(self, u: Array, p: Array) -> Apply | None:
        made: Apply | None = self.system.attempt("Jacobian", lambda: self.source.product(u, p), None, u, p)
        return made

    def parameter_slopes(self, u: Array, p: Array, k: int) -> Array:
        """dF/dp_k (K, n)."""
        if self._at_once is not None:
            return np.asarray(self._at_once.parameter_slopes_at(u.T, self._named(p), self.system.parameter_names[k]).T)
        return self.system.parameter_slopes(u, p, k)
