"""Centre manifolds of large systems: homological equations solved with sparse factors of A - s M, bordered.

Everything beside the solves is `CentreManifold`'s: it asks for multilinear forms, which a large system has, and for
products with the mass matrix. Left eigenvectors are the last rows of inverses of bordered matrices.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, Final, Literal, cast

import numpy as np

from contin.abi import Vector
from contin.linalg.linear import Linear, Solution
from contin.linalg.vectors import norm
from contin.normalforms.homological import CentreManifold, Index
from contin.normalforms.jet import Jet
from contin.normalforms.linear import ORTHOGONAL, RESONANT, SINGULAR, EigenPair
from contin.normalforms.result import NotThisTypeError
from contin.problems.sparse.forms import Derivatives, unit

REFINED: Final = 3  # times by inverse iteration, whose error is squared each time


@dataclass(frozen=True, eq=False)
class LargeJet:
    """What `CentreManifold` asks of a jet beside solves; `active`: places of the active parameters among all."""

    derivatives: Derivatives
    linear: Linear
    active: tuple[int, ...] = ()
    kind: Literal["flow"] = "flow"

    @property
    def n(self) -> int:
        return self.derivatives.problem.n

    @property
    def parameters(self) -> int:
        return len(self.active)

    @property
    def mass(self) -> Any:
        return self.linear.mass

    def form(self, *directions: Vector) -> Vector:
        n = self.n
        wide = []
        for d in directions:
            row = np.zeros(n + self.derivatives.problem.system.m, d.dtype)
            row[:n], row[[n + k for k in self.active]] = d[:n], d[n:]
            wide.append(row)
        return self.derivatives.in_all(*wide)


@dataclass(frozen=True, eq=False)
class Solves:
    """Solutions with A - s M, bordered; factors are kept, for the same equations come again with other right sides."""

    linear: Linear
    _known: dict[tuple[complex, tuple[int, ...]], tuple[Linear, Solution | None]] = field(default_factory=dict)

    def __call__(self, shift: complex, resonant: Sequence[int], columns: Vector, rows: Vector, right: Vector) -> Vector:
        """x of [[A - s M, columns], [rows^H, 0]] [x; y] = [right; 0], refined once.

        LinAlgError where the matrix is singular to rounding: another eigenvalue is resonant.
        """
        if not right.any():
            return right
        key = complex(shift), tuple(resonant)
        if key not in self._known:
            self._known[key] = self._made(shift, columns, rows)
        matrix, solution = self._known[key]
        x, y = _solved(matrix, solution, right, columns.shape[1])
        left = right - matrix.apply(x) - columns @ y
        more, _ = _solved(matrix, solution, left, columns.shape[1])
        x = x + more
        if not norm(matrix.magnitude(np.abs(x))) * SINGULAR <= norm(right):  # not so for nan
            raise np.linalg.LinAlgError(RESONANT)
        return x

    def _made(self, shift: complex, columns: Vector, rows: Vector) -> tuple[Linear, Solution | None]:
        matrix, k = self.linear.shifted(shift), columns.shape[1]
        if not k:
            return matrix, None
        return matrix, matrix.bordered(columns, rows.conj(), np.zeros((k, k)))


def _solved(matrix: Linear, solution: Solution | None, right: Vector, borders: int) -> tuple[Vector, Vector]:
    """(x, y); of a real matrix without borders in the real and the imaginary part, for its factors are real."""
    if solution is not None:
        found = solution.solve(np.append(right, np.zeros(borders)))
        return found[: len(right)], found[len(right) :]
    none = np.zeros(0)
    if np.iscomplexobj(right) and not np.iscomplexobj(matrix.matrix.data):
        return matrix.solve(right.real.copy()) + 1j * matrix.solve(right.imag.copy()), none
    return matrix.solve(right), none


class LargeManifold(CentreManifold):
    """`CentreManifold` of a large system; errors of its coefficients are told by other derivatives."""

    def __init__(self, jet: LargeJet, pairs: Sequence[EigenPair], solves: Solves) -> None:
        super().__init__(cast(Jet, jet), pairs)  # its matrix is asked by dense solves and sums of moduli only
        self._solves = solves

    def _solve(self, v: Index, shift: complex, resonant: list[int]) -> None:
        columns, rows = self._borders(resonant) if resonant else (np.zeros((self.jet.n, 0)),) * 2
        self._h[v] = self._solves(shift, resonant, columns, rows, -self._inhomogeneity(v))


def pair_of(linear: Linear, value: complex, q: Vector) -> EigenPair:
    """The eigenvectors to the imaginary eigenvalue (or zero) next to `value`, by inverse iteration from q.

    NotThisTypeError without a matrix; ZeroDivisionError where <p, M q> vanishes: the eigenvalue is not simple.
    """
    if linear.matrix is None:
        raise NotThisTypeError("the Jacobian is only applied, and shifted systems are solved with factors of a matrix")
    value = 1j * value.imag
    q = unit(linear, q if value else np.real(q))
    for _ in range(REFINED):
        shifted = linear.shifted(value)
        border = linear.weigh(q)
        solution = shifted.bordered(border[:, None], q.conj()[:, None], np.zeros((1, 1)))
        found = solution.solve(np.append(np.zeros(len(q), q.dtype), 1.0))
        row = solution.last_row()
        if row is None or not np.isfinite(found).all() or not np.isfinite(row).all():
            raise np.linalg.LinAlgError("its eigenvectors are not found")
        p, q = row[:-1].conj(), unit(linear, found[:-1])
        moved = linear.weigh(q)
        product = np.vdot(p, moved)
        if not abs(product) > ORTHOGONAL * norm(p) * norm(moved):
            raise ZeroDivisionError("left and right null vectors are orthogonal: the eigenvalue is not simple")
        if value:
            value = 1j * complex(np.vdot(p, linear.apply(q)) / product).imag
    return EigenPair(value, q, p / np.conj(product), 0.0, np.inf)
