"""The linearised two-point problem by local condensation of the mesh intervals, then elimination along the chain.

The kernels are those of periodic orbits up to the last block, which relates (u(0), u(1), T, p); the conditions' rows
and the border take the place of periodicity. T = 1 has a row of its own. Layout of z: (u at the nodes, T, mesh, p).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Array
from contin.bvp.workspace import Workspace
from contin.kernels.collocation import LANES, evaluate, residual
from contin.kernels.collocation_basis import basis
from contin.kernels.collocation_system import clear_right, expand, reduce_right
from contin.kernels.condensation import condense
from contin.kernels.dense import lu_factor, lu_solve
from contin.kernels.filling import fill
from contin.kernels.stages import weigh
from contin.linalg.vectors import norm
from contin.machine import elementary

if TYPE_CHECKING:
    from contin.bvp.boundary_equations import BoundaryEquations

ROUNDING: Final = 64.0 * float(np.finfo(float).eps)  # of a sum over the nodes


@dataclass(frozen=True, eq=False)
class Condensed:
    """Scaled residual and M = [J; t^T] at a point, factorised (see `contin.continuation.corrector.Linearisation`)."""

    residual: Array  # (size - 1,) collocation rows by interval, conditions, T - 1, and zeros for the mesh
    sign: float
    scale: Array
    n: int
    m: int
    intervals: int
    work: Workspace
    condition_sizes: Array  # (n,) where all unknowns have their sizes
    by_ends: Array  # (n, 2 n + 1) moduli of the conditions' derivatives by u(0), u(1) and p

    @property
    def log_determinant(self) -> float:
        """In place of log |det M|, which swings by many powers of ten: -log of |M^-1 r|, r two jumps of the conditions.

        The test for branch points becomes the determinant's sign times about the smallest singular value of M. (One
        jump alone may be all but normal to the left null vector.)
        """
        rows, lengths = self.intervals * self.m * self.n, []
        for jump in (elementary.cos, elementary.sin):
            right = np.zeros(self.scale.size)
            right[rows : rows + self.n] = jump(1.0 + np.arange(self.n)) * self.condition_sizes
            lengths.append(norm(self.solve(right)))
        length = norm(np.array(lengths))
        return -elementary.log(length) if 0.0 < length < np.inf else 0.0

    def solve(self, right: Array) -> Array:
        """M x = right, (size,), in scaled unknowns."""
        n, m, count, s = self.n, self.m, self.intervals, self.work.factors
        rows = count * m * n
        local = right[:rows]
        if local.any():
            s.right_local[:] = local.reshape(count, m * n).T
            reduce_right(s, n, m)
        else:
            clear_right(s, n, m)
        last = np.concatenate([s.right_last[:n], right[rows : rows + n], s.right_last[n:]])
        last[2 * n] += right[rows + n]
        last[2 * n + 1] += right[-1]
        lu_solve(self.work.last, self.work.pivots, last)
        s.points[:, 0], s.points[:, count] = last[:n], last[n : 2 * n]
        out = np.empty((count * m + 1) * n + 2)
        expand(s, n, m, last[2 * n], last[2 * n + 1], out)
        x = np.zeros(self.scale.size)
        x[: out.size - 1] = out[:-1]
        x[-1] = out[-1]
        return x / self.scale


def met_to_rounding(here: Condensed, residual: Array, z: Array) -> bool:
    """Whether a residual at z is rounding of its own terms: corrections are then noise, however nearly singular F_u.

    here : linearised at z or next to it, with the matrices of the terms.  (A pulse on a long interval moves by
    exp(-length) for conditions at its ends: its place is known to no more.)
    """
    n, m, count, w = here.n, here.m, here.intervals, here.work.points
    scheme, nodes = basis(m), np.arange(m + 1)[:, None] + m * np.arange(count)
    u = np.abs(z[: (count * m + 1) * n]).reshape(-1, n)
    local = u.take(nodes, axis=0).transpose(0, 2, 1)  # (m + 1, n, N)
    own, inside = (np.einsum("cj,jki->cki", np.abs(of), local) for of in (scheme.slopes, scheme.values))
    own += w.h * (np.einsum("ickq,cqi->cki" if n > LANES else "ckqi,cqi->cki", np.abs(w.fu), inside))
    own += w.h * np.abs(w.fp * z[-1])
    ends = here.by_ends @ np.concatenate([u[0], u[-1], np.abs(z[-1:])])
    terms = np.append(own.transpose(2, 0, 1).ravel(), ends)
    return bool(np.all(np.abs(residual[: terms.size]) <= ROUNDING * terms))


def residual_at(problem: BoundaryEquations, z: Array) -> Array | None:
    """The residual alone, as `Condensed` has it; factors that were made before stay good. None where not finite."""
    profile = problem.profile(z)
    n, m, count = profile.n, profile.m, profile.intervals
    p = problem.full_parameters(z)
    points = problem.workspace(count, p).points
    if not evaluate(problem.equations, points, z, False):
        return None
    local, border = np.empty((m * n, count)), np.zeros(2)
    residual(problem.equations, points, z, local, np.empty(n), border)
    value, _ = problem.conditions(profile, p)
    return np.concatenate([-local.T.reshape(-1), value, [-border[0]], np.zeros(count)])


def linearise(problem: BoundaryEquations, z: Array, tangent: Array, scale: Array) -> Condensed | None:
    """None where the equations are not finite; its `sign` is 0 where M is singular."""
    profile = problem.profile(z)
    n, m, count = profile.n, profile.m, profile.intervals
    p = problem.full_parameters(z)
    work = problem.workspace(count, p)
    w, s = work.points, work.factors
    equations = problem.equations
    if not evaluate(equations, w, z, True):
        return None
    jump, border, corner = np.empty(n), np.zeros(2), np.zeros((2, 2))
    residual(equations, w, z, s.right_local, jump, border)
    local = -s.right_local.T.reshape(-1)
    value, matrix = problem.conditions(profile, p)
    if not (np.all(np.isfinite(value)) and np.all(np.isfinite(matrix))):
        return None
    here = np.concatenate([local, value, [-border[0]], np.zeros(count)])
    weigh(s.stages.weights, n, problem.sizes(z, scale))
    sign = fill(equations, w, z, tangent, scale, s, corner)
    sign = sign * condense(s, n, m) if sign != 0 else 0
    a = work.last
    a[:] = 0.0
    a[:n] = s.end[:n]
    a[n : 2 * n, : 2 * n] = matrix[:, : 2 * n]
    a[n : 2 * n, -1] = matrix[:, 2 * n + problem.active]
    a[2 * n :] = s.end[n:]
    a[2 * n :, 2 * n :] += corner
    if sign != 0:
        sign *= lu_factor(a, work.pivots)
        sign *= int(np.prod(np.sign(np.diag(a))))
    nodes = (count * m + 1) * n
    unknowns = np.concatenate([scale[:n], scale[nodes - n : nodes], scale[-1:]])
    by_ends = np.abs(matrix[:, [*range(2 * n), 2 * n + problem.active]])
    own = by_ends @ unknowns
    return Condensed(here, float(sign), scale, n, m, count, work, np.where(own > 0.0, own, 1.0), by_ends)
