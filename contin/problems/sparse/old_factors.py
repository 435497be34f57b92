"""Large matrices of neighbouring points, solved by GMRES with the factors of one of them.

As a preconditioner, factors in single precision are as good as others and half as dear.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from contin.abi import Array
from contin.linalg.by_rows import ByRows
from contin.linalg.factor import Factoriser
from contin.linalg.linear import KrylovLinear

if TYPE_CHECKING:
    from scipy.sparse import csc_matrix

WORTH = 200  # solves that take as long as new factors (51 and 56 on meshes of 300 x 300 and 1,000 x 1,000 nodes) and
# the search for eigenvalues that comes with them
TOO_MANY = 20  # GMRES iterations of one solve from which old factors are renewed whatever they cost
NEAR = 1e-3  # change of the states, as a part of the largest, or of a parameter from which factors are another point's


class OldFactors:
    """Makes operators with the last factors, and new factors where those have become the dearer ones."""

    def __init__(self, factoriser: Factoriser, mass: csc_matrix = None) -> None:
        self.factoriser, self.mass = factoriser, mass
        self._by_rows = ByRows()
        self._last: KrylovLinear | None = None
        self._points = self._spent = 0  # that the factors have served, and the GMRES iterations there
        self._place = np.empty(0), np.empty(0)  # where they were made

    def forget(self) -> None:
        """The next matrix is factored."""
        self._last = None

    def at(self, matrix: csc_matrix, u: Array, p: Array) -> KrylovLinear:
        """The matrix as an operator.  u, p : states (n,) and parameters (m,) where it belongs."""
        product = self._by_rows.product(matrix)
        last, tally = self._last, self.factoriser.tally
        if last is None or last.precise is None or self._worn_out(last):
            self._points, self._spent, self._place = 0, 0, (u.copy(), p.copy())
            rough = self.factoriser.rough(matrix)
            factor = self.factoriser.factor(matrix) if rough is None else rough
            exact = rough is None
            self._last = KrylovLinear(
                product, factor.solve, factor, exact, fresh=True, matrix=matrix, tally=tally, mass=self.mass
            )
            return self._last
        near = is_near(u, p, *self._place)
        self._last = KrylovLinear(
            product, last.precise.solve, last.precise, near=near, matrix=matrix, tally=tally, mass=self.mass
        )
        self._last.borders = last.borders
        return self._last

    def _worn_out(self, last: KrylovLinear) -> bool:
        """True where new factors pay: the last point took more solves than all points of these have on the average.

        Their own cost is counted with them, so that the average falls at first. Not asked where they were made: many
        solves there are a label's.
        """
        if last.near:
            return last.iterations > TOO_MANY
        self._points += 1
        self._spent += last.used
        return last.used * self._points > WORTH + self._spent or last.iterations > TOO_MANY


def is_near(u: Array, p: Array, other_u: Array, other_p: Array) -> bool:
    """Whether a matrix at states u and parameters p is hardly another one than that at others; each in its own unit."""
    moved = float(np.abs(u - other_u).max(initial=0.0)) <= NEAR * float(np.abs(u).max(initial=0.0))
    return moved and bool(np.all(np.abs(p - other_p) <= NEAR * np.abs(p)))
