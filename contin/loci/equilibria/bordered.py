"""Curves of special points in two parameters by minimally augmented systems: no null vectors among the unknowns.

F(u, p) = 0 and one or two scalars g(u, p) from bordered solves, zero where a matrix M is singular:

    [M B; C^T 0] [V; G] = [0; I],  [M B; C^T 0]^T [W; .] = [0; I],  dG = -W^T (dM) V

with M = f_u - mu (LP: mu = 0, PD: -1, maps' LP: 1), f_u^2 + kappa (HB; maps' NS: f_u^2 - 2 kappa f_u + 1, kappa = cos
theta), and for BP the matrix [F_u F_s] with s a direction across the curve (Griewank and Reddien 1984; Beyn et al.
2002; Govaerts 2000). The unknowns do not grow with the vectors: for large n, for maps and for user functions.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, Self, cast

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.loci.equilibria.across import FIRST, first_across, usual_rate
from contin.loci.tolerances import FORCED
from contin.machine import elementary
from contin.problems.equilibria.defining import solve_bordered
from contin.problems.gauged import Gauged

if TYPE_CHECKING:
    from contin.systems.protocol import System


@dataclass(frozen=True, eq=False)
class Borders:
    """B (rows, k), C (columns, j), the direction across a curve of branch points, and the unfolding's direction."""

    left: Array
    right: Array
    across: Array
    beta: Array


@dataclass(frozen=True, eq=False)
class BorderedCurve(Gauged):
    """z = (u, [kappa or unfolding], further parameters, second parameter, first parameter).

    Without `more` parameters N - 1 equations; with each of them one equation fewer than makes a curve.
    """

    type: str
    system: System
    base: Array
    first: int
    second: int
    sizes: Array
    more: tuple[int, ...] = ()  # places of further parameters that vary, the last unknown first
    gauge: Borders | None = None

    compiled = False

    @property
    def n(self) -> int:
        return int(self.system.n)

    @property
    def has_scalar(self) -> bool:
        return self.type in ("HB", "NS", "BP")

    @property
    def size(self) -> int:
        return self.n + len(self.places) + self.has_scalar

    @property
    def places(self) -> tuple[int, ...]:
        """Of the varying parameters, in the order of the unknowns."""
        return (*self.more[::-1], self.second, self.first)

    @cached_property
    def identifying(self) -> NDArray[np.bool_]:
        return np.ones(self.size, bool)

    @cached_property
    def growing(self) -> NDArray[np.bool_]:
        mask = np.ones(self.size, bool)
        mask[-len(self.places) :] = False
        return mask

    @property
    def shift(self) -> float:
        """The critical eigenvalue of LP, BP, PD."""
        if self.type == "PD":
            return -1.0
        return 1.0 if self.system.kind == "map" else 0.0

    # -- reading z ----------------------------------------------------------------------------------------------------

    def full_parameters(self, z: Array) -> Array:
        p = self.base.copy()
        p[list(self.places)] = z[-len(self.places) :]
        return p

    def scalar(self, z: Array) -> float:
        return float(z[self._scalar])

    @property
    def _scalar(self) -> int:
        """Place of the scalar unknown, from the end."""
        return -1 - len(self.places)

    def matrix(self, z: Array) -> Array:
        return np.asarray(self.system.jacobian(z[: self.n], self.full_parameters(z))[1][:, : self.n])

    def vector(self, z: Array) -> Array:
        """The critical vector v in the states' units."""
        matrix = self._critical(self._scaled(self.matrix(z)), z)
        return np.asarray(np.linalg.svd(matrix)[2][-1] * self.sizes)

    def _scaled(self, matrix: Array) -> Array:
        return np.asarray(matrix * self.sizes / self.sizes[:, None])

    def _critical(self, a: Array, z: Array) -> Array:
        """M, without BP's further column."""
        identity = np.eye(self.n)
        if self.type == "HB":
            return np.asarray(a @ a + self.scalar(z) * identity)
        if self.type == "NS":
            return np.asarray(a @ a - 2.0 * self.scalar(z) * a + identity)
        return np.asarray(a - self.shift * identity)

    # -- the equations ------------------------------------------------------------------------------------------------

    def parameters(self, z: Array, gauge: Any = None) -> Borders:
        """Borders for work near z: those chosen, or some that fit at z."""
        known = self.gauge if gauge is None else cast(Borders, gauge)
        return self._borders(z) if known is None else known

    def settled(self, z: Array, scale: Array) -> Self:
        """The same curve with borders that fit at z and have the sense of those before."""
        return replace(self, gauge=self._borders(z))

    def turns_from(self, other: Self) -> bool:
        """No unknown depends on the borders."""
        return False

    def _borders(self, z: Array) -> Borders:
        """The singular vectors of M at z."""
        _, jacobian = self.system.jacobian(z[: self.n], self.full_parameters(z))
        a = self._scaled(jacobian[:, : self.n])
        across = np.array([1.0, 0.0])
        matrix = self._critical(a, z)
        if self.type == "BP":
            across = self._across(z)
            matrix = np.column_stack([matrix, self._slopes(jacobian) @ across])
        left, _, right = np.linalg.svd(matrix)
        corank = 2 if self.type in ("HB", "NS") else 1
        kernel = corank + matrix.shape[1] - matrix.shape[0]
        b, c = left[:, -corank:], right[-kernel:].T
        known = self.gauge
        if known is not None and corank == kernel == 1:  # tests, which are oriented by them, keep their signs
            b, c = (new if float(new[:, 0] @ old[:, 0]) >= 0.0 else -new
                    for new, old in ((b, known.left), (c, known.right)))  # fmt: skip
        return Borders(b, c, across, left[:, -1])

    def _slopes(self, jacobian: Array) -> Array:
        """F_p of both parameters, scaled rows (n, 2)."""
        columns = jacobian[:, [self.n + self.first, self.n + self.second]]
        return np.asarray(columns / self.sizes[:, None])

    def _across(self, z: Array) -> Array:
        """A direction of the parameters across the curve; the first parameter's, until the curve's own is known."""
        known, u, p = self.gauge, z[: self.n], self.full_parameters(z)
        if self.more:  # branch points in the first parameter
            return FIRST
        if known is None:
            return first_across(self.system, u, p, (self.first, self.second), self.sizes, self.shift)
        if abs(self.scalar(z)) > FORCED * usual_rate(self.system, u, p, self.sizes):
            return FIRST
        along = np.linalg.svd(self.linearise(z, known)[1])[2][-1]
        width = float(elementary.hypot(along[-1], along[-2]))
        return np.array([-along[-2], along[-1]]) / width if width > 0.0 else known.across

    def turned(self, z: Array) -> tuple[BorderedCurve, Array]:
        """This curve, whose unknowns hold no vector, and z (see `ExtendedCurve`)."""
        return self, z

    def turned_back(self, z: Array, like: Array) -> Array:
        """z itself."""
        return z

    def left_vector(self, z: Array) -> Array:
        """The left null vector to which others are oriented (BP)."""
        return np.asarray(self.parameters(z).beta / self.sizes)

    def reference(self, z: Array) -> Array:
        """The null vector to which others are oriented."""
        return np.asarray(self.parameters(z).right[: self.n, 0])

    def values(self, z: Array, borders: Borders) -> Array:
        """The equations at rows z, (rows, N - 1), unscaled."""
        return np.array([self.linearise(row, borders)[0] for row in z])

    def linearise(self, z: Array, borders: Borders | None = None) -> tuple[Array, Array]:
        """Equations (N - 1, less one a further parameter) and their Jacobian, unscaled; G as rates of states."""
        n, d = self.n, self.sizes
        borders = self.parameters(z) if borders is None else borders
        u, p = z[:n], self.full_parameters(z)
        f, full = self.system.jacobian(u, p)
        columns = [*range(n), *(n + place for place in self.places)]
        if self.system.kind == "map":
            f = f - u
        a = self._scaled(full[:, :n])
        matrix = self._critical(a, z)
        if self.type == "BP":
            matrix = np.column_stack([matrix, self._slopes(full) @ borders.across])
        v, w, g = _real_bordered(matrix, borders.left, borders.right)

        def hessian(direction: Array, parameter: float = 0.0) -> Array:
            """D^2F[direction, .] by states and parameters, rows scaled; the direction is given in scaled states."""
            wide = np.zeros(n + len(p))
            wide[:n] = direction * d
            wide[n + self.first], wide[n + self.second] = parameter * borders.across
            return np.asarray(self.system.gradient(u, p, wide)[:, columns] / d[:, None])

        extra = int(self.has_scalar)
        jacobian = np.zeros((n + 1 + extra, self.size))
        where = [*range(n), *range(-len(self.places), 0)]
        jacobian[:n, where] = full[:, columns]
        if self.system.kind == "map":
            jacobian[:n, :n] -= np.eye(n)
        if self.type in ("LP", "PD"):
            jacobian[n, where] = -(w[:, 0] @ hessian(v[:, 0]))
            return np.append(f, g[0, 0]), jacobian
        if self.type == "BP":
            f = f + self.scalar(z) * borders.beta * d
            jacobian[:n, self._scalar] = borders.beta * d
            for k in range(2):
                jacobian[n + k, where] = -(w[:, 0] @ hessian(v[:n, k], v[n, k]))
            return np.append(f, g[0]), jacobian
        critical, kappa = v[:, 0], self.scalar(z)
        change = hessian(a @ critical) + a @ hessian(critical)
        slope = critical
        if self.type == "NS":
            change = change - 2.0 * kappa * hessian(critical)
            slope = -2.0 * (a @ critical)
        jacobian[n:, where] = -(w.T @ change)
        jacobian[n:, self._scalar] = -(w.T @ slope)
        return np.append(f, g[:, 0]), jacobian

    def form(self, z: Array, jacobian: Array) -> Array:
        """(2, 2): second derivatives of BP's scalar equation in the plane of the null vectors V, which are dG V."""
        n, d, borders = self.n, self.sizes, self.parameters(z)
        slopes = jacobian[:n, [-1, -2]] / d[:, None] @ borders.across
        v = _real_bordered(np.column_stack([self._scaled(jacobian[:n, :n]), slopes]), borders.left, borders.right)[0]
        directions = np.zeros((self.size, 2))
        directions[:n], directions[[-1, -2]] = v[:n] * d[:, None], np.outer(borders.across, v[n])
        return np.asarray(jacobian[n:] @ directions)

    # -- setting out --------------------------------------------------------------------------------------------------

    def place(self, u: Array, p: Array, scalar: float = 0.0) -> Array:
        return np.concatenate([u, [scalar] if self.has_scalar else [], p[list(self.places)]])

    def scales(self, z: Array, widths: Sequence[float]) -> Array:
        """widths: of the parameters, the last unknown first."""
        ends = widths[::-1]
        if not self.has_scalar:
            return np.concatenate([self.sizes, ends])
        typical = 1.0
        if self.type == "HB":
            largest = float(np.abs(self._scaled(self.matrix(z))).max())
            typical = max(abs(self.scalar(z)), 1e-2 * elementary.square(largest))
        return np.concatenate([self.sizes, [typical], ends])


def _real_bordered(matrix: Array, b: Array, c: Array) -> tuple[Array, Array, Array]:
    """V, W, G of the bordered systems above; NaN where they are singular."""
    v, w, g = solve_bordered(matrix, b, c)
    return np.asarray(v.real), np.asarray(w.real), np.asarray(g.real)
