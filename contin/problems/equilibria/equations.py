"""The equations of equilibria of flows and fixed points of maps, with derivatives in the states and one parameter."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from contin.abi import Array, Vector
from contin.problems.one_parameter import InOneParameterProblem
from contin.problems.surfaces.sliding import Sliding
from contin.systems.functions.function_system import FunctionSystem
from contin.systems.protocol import is_timeless


@dataclass(frozen=True, eq=False)
class AlgebraicEquations(InOneParameterProblem):
    """F(u, p) = f(u, p) = 0 (flow) or f(u, p) - u = 0 (map), one parameter free."""

    angle_periods: Array = field(default_factory=lambda: np.zeros(0))
    sliding: Sliding | None = None  # of pseudo-equilibria: the surface that they lie on

    def __post_init__(self) -> None:
        if self.angle_periods.size == 0:
            object.__setattr__(self, "angle_periods", np.zeros(self.system.n))

    @cached_property
    def is_map(self) -> bool:
        return bool(self.system.kind == "map")

    @cached_property
    def is_timeless(self) -> bool:
        return is_timeless(self.system)

    def linearise(self, z: Array) -> tuple[Array, Array]:
        """F (n,) and [F_u F_p] (n, n + 1), unscaled."""
        f, jacobian = self.system.jacobian(z[:-1], self.full_parameters(z))
        matrix = self._active_columns(jacobian)
        if self.is_map:
            f = f - z[:-1]
            matrix[:, : self.n] -= np.eye(self.n)
        return f, matrix

    def linearised(self, z: Array) -> tuple[Array, Array]:
        """`linearise` at rows z (m, n + 1): (m, n) and (m, n, n + 1)."""
        n = self.n
        f, jacobians = self.system.jacobians(z[:, :n], self.rows_of_parameters(z))
        matrices = np.concatenate([jacobians[:, :, :n], jacobians[:, :, n + self.active, None]], axis=2)
        if self.is_map:
            f = f - z[:, :n]
            matrices[:, :, :n] -= np.eye(n)
        return f, matrices

    def form(self, z: Array, *directions: Vector) -> Vector:
        """D^kf(z)[d1, .., dk] of the model's equations; for k >= 2 the same as of F.

        directions : (n + 1,) = (state, active parameter), real or complex.
        """
        n, width = self.n, self.n + len(self.base)
        wide = []
        for d in directions:
            v = np.zeros(width, d.dtype)
            v[:n] = d[:n]
            v[n + self.active] = d[n]
            wide.append(v)
        return np.asarray(self.system.derivative(z[:n], self.full_parameters(z), *wide))

    def hessian(self, z: Array, v: Vector) -> Vector:
        """The matrix D^2F(z)[v, .], (n, n + 1), for a direction v (n + 1,) = (state, active parameter)."""
        wide = np.zeros(self.n + len(self.base), v.dtype)
        wide[: self.n] = v[: self.n]
        wide[self.n + self.active] = v[self.n]
        matrix = self.system.gradient(z[: self.n], self.full_parameters(z), wide)
        return self._active_columns(matrix)

    def _active_columns(self, matrix: Vector) -> Vector:
        """Derivatives in the states and the active parameter, of those in the states and all parameters."""
        chosen = np.empty((self.n, self.n + 1), matrix.dtype)
        chosen[:, : self.n] = matrix[:, : self.n]
        chosen[:, self.n] = matrix[:, self.n + self.active]
        return chosen

    def linear_part(self, z: Array) -> Array:
        """The matrix whose eigenvalues decide stability: f_u."""
        if isinstance(self.system, FunctionSystem):  # differences by the parameters would cost the user's time
            with np.errstate(all="ignore"):
                return self.system.state_jacobian(np.array(z[:-1]), self.full_parameters(z))
        _, matrix = self.linearise(z)
        return matrix[:, : self.n] + (np.eye(self.n) if self.is_map else 0.0)

    def linear_parts(self, z: Array) -> Array:
        """`linear_part` at rows z (m, n + 1): (m, n, n)."""
        if isinstance(self.system, FunctionSystem):
            return np.array([self.linear_part(row) for row in z])
        _, matrices = self.linearised(z)
        return matrices[:, :, : self.n] + (np.eye(self.n) if self.is_map else 0.0)
