"""The collocation equations on one mesh as F(u, parameters) = 0, with as many varying parameters as a curve has."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from contin.abi import Array
from contin.bvp.boundary_problem import BoundaryProblem
from contin.bvp.collocated import Collocated
from contin.kernels.collocation_basis import basis
from contin.problems.orbits.mesh.layout import Profile


@dataclass(frozen=True, eq=False)
class OnMeshInParameters:
    """F and [F_x, F_p] in scaled unknowns y = (u, parameters) / scale; rows divided by nothing.

    places : of the parameters among those of `problem`, the last unknown first.
    """

    problem: BoundaryProblem
    places: tuple[int, ...]
    h: Array
    scale: Array

    @cached_property
    def _nodes(self) -> int:
        return len(self.scale) - len(self.places)

    def at(self, y: Array) -> Collocated | None:
        """None where something is not finite."""
        problem, values = self.problem, y * self.scale
        n, m, count = problem.n, problem.points, len(self.h)
        order = list(self.places[::-1])
        known = problem.base.copy()
        known[order] = values[self._nodes :]
        profile = Profile(m, values[: self._nodes].reshape(-1, n), 1.0, self.h, 0.0)
        nodes = profile.u[np.arange(count)[:, None] * m + np.arange(m + 1)]
        p = np.tile(np.append(known, 0.0), (count * m, 1))
        p[:, -1] = profile.gauss_times
        inside = np.einsum("cj,ijk->ick", basis(m).values, nodes).reshape(-1, n)
        f, slopes = problem.system.jacobians(inside, p)
        g, dg = problem.two.conditions.jacobian(profile.u[0], profile.u[-1], known)
        f, slopes = f.reshape(count, m, n), slopes.reshape(count, m, n, -1)
        fu, fq = slopes[..., :n], slopes[..., [n + place for place in order]]
        ends, ends_q = dg[:, : 2 * n], dg[:, [2 * n + place for place in order]]
        if not all(np.all(np.isfinite(part)) for part in (f, fu, fq, g, ends, ends_q)):
            return None
        local = np.einsum("cj,ijk->ick", basis(m).slopes, nodes) - self.h[:, None, None] * f
        return Collocated(np.append(local.ravel(), g), self.h, fu, fq, ends, ends_q, self.scale)
