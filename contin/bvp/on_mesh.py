"""The collocation equations on one mesh as a system F(x) = 0 with a sparse Jacobian; x = (u at the nodes, p).

Special points are verified in these unknowns with the bordered solves of large systems (`contin.problems.sparse`).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.bvp.pattern import assembled
from contin.kernels.collocation import LANES, evaluate, new_points, residual
from contin.kernels.collocation_basis import basis
from contin.linalg.factor import Factoriser
from contin.linalg.linear import DirectLinear
from contin.problems.orbits.mesh.layout import Profile, in_intervals
from contin.problems.sparse.large_linearisation import LargeLinearisation

if TYPE_CHECKING:
    from scipy.sparse import csc_matrix

    from contin.bvp.boundary_equations import BoundaryEquations

KEPT: Final = 3  # points whose equations are kept


@dataclass(frozen=True, eq=False)
class Evaluated:
    """F, F_u and F_p at one x."""

    x: Array
    residual: Array
    slope: Array
    matrix: Callable[[], DirectLinear]

    @cached_property
    def linear(self) -> DirectLinear:
        """F_u, put together when it is asked for."""
        return self.matrix()


@dataclass(eq=False)
class OnMesh:
    """The equations of `problem` on the mesh h (N,)."""

    problem: BoundaryEquations
    h: Array
    factoriser: Factoriser = field(default_factory=Factoriser)
    _known: tuple[Evaluated, ...] = ()  # the last ones: a point is asked for again after its neighbours

    @property
    def n(self) -> int:
        """Number of node values, and of equations."""
        return (len(self.h) * self.problem.points + 1) * self.problem.n

    @property
    def system(self) -> Any:
        return self.problem.system

    def full(self, x: Array) -> Array:
        """z with this mesh."""
        return np.concatenate([x[:-1], [1.0], self.h, x[-1:]])

    def unknowns(self, z: Array) -> Array:
        """x of a z on this mesh (also of scales and tangents)."""
        return np.append(z[: self.n], z[-1])

    def profile(self, x: Array) -> Profile:
        return Profile(self.problem.points, x[:-1].reshape(-1, self.problem.n), 1.0, self.h, float(x[-1]))

    def at(self, x: Array) -> Evaluated | None:
        """None where something is not finite."""
        for known in self._known:
            if np.array_equal(known.x, x):
                return known
        found = self._evaluate(x) if np.all(np.isfinite(x)) else None
        if found is not None:
            self._known = (found, *self._known[: KEPT - 1])
        return found

    def residual(self, x: Array) -> Array:
        """F (n,), unscaled, without derivatives where they are not known already; NaN where it is not finite."""
        for known in self._known:
            if np.array_equal(known.x, x):
                return known.residual
        problem, z = self.problem, self.full(x)
        w = self._points(z)
        if not (np.all(np.isfinite(x)) and evaluate(problem.equations, w, z, False)):
            return np.full(self.n, np.nan)
        return np.append(self._local(w, z), problem.conditions(self.profile(x), problem.full_parameters(z))[0])

    def linear(self, x: Array) -> DirectLinear | None:
        here = self.at(x)
        return None if here is None else here.linear

    def parameter_slope(self, x: Array) -> Array:
        here = self.at(x)
        return np.full(self.n, np.nan) if here is None else here.slope

    def linearisation(self, x: Array, tangent: Array, scale: Array) -> LargeLinearisation | None:
        here = self.at(x)
        if here is None:
            return None
        row = tangent / scale
        solution = here.linear.bordered(here.slope[:, None], row[:-1, None], row[-1:, None])
        sign = here.linear.sign * (1.0 if solution.pivot > 0.0 else -1.0)
        return LargeLinearisation(here.residual / scale[:-1], sign, scale, solution)

    def form(self, x: Array, *directions: NDArray[Any]) -> Array:
        """D^k F(x)[d1, .., dk], k >= 2 real directions (n + 1,)."""
        problem, scheme = self.problem, basis(self.problem.points)
        n, m, count = problem.n, problem.points, len(self.h)
        profile, width = self.profile(x), problem.system.n + problem.system.p_size

        def at_points(values: Array) -> Array:
            return in_intervals(scheme.values, values.reshape(-1, n)).reshape(-1, n)

        p = np.tile(problem.full_parameters(x), (count * m, 1))
        p[:, -1] = profile.gauss_times
        wide, ends = [], []
        for d in directions:
            v = np.zeros((count * m, width))
            v[:, :n] = at_points(np.real(d[:-1]))
            v[:, n + problem.active] = np.real(d[-1])
            wide.append(v)
            g = np.zeros(2 * n + len(problem.base))
            g[:n], g[n : 2 * n], g[2 * n + problem.active] = np.real(d[:n]), np.real(d[-1 - n : -1]), np.real(d[-1])
            ends.append(g)
        local = problem.system.derivatives(at_points(x[:-1]), p, *wide)
        local = -np.repeat(self.h, m)[:, None] * np.asarray(local)
        conditions = problem.two.conditions.derivative(profile.u[0], profile.u[-1], p[0, :-1], *ends)
        return np.concatenate([local.ravel(), conditions])

    def _points(self, z: Array) -> Any:
        """The kernels' memory for the Gauss points."""
        problem = self.problem
        return new_points(problem.n, problem.points, len(self.h), problem.full_parameters(z))  # type: ignore[no-untyped-call]

    def _local(self, w: Any, z: Array) -> Array:
        """The collocation equations, evaluated already: by interval, Gauss point, function."""
        n = self.problem.n
        right = np.zeros((self.problem.points * n, len(self.h)))
        residual(self.problem.equations, w, z, right, np.empty(n), np.zeros(2))
        return -right.T.ravel()

    def _evaluate(self, x: Array) -> Evaluated | None:
        problem = self.problem
        n = problem.n
        z = self.full(x)
        w = self._points(z)
        if not evaluate(problem.equations, w, z, True):
            return None
        g, dg = problem.conditions(self.profile(x), problem.full_parameters(z))
        if not (np.all(np.isfinite(g)) and np.all(np.isfinite(dg))):
            return None
        fu = np.asarray(w.fu if n > LANES else np.moveaxis(w.fu, -1, 0))  # (N, m, n, n)
        fp = np.moveaxis(w.fp, -1, 0)
        slope = np.concatenate([(-self.h[:, None, None] * fp).ravel(), dg[:, 2 * n + problem.active]])

        def linear() -> DirectLinear:
            return DirectLinear(self._matrix(fu, dg), self.factoriser, balanced=True)

        return Evaluated(x.copy(), np.append(self._local(w, z), g), slope, linear)

    def _matrix(self, fu: Array, dg: Array) -> csc_matrix:
        """F_u, (n, n) in CSC form: rows by interval, Gauss point, function; then the conditions."""
        n, scheme = self.problem.n, basis(self.problem.points)
        blocks = -np.einsum("i,cj,ickq->ickjq", self.h, scheme.values, fu)
        blocks += np.einsum("cj,kq->ckjq", scheme.slopes, np.eye(n))
        return assembled(blocks, dg[:, : 2 * n], np.empty((self.n, 0)), np.empty((0, self.n)))
