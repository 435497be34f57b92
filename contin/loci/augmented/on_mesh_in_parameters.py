"""The collocation equations on one mesh as F(u, parameters) = 0, with as many varying parameters as a curve has."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from contin.abi import Array
from contin.bvp.boundary_problem import BoundaryProblem
from contin.bvp.on_mesh import OnMesh
from contin.linalg.csc import scaled_columns, with_columns

if TYPE_CHECKING:
    from scipy.sparse import csc_matrix


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

    def at(self, y: Array) -> tuple[Array, csc_matrix] | None:
        values = y * self.scale
        parameters = values[self._nodes :]
        p = self.problem.base.copy()
        p[list(self.places)] = parameters[::-1]
        slopes, mesh, x = [], None, values[: self._nodes]
        for place, value in zip(self.places[::-1], parameters, strict=True):
            mesh = OnMesh(replace(self.problem, base=p, active=place, spaces={}), self.h)
            x = np.append(values[: self._nodes], value)
            slopes.append(mesh.parameter_slope(x))
        here = None if mesh is None else mesh.at(x)
        if here is None or not np.all(np.isfinite(slopes)):
            return None
        return here.residual, scaled_columns(with_columns(here.linear.matrix, np.array(slopes).T), self.scale)
