"""The equations of a curve of special orbits: collocation and one bordered scalar, minimally augmented and sparse.

z = (u at the nodes, T, h_1 .. h_N, [theta], second parameter, first parameter). The boundary-value problem F = 0 of
`contin.problems.orbits.linear` is joined by g(z) = 0 from [B b; c^* 0] [v; g] = [0; 1], which says that

    LPC   B = F_(u, T)
    PD    B = the variational equation with v(1) = -v(0)
    NS    B = the variational equation with v(1) = exp(i theta) v(0): two real equations, theta unknown

is singular; dg = -w^* (dB) v (Griewank and Reddien 1984; Doedel, Govaerts and Kuznetsov 2003). Null vectors are no
unknowns, so a step costs little more than one of the family itself.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.problems.orbits.defining import Bordered
from contin.problems.orbits.layout import Profile
from contin.problems.orbits.linear import OrbitLinear
from contin.problems.orbits.problem import OrbitProblem


@dataclass(eq=False)
class _Memory:
    """Borders and the phase's reference, kept from the start of a chunk to the next one."""

    b: NDArray[Any]
    c: NDArray[Any]
    reference: Array
    scale: Array


@dataclass(frozen=True, eq=False)
class Vectors:
    """Null vectors of B and the scalar g at a point."""

    right: NDArray[Any]
    left: NDArray[Any]
    g: complex


@dataclass(frozen=True, eq=False)
class OrbitCurve:
    """Equations of one type; `orbits` is the problem of the orbits themselves with the first parameter free."""

    type: str
    orbits: OrbitProblem
    second: int
    _memory: dict[str, _Memory] = field(default_factory=dict)

    @property
    def first(self) -> int:
        return self.orbits.active

    @property
    def extra(self) -> int:
        """Scalar unknowns beside the orbit: theta."""
        return int(self.type == "NS")

    # -- layout -------------------------------------------------------------------------------------------------------

    def join(self, orbit: Array, q: float, theta: float = 0.0) -> Array:
        """z from an orbit's own vector (u, T, h, p)."""
        return np.concatenate([orbit[:-1], [theta] * self.extra, [q, orbit[-1]]])

    def orbit(self, z: Array) -> Array:
        """(u, T, h, p), also of a metric or tangent."""
        return np.append(z[: -2 - self.extra], z[-1])

    def theta(self, z: Array) -> float:
        return float(z[-3]) if self.extra else 0.0

    def at(self, z: Array) -> OrbitProblem:
        """The orbits' problem at the second parameter's value in z."""
        base = self.orbits.base.copy()
        base[self.second] = z[-2]
        return replace(self.orbits, base=base)

    def across(self, z: Array) -> OrbitProblem:
        """The same with the second parameter free."""
        base = self.orbits.base.copy()
        base[self.first] = z[-1]
        return replace(self.orbits, base=base, active=self.second)

    def profile(self, z: Array) -> Profile:
        return self.orbits.profile(self.orbit(z))

    # -- equations ----------------------------------------------------------------------------------------------------

    def settle(self, z: Array, scale: Array) -> None:
        """Borders and phase reference that fit at z."""
        orbit = self.orbit(z)
        linear = OrbitLinear(self.at(z), orbit, self.orbit(scale), orbit)
        bordered = Bordered.of(self._matrix(linear, self.theta(z)), 1)
        self._memory["now"] = _Memory(bordered.b, bordered.c, orbit, scale)

    def _held(self, z: Array, scale: Array) -> _Memory:
        known = self._memory.get("now")
        if known is None or not np.array_equal(self._mesh(known.reference), self._mesh(self.orbit(z))):
            self.settle(z, scale)
        return self._memory["now"]

    def _mesh(self, orbit: Array) -> Array:
        return self.orbits.profile(orbit).h

    def _matrix(self, linear: OrbitLinear, theta: float) -> Any:
        if self.type == "LPC":
            return linear.jacobian[:, :-1]
        return linear.variational(-1.0 if self.type == "PD" else complex(np.exp(1j * theta)))

    def linear(self, z: Array, scale: Array) -> tuple[OrbitLinear, OrbitLinear]:
        """The orbit's equations with the first, and with the second parameter free."""
        held = self._held(z, scale)
        first, second = self.orbit(z), self.orbit(z)
        second[-1] = z[-2]
        metric, other = self.orbit(scale), self.orbit(scale)
        other[-1] = scale[-2]
        return (
            OrbitLinear(self.at(z), first, metric, held.reference),
            OrbitLinear(self.across(z), second, other, held.reference),
        )

    def vectors(self, linear: OrbitLinear, z: Array, scale: Array) -> Vectors:
        held = self._held(z, scale)
        v, g, w = Bordered.with_borders(self._matrix(linear, self.theta(z)), held.b, held.c).solve()
        return Vectors(v[:, 0], w[:, 0], complex(g[0, 0]))

    def linearise(self, z: Array, scale: Array) -> tuple[Array, Any]:
        """Scaled equations (m,) and their sparse Jacobian (m, m + 1) by x = (u, T, [theta], second, first)."""
        from scipy import sparse

        first, second = self.linear(z, scale)
        null = self.vectors(first, z, scale)
        by_first, by_second = first.jacobian, second.jacobian[:, -1]
        gradient, slope = self._gradient(first, null), self._gradient(second, null)[-1]
        middle = [] if not self.extra else [sparse.csc_matrix((first.nu + 1, 1))]
        top = sparse.hstack([by_first[:, :-1], *middle, by_second, by_first[:, -1]])
        if self.type != "NS":
            row = np.concatenate([gradient[:-1], [slope], gradient[-1:]]).real[None, :]
            return np.append(first.residual, null.g.real), sparse.vstack([top, row], format="csc")
        rho = complex(np.exp(1j * self.theta(z)))
        turn = -(null.left.conj() @ first.variational_by_angle(rho, null.right)) * float(scale[-3])
        row = np.concatenate([gradient[:-1], [turn, slope], gradient[-1:]])
        equations = np.concatenate([first.residual, [null.g.real, null.g.imag]])
        return equations, sparse.vstack([top, np.array([row.real, row.imag])], format="csc")

    def _gradient(self, linear: OrbitLinear, null: Vectors) -> NDArray[Any]:
        """dg by (u, T, the free parameter)."""
        if self.type == "LPC":
            return np.asarray(-(null.left @ linear.hessian(np.append(null.right, 0.0))))
        return np.asarray(-(null.left.conj() @ linear.hessian(null.right, variational=True)))

    def fold_coefficient(self, z: Array) -> float:
        """w . F_xx v v / |..| of a fold of orbits, in the orientation of the borders: it vanishes at a CPC."""
        scale = self._memory["now"].scale
        linear, _ = self.linear(z, scale)
        null = self.vectors(linear, z, scale)
        second = linear.hessian(np.append(null.right, 0.0)) @ np.append(null.right, 0.0)
        return float(null.left @ second) / (float(np.linalg.norm(null.left)) * float(np.linalg.norm(null.right)) ** 2)
