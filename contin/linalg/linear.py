"""The Jacobian F_u at one point as a linear operator that can be solved with, shifted and bordered."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from numpy.typing import NDArray

from contin.abi import Vector
from contin.linalg.balanced import Balanced
from contin.linalg.bordered import Approximate, ApproximateBordered, Solver, bordered
from contin.linalg.factor import Factor, Factoriser
from contin.linalg.krylov import COARSE, TOLERANCE, Accuracy, gmres
from contin.linalg.tally import Tally
from contin.linalg.vectors import combined, norm, plus_combined, products
from contin.machine import elementary

if TYPE_CHECKING:
    from scipy.sparse import csc_matrix

ALIKE = 0.8  # cosine (times the ratio of lengths) from which borders are taken for the same
SAME = 5e-2  # change of a column, as a part of it, up to which an approximate solution of it serves again
TELLING = 3  # iterations from which they tell a rate
ROUNDED = 1e-15  # relative residual below which rounding does not let it fall
EPSILON = float(np.finfo(float).eps)
SEVERAL = 100.0  # rounding errors of A x that a residual may have
ACCURATE = 1e-6  # relative residual of GMRES beyond which a solution is not one


class Solution(Protocol):
    """Solves a bordered system; `pivot` is the Schur complement of the last border (1 where it is not known)."""

    pivot: Any

    def solve(self, right: Vector) -> Vector: ...

    def last_row(self) -> Vector | None:
        """That of the inverse: what the last unknown is, as a functional of the right-hand side; None without A^T."""


class Linear(Protocol):
    """A square operator A, of M u' = A u."""

    matrix: Any  # sparse, or None
    mass: Any  # M, sparse; None: the identity

    def weigh(self, x: Vector) -> Vector:
        """M x."""

    def precondition(self, right: Vector) -> Vector:
        """About A^-1 right."""

    @property
    def sign(self) -> float:
        """Of det A where factors give it, else 1."""

    def apply(self, x: Vector) -> Vector:
        """A x."""

    def magnitude(self, x: Vector) -> Vector:
        """|A| x for x >= 0, or what is about as large: the scale of rounding errors in A x."""

    def solve(self, right: Vector, tolerance: float = 0.0) -> Vector:
        """A^-1 right; iterative methods stop at this relative residual, or where they do without it."""

    def bordered(self, columns: Vector, rows: Vector, corner: Vector, coarse: bool = False) -> Solution:
        """[A B; C^T D] with B = columns (n, k), C = rows (n, k), D = corner (k, k).

        `coarse` allows iterative methods an error of 1e-7, enough for Newton steps and tangents.
        """

    def shifted(self, shift: complex) -> Linear:
        """A - shift M."""


def fastest_rate(linear: Linear, sizes: NDArray[np.float64]) -> float:
    """The largest row sum of |A| in units of sizes (n,): no motion of A is faster, in any units of the states."""
    return float(np.max(linear.magnitude(sizes) / sizes))


def is_symmetric(matrix: csc_matrix) -> bool:
    """To rounding."""
    return bool(abs(matrix - matrix.T).max() <= SEVERAL * EPSILON * abs(matrix).max())


def moving(linear: Linear) -> NDArray[np.bool_] | slice:
    """The states with mass, over which vectors of normal forms have length 1."""
    return slice(None) if linear.mass is None else np.diff(linear.mass.indptr) > 0


class DirectLinear:
    """A sparse matrix, factored when first needed; `balanced`: with rows and columns of like sizes."""

    def __init__(
        self, matrix: csc_matrix, factoriser: Factoriser, balanced: bool = False, mass: csc_matrix = None
    ) -> None:
        self.matrix, self.factoriser, self.balanced, self.mass = matrix, factoriser, balanced, mass

    @cached_property
    def factor(self) -> Factor:
        return Balanced.of(self.matrix, self.factoriser) if self.balanced else self.factoriser.factor(self.matrix)

    @property
    def sign(self) -> float:
        return self.factor.sign

    def apply(self, x: Vector) -> Vector:
        return np.asarray(self.matrix @ x)

    def weigh(self, x: Vector) -> Vector:
        return x if self.mass is None else np.asarray(self.mass @ x)

    def magnitude(self, x: Vector) -> Vector:
        return np.asarray(abs(self.matrix) @ x)

    def solve(self, right: Vector, tolerance: float = 0.0) -> Vector:
        return self.factor.solve(right)

    def precondition(self, right: Vector) -> Vector:
        return self.factor.solve(right)

    def bordered(self, columns: Vector, rows: Vector, corner: Vector, coarse: bool = False) -> Solution:
        solution: Solution = bordered(self.factor, columns, rows, corner)  # type: ignore[assignment]
        return solution

    def shifted(self, shift: complex) -> DirectLinear:
        from scipy.sparse import identity

        value = shift if np.imag(shift) != 0.0 else float(np.real(shift))
        mass = identity(self.matrix.shape[0], format="csc") if self.mass is None else self.mass
        moved = (self.matrix - value * mass).tocsc()
        moved.sort_indices()
        return DirectLinear(moved, Factoriser(self.factoriser.tally), mass=self.mass)


class KrylovLinear:
    """An operator that is only applied; solved by GMRES with a preconditioner (an approximate inverse).

    `precise` are factors of a nearby matrix where there are some, with which borders are eliminated (BEMW): `near`
    where it is hardly another one, `fresh` where it is this one, `exact` where they are in double precision too, so
    that nothing is iterated. `matrix` is the operator's matrix, where it has one.
    """

    sign = 1.0

    def __init__(
        self,
        apply: Callable[[Vector], Vector],
        precondition: Callable[[Vector], Vector],
        precise: Solver | None = None,
        exact: bool = False,
        fresh: bool = False,
        near: bool = False,
        matrix: csc_matrix = None,
        shift: complex = 0.0,
        tally: Tally | None = None,
        mass: csc_matrix = None,
    ) -> None:
        self.tally, self.mass = tally, mass
        self._apply, self.approximate, self._shift = apply, precondition, shift
        self.precise, self.exact, self.fresh, self.matrix = precise, exact, fresh, matrix
        self.near = near or fresh
        # Borders and bordered factors by the number of borders, shared with later points.
        self.borders: dict[int, tuple[Vector, object]] = {}
        self.solved: dict[int, tuple[Vector, Vector]] = {}  # columns of borders, and what `approximate` made of them
        self.iterations = 0  # of the worst solve so far: when it grows, the preconditioner is out of date
        self.used = 0  # of all solves
        self.rate = 0.0  # by which an iteration reduces the residual in the worst solve that began at zero

    def apply(self, x: Vector) -> Vector:
        if np.iscomplexobj(x):
            value: Vector = self._apply(x.real) + 1j * self._apply(x.imag)
        else:
            value = self._apply(x)
        return value - self._shift * self.weigh(x) if self._shift else value

    def weigh(self, x: Vector) -> Vector:
        return x if self.mass is None else np.asarray(self.mass @ x)

    def magnitude(self, x: Vector) -> Vector:
        signs = np.where(np.arange(len(x)) % 2 == 0, 1.0, -1.0)  # neighbours in a discretised operator do not cancel
        return np.maximum(np.abs(self._apply(signs * x)), np.abs(self._apply(x)))

    def precondition(self, right: Vector) -> Vector:
        """About A^-1 right."""
        if np.iscomplexobj(right):
            return self.approximate(right.real) + 1j * self.approximate(right.imag)
        return self.approximate(right)

    def _finish(self, found: tuple[Vector, int, float], wanted: float = TOLERANCE, guessed: bool = False) -> Vector:
        x, used, residual = found
        if used >= TELLING and not guessed:
            self.rate = max(self.rate, elementary.pow(residual, 1.0 / used))
        self.iterations = max(self.iterations, used)
        self.used += used
        return x if residual <= max(ACCURATE, wanted) else np.full_like(x, np.nan)

    @property
    def attainable(self) -> float:
        """The residual of solutions from which others are computed: that of rounding, with factors from near."""
        return ROUNDED if self.near else TOLERANCE

    def solve(self, right: Vector, tolerance: float = 0.0) -> Vector:
        if self.exact and self.precise is not None:
            return self.precise.solve(right)
        x, used, residual = gmres(self.apply, self.precondition, right, tolerance or self.attainable)
        enough = max(ACCURATE, tolerance)
        if residual > enough and np.all(np.isfinite(x)) and right.any():  # A is nearly singular, and x large
            floor = EPSILON * norm(self.magnitude(np.abs(x))) / norm(right)
            residual = ACCURATE if residual <= SEVERAL * floor else residual
        return self._finish((x, used, residual), enough)

    def bordered(self, columns: Vector, rows: Vector, corner: Vector, coarse: bool = False) -> Solution:
        return KrylovBordered(self, columns, rows, corner, COARSE if coarse else self.attainable)

    def shifted(self, shift: complex) -> Linear:
        if self.matrix is not None:
            tally = Tally() if self.tally is None else self.tally
            return DirectLinear(self.matrix, Factoriser(tally), mass=self.mass).shifted(shift)
        return KrylovLinear(self._apply, self.approximate, shift=self._shift + shift, mass=self.mass)


class KrylovBordered:
    """GMRES on the whole bordered operator, which is regular where A is singular."""

    pivot = 1.0

    def __init__(self, linear: KrylovLinear, columns: Vector, rows: Vector, corner: Vector, tolerance: float) -> None:
        self.linear, self.columns, self.rows, self.corner = linear, columns, rows, corner
        self.tolerance = tolerance
        complex_ = any(np.iscomplexobj(a) for a in (columns, rows, corner)) or linear._shift != 0.0
        self.complex_ = complex_
        self.preconditioner = self._preconditioner()

    def _preconditioner(self) -> Any:
        """Block elimination with old factors (old borders of this shape included), or an approximate one."""
        linear, k = self.linear, self.columns.shape[1]
        if linear.precise is None or self.complex_:
            return self._approximate()
        key = np.concatenate([self.columns, self.rows, self.corner])
        known = linear.borders.get(k)
        if linear.exact or known is None or not _alike(known[0], key, len(self.columns)):
            known = linear.borders[k] = key, bordered(linear.precise, self.columns, self.rows, self.corner)
        return known[1]

    def _approximate(self) -> ApproximateBordered:
        """With what the approximate inverse made of the last columns, where these are nearly the same."""
        known, k = self.linear.solved, self.columns.shape[1]
        old = known.get(k)
        solved = old[1] if old is not None and not self.complex_ and _nearly(old[0], self.columns) else None
        inner = Approximate(self.linear.precondition)
        made = ApproximateBordered(inner, self.columns, self.rows, self.corner, solved)
        if solved is None and not self.complex_:
            known[k] = self.columns, made.columns
        return made

    def _apply(self, x: Vector) -> Vector:
        n = len(self.columns)
        state, rest = x[:n], x[n:]
        image = self.linear.apply(state)
        out = np.empty(len(x), np.result_type(image, x, self.columns))
        plus_combined(image, self.columns, rest, out)
        out[n:] = products(self.rows, state) + self.corner @ rest
        return out

    def solve(self, right: Vector, guess: Vector | None = None, accuracy: Accuracy | None = None) -> Vector:
        """See `gmres`."""
        if self.complex_ and not np.iscomplexobj(right):
            right = right.astype(complex)
        if self.linear.exact and not self.complex_:
            return np.asarray(self.preconditioner.solve(right))
        found = gmres(self._apply, self.preconditioner.solve, right, self.tolerance, guess, accuracy)
        return self.linear._finish(found, self.tolerance, guess is not None)

    def last_row(self) -> Vector | None:
        """See `Solution`: one solve with the transpose, by factors, or by a preconditioner where A is symmetric."""
        linear, n = self.linear, len(self.columns)
        if self.complex_ or linear.matrix is None:
            return None
        if linear.precise is not None:
            precondition = self.preconditioner.solve_transposed
        elif is_symmetric(linear.matrix):
            turned = ApproximateBordered(Approximate(linear.precondition), self.rows, self.columns, self.corner.T)
            precondition = turned.solve
        else:
            return None
        last = np.append(np.zeros(n + len(self.corner) - 1), 1.0)
        if linear.exact:
            return np.asarray(precondition(last))
        transposed = linear.matrix.T

        def apply(x: Vector) -> Vector:
            state, rest = x[:n], x[n:]
            lower = products(self.columns, state) + self.corner.T @ rest
            return np.concatenate([transposed @ state + combined(self.rows, rest), lower])

        return linear._finish(gmres(apply, precondition, last, self.tolerance), self.tolerance)


def _nearly(old: Vector, new: Vector) -> bool:
    """True where no column has changed by more than `SAME` of itself."""
    moved = new - old
    return bool(np.all(np.einsum("ij,ij->j", moved, moved) <= SAME * SAME * np.einsum("ij,ij->j", new, new)))


def _alike(old: Vector, new: Vector, n: int) -> bool:
    """True where old borders [columns; rows; corner] still precondition new ones."""
    parts = ((old[:n], new[:n]), (old[n : 2 * n], new[n : 2 * n]))
    for a, b in parts:
        inner = np.abs(np.einsum("ij,ij->j", a, b))
        sizes = np.einsum("ij,ij->j", a, a), np.einsum("ij,ij->j", b, b)
        if np.any(inner < ALIKE * np.maximum(*sizes)):
            return False
    return True
