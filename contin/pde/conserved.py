"""Fields whose mean their equation conserves: the mean is given, for every value of it has solutions of its own.

F has a zero eigenvalue with the left null vector w of the mean, w . F_f(u) = 0 for all u. What is followed is

    F_f(u) - (w . u_f - m(p))          at every node of the field

with the same solutions of mean m and the same eigenvalues but that zero, which becomes -1. Its blocks of rows are full.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from scipy.sparse import csc_matrix

from contin.abi import Array, Vector
from contin.errors import InputError
from contin.model.expression import Expression
from contin.pde.local_formula import LocalFormula, Values
from contin.pde.protocol import Equations, check_full
from contin.pde.slots import Slot

ROUNDING = 1e-9  # of the terms of a sum that must vanish


class Conserving:
    """Equations whose means of some fields are held at given values."""

    def __init__(self, free: Equations, means: Mapping[str, Expression], p: Values) -> None:
        self.drifting, self.n = free, free.n
        self.unknowns, self.grid, self.slots = free.unknowns, free.grid, free.slots
        check_full(self, "conserved")
        self._rows = {field: self._mean(field) for field in means}
        self._values = {field: LocalFormula(formula, {}, {}, 1) for field, formula in means.items()}
        self._check(p)

    def _mean(self, field: str) -> Array:
        """w (n,) with w . u the mean of the field."""
        total = self.unknowns.map_of(Slot(field, (0,) * len(self.grid.axes)))
        if total.T.nnz:
            raise InputError(f"values of {field} are given at a side, where it flows in and out: no mean is conserved")
        weights = self.grid.weights
        return np.asarray(total.S.T @ (weights / weights.sum()))

    def _check(self, p: Values) -> None:
        """What is declared is so at random states."""
        u = np.random.default_rng(0).normal(size=(self.n, 3))
        rates = self.drifting.value(u, p)
        for field, row in self._rows.items():
            flow, terms = np.abs(row @ rates), np.abs(row) @ np.abs(rates)
            if not np.all(flow <= ROUNDING * terms):
                raise InputError(
                    f"the equation of {field} does not conserve its mean on this grid: at a random state it changes at "
                    f"{float(np.max(flow / terms)):.1e} of its terms. Write it as derivatives of fluxes"
                )

    def value(self, u: Vector, p: Values) -> Vector:
        """F with the means held, of one state or of K."""
        out = self.drifting.value(u, p)
        for field, row in self._rows.items():
            out[self.unknowns.places[field]] -= row @ u - self._values[field].value([], p)[0]
        return out

    def jacobian(self, u: Array, p: Values) -> csc_matrix:
        """The exact Jacobian, with full blocks."""
        out = self.drifting.jacobian(u, p).toarray()
        for field, row in self._rows.items():
            out[self.unknowns.places[field]] -= row
        return csc_matrix(out)

    def jacobians(self, u: Array, p: Values) -> list[csc_matrix]:
        """At K states."""
        return [self.jacobian(column, p) for column in u.T]

    def forms(self, u: Array, p: Values, directions: Sequence[tuple[Array, Mapping[str, float]]]) -> Array:
        """D^k F[d_1, ..., d_k]; the means are linear in u."""
        out = self.drifting.forms(u, p, directions)
        whole, rates = frozenset(range(len(directions))), [rate for _, rate in directions]
        for field, row in self._rows.items():
            change = -self._values[field].jet([], p, rates, whole)[whole][0]
            if len(directions) == 1:
                change = change + row @ directions[0][0]
            out[self.unknowns.places[field]] -= change
        return out

    def fields(self, u: Array, p: Values) -> dict[str, Array]:
        """As they are."""
        return self.drifting.fields(u, p)
