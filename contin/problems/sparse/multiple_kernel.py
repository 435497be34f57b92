"""Branch points of large systems whose kernel has dimension k > 1, from bordered solves alone.

As in `contin.problems.sparse.reduced_equation`, with k columns: near z0 the solutions of F(z) = 0 are the zeros of
mu(a) in R^k, a in R^(k + 1): F(z) + B mu = 0, C^T (z - z0) = a. At the point mu and all its first derivatives vanish:
more equations than unknowns, which agree where all k eigenvalues vanish at one place. Gauss and Newton's method finds
it; what is left over says whether there is such a place. The branches are those of the reduced equation D^2 mu, D^3
mu.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Final, Self

import numpy as np

from contin.abi import Array, Vector
from contin.errors import NotFiniteError
from contin.linalg.bordered import Solver
from contin.linalg.linear import Linear
from contin.linalg.newton import Rules, newton
from contin.linalg.vectors import norm
from contin.normalforms.jet import DerivativeJet
from contin.normalforms.multiple import multiple_directions, require_countable
from contin.normalforms.reduction import Reduction
from contin.problems.sparse.forms import rounding_errors
from contin.problems.sparse.reduced_equation import border_rows

if TYPE_CHECKING:
    from contin.problems.sparse.equations import SparseEquations

ONTO: Final = Rules(stalled=1e-6)  # onto the curve, (scaled) until rounding decides
TOGETHER: Final = Rules(stalled=1e-7, far=1.0, growth=2.0)  # to the point, in the coordinates a
CONSISTENT: Final = 1e-6  # what may be left of mu and its slopes, beside the second derivatives


class Assembled:
    """A sparse matrix with its borders as one, factored: regular where the matrix has a kernel of any dimension."""

    def __init__(self, matrix: object, columns: Vector, rows: Vector, corner: Vector) -> None:
        from scipy.sparse import bmat, csc_matrix
        from scipy.sparse.linalg import splu

        whole = bmat([[matrix, csc_matrix(columns)], [csc_matrix(rows.T), csc_matrix(corner)]], format="csc")
        self._factors = splu(whole)

    def solve(self, right: Vector) -> Vector:
        return np.asarray(self._factors.solve(right))

    def solve_transposed(self, right: Vector) -> Vector:
        return np.asarray(self._factors.solve(right, "T"))


@dataclass(frozen=True, eq=False)
class Kernel:
    """The reduction around `origin` (raw unknowns (n + 1,)) with border rows C (n + 1, k + 1) and columns B (n, k).

    scale : (n + 1,), in whose units z is measured and the rows C have length 1.
    """

    problem: SparseEquations
    origin: Array
    rows: Array
    columns: Array
    scale: Array

    @classmethod
    def of(cls, problem: SparseEquations, z: Array, vectors: Array, tangent: Array, scale: Array) -> Self:
        """vectors : (n, k) of the kernel, raw.  tangent : (n + 1,) of the branch, scaled."""
        k = vectors.shape[1]
        nulls = np.linalg.qr(np.vstack([vectors / scale[:-1, None], np.zeros((1, k))]))[0]
        linear, columns = problem.linear(z), nulls[:-1] * scale[:-1, None]
        columns = columns if linear is None else linear.weigh(columns)
        return cls(problem, z, border_rows(nulls, tangent, scale), columns, scale)

    @property
    def k(self) -> int:
        return int(self.columns.shape[1])

    def solver(self, z: Array) -> Solver:
        """K = [F_u B F_p; C^T] at z, its unknowns in the order (state, mu, parameter)."""
        linear = self.problem.linear(z) if np.all(np.isfinite(z)) else None
        if linear is None:
            raise NotFiniteError("the Jacobian is not finite near this point")
        columns = np.column_stack([self.columns, self.problem.parameter_slope(z)])
        corner = np.column_stack([np.zeros((self.k + 1, self.k)), self.rows[-1]])
        return self.bordered(linear, columns, self.rows[:-1], corner)

    @staticmethod
    def bordered(linear: Linear, columns: Vector, rows: Vector, corner: Vector) -> Solver:
        """[A B; C^T D], regular where A has a kernel of any dimension."""
        if linear.matrix is not None:
            return Assembled(linear.matrix, columns, rows, corner)
        return linear.bordered(columns, rows, corner)  # type: ignore[return-value]

    def solve(self, solver: Solver, f: Array, g: Array) -> tuple[Array, Array]:
        """(z part (n + 1,), mu part (k,)) of K^-1 (f, g)."""
        x = np.real(solver.solve(np.concatenate([f, g])))
        n = len(self.origin) - 1
        return np.append(x[:n], x[-1]), x[n:-1]

    def onto(self, z: Array, mu: Array, a: Array) -> tuple[Array, Array] | None:
        """The point with C^T (z - origin) = a and F + B mu = 0, by Newton from (z, mu); None where that fails."""

        def correct(at: tuple[Array, Array]) -> tuple[float, tuple[Array, Array]]:
            z, mu = at
            f = self.problem.residual(z) + self.columns @ mu
            dz, dmu = self.solve(self.solver(z), -f, a - self.rows.T @ (z - self.origin))
            return norm(dz / self.scale), (z + dz, mu + dmu)

        found = newton(correct, (z, mu), ONTO)
        return None if found is None else found.at

    def slopes(self, z: Array) -> tuple[Solver, Array, Array]:
        """The solver at z, z_i as rows (k + 1, n + 1), and mu_i as columns (k, k + 1)."""
        solver = self.solver(z)
        zero = np.zeros(len(z) - 1)
        pairs = [self.solve(solver, zero, e) for e in np.eye(self.k + 1)]
        return solver, np.array([v for v, _ in pairs]), np.column_stack([m for _, m in pairs])

    def curvatures(self, z: Array, solver: Solver, along: Array) -> tuple[Array, Array]:
        """mu_ij (k, k + 1, k + 1) and z_ij (k + 1, k + 1, n + 1)."""
        size = self.k + 1
        mu, bent = np.empty((self.k, size, size)), np.empty((size, size, len(z)))
        for i in range(size):
            for j in range(i + 1):
                dz, dmu = self.solve(solver, -self.problem.form(z, along[i], along[j]), np.zeros(size))
                mu[:, i, j] = mu[:, j, i] = dmu
                bent[i, j] = bent[j, i] = dz
        return mu, bent

    def point(self, far: float = TOGETHER.far) -> tuple[Array, float] | None:
        """The branch point and what is left of its equations, beside the second derivatives; None without one.

        far : (scaled) a correction this long leads elsewhere; where the equations do not agree, all corrections are.
        """
        here, left = (self.origin, np.zeros(self.k)), np.inf

        def correct(a: Array) -> tuple[float, Array] | None:
            nonlocal here, left
            moved = self.onto(*here, a)
            if moved is None:
                return None
            here = moved
            z, mu = here
            solver, along, slopes = self.slopes(z)
            second, _ = self.curvatures(z, solver, along)
            size = float(np.abs(second).max())
            if not (np.isfinite(size) and size > 0.0):
                return None
            wrong = np.concatenate([mu, slopes.ravel()])
            left = float(np.abs(wrong).max()) / size
            step = np.linalg.lstsq(np.vstack([slopes, second.reshape(-1, self.k + 1)]), -wrong)[0]
            return norm(step), a + step

        found = newton(correct, np.zeros(self.k + 1), replace(TOGETHER, far=far))
        return None if found is None or not left < CONSISTENT else (here[0], left)

    def rounding(self, z: Array) -> float:
        """How much the parameter of the branch point z moves when entries of [F_u F_p] are rounded.

        Their errors E change the slopes mu_i by what the borders see of E z_i. They are the same ones from everywhere:
        no scatter of the iteration shows them.
        """
        linear = self.problem.linear(z)
        if linear is None:
            return np.inf
        solver, along, _ = self.slopes(z)
        second = self.curvatures(z, solver, along)[0].reshape(-1, self.k + 1)
        slope, none = np.abs(self.problem.parameter_slope(z)), np.zeros(self.k + 1)
        generator, worst = np.random.default_rng(10), 0.0
        errors = [
            rounding_errors(linear.magnitude(np.abs(v[:-1])) + abs(v[-1]) * slope, v[:-1], generator) for v in along
        ]
        for noise in zip(*errors, strict=True):
            moved = np.column_stack([self.solve(solver, e, none)[1] for e in noise])  # of mu_i, (k, k + 1)
            step = np.linalg.lstsq(second, moved.ravel())[0]
            worst = max(worst, abs(float(step @ along[:, -1])))
        return worst


@dataclass(frozen=True, eq=False)
class ReducedJet:
    """mu up to third order at a branch point, as a jet in (x, s): what normal forms of small systems take."""

    kernel: Kernel
    z: Array

    @cached_property
    def _at(self) -> tuple[Solver, Array, Array, Array]:
        solver, along, _ = self.kernel.slopes(self.z)
        mu, bent = self.kernel.curvatures(self.z, solver, along)
        return solver, along, mu, bent

    def form(self, directions: tuple[Array, ...]) -> Array:
        """-D^j mu[d1, ..., dj], (k,), d in R^(k + 1): the sign is that of F."""
        solver, along, mu, bent = self._at
        if len(directions) == 1:
            return np.zeros(self.kernel.k)
        if len(directions) == 2:
            return np.asarray(-np.einsum("kij,i,j->k", mu, *directions))
        a, b, c = directions
        lifted = [d @ along for d in directions]
        form = self.kernel.problem.form
        total = form(self.z, *lifted)
        for one, (d, e) in zip(lifted, ((b, c), (a, c), (a, b)), strict=True):
            total = total + form(self.z, one, np.einsum("i,j,ijn->n", d, e, bent))
        _, mu_abc = self.kernel.solve(solver, -total, np.zeros(self.kernel.k + 1))
        return np.asarray(-mu_abc)

    @cached_property
    def reduction(self) -> Reduction:
        """As `contin.normalforms.reduction` makes it of a small system, in coordinates in which the kernel is all."""
        k, unit = self.kernel.k, np.eye(self.kernel.k + 1)
        jet = DerivativeJet(np.zeros((k, k)), self.form, 1, "flow", np.ones(k))
        size = range(k + 1)
        second = np.array([[jet.form(unit[i], unit[j]) for j in size] for i in size])
        third = np.array([[[jet.form(unit[i], unit[j], unit[m]) for m in size] for j in size] for i in size])
        return Reduction(
            jet, np.eye(k), np.eye(k), np.zeros(k), np.zeros(k), unit, np.moveaxis(second, -1, 0),
            np.zeros((k + 1, k + 1, k)), np.moveaxis(third, -1, 0),
        )  # fmt: skip

    def branches(self) -> list[tuple[Array, Array]]:
        """z' and z'' (raw) of all branches through the point.  Raises LargeKernelError."""
        require_countable(self.kernel.k)
        _, along, _, bent = self._at
        found = []
        for d in multiple_directions(self.reduction):
            t = d.tangent
            found.append((t @ along, 2.0 * d.curvature @ along + np.einsum("i,j,ijn->n", t, t, bent)))
        return found
