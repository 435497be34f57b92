"""How the linearised equations of a large orbit change with the orbit, along any direction.

    D(T h (A x [J d + f_p q])) x = h (A x [T (d/ds J(u + s d, p + s q) x_u + d/ds f_p(..) x_p) + x_T (J d + f_p q)])

d/ds is a central difference along (d, q), made once for a point: D^2 f is symmetric, so it serves every direction x,
and each one more costs products only, neither Jacobians nor factors.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Array, Vector
from contin.problems.large_orbits.points import Apply
from contin.problems.large_orbits.radau import A

if TYPE_CHECKING:
    from contin.loci.augmented.large_orbits import LargeOrbitBase
    from contin.problems.large_orbits.large_orbit import LargeOrbitProblem
    from contin.problems.large_orbits.linearised import Solvers

STEP: Final = 1e-4  # of the difference: the largest change of a state, in the orbit's size (or of the parameter)
Sides = tuple[Sequence[Apply], Sequence[Apply]]  # products with J at all points, ahead and behind


@dataclass(frozen=True, eq=False)
class ChangeOfImage:
    """Of d (N, 3, n), real or complex, and q, a change of the active parameter, at z of the curve; scale is its metric.

    `solvers` are those of that point.
    """

    base: LargeOrbitBase
    z: Array
    scale: Array
    solvers: Solvers
    d: Vector
    q: float = 0.0

    @cached_property
    def family(self) -> LargeOrbitProblem:
        return self.base.at(self.z)

    @cached_property
    def _parts(self) -> list[tuple[complex, Part]]:
        """Real directions and their weights."""
        if np.iscomplexobj(self.d):
            return [(1.0, self._part(self.d.real, self.q)), (1.0j, self._part(self.d.imag, 0.0))]
        return [(1.0, self._part(self.d, self.q))]

    def _part(self, d: Array, q: float) -> Part:
        sizes = self.family.orbit_sizes(self.base.inner(self.z), self.base.inner(self.scale))
        reach = max(float(np.max(np.abs(d) / sizes)), abs(q) / float(self.scale[-1]))
        return Part(self, d, q, STEP / reach if reach > 0.0 else 0.0)

    @cached_property
    def plain(self) -> Vector:
        """J d + f_p q"""
        moved = self.solvers.product(self.d)
        if self.q == 0.0:
            return moved
        U, p = self.states, self.family.full_parameters(self.base.inner(self.z))
        return np.asarray(moved + self.q * self._slopes(U, p, self.family.active))

    @cached_property
    def states(self) -> Array:
        return self.family.profile(self.base.inner(self.z)).U

    def _slopes(self, U: Array, p: Array, place: int) -> Array:
        found = self.family.points.parameter_slopes(U.reshape(-1, U.shape[2]), p, place)
        return np.asarray(found.reshape(U.shape))

    def stages(self, x: Array) -> Array:
        """The change (N, 3, n) of all points by a change x of z."""
        family, inner = self.family, self.base.inner(self.z)

        def by_scalars() -> Array:
            places = (self.base.second, family.active)
            return np.asarray(np.einsum("k,kjin->jin", x[-3:], family.by_scalars(inner, places)))

        return family.layout.carried(self.solvers.sweeps, x[:-3], by_scalars)

    def along(self, x: Array, stages: Array) -> Vector | None:
        """The change (N, 3, n) by x, unscaled; None where an equation is not finite."""
        inner = x[-3] * self.plain
        for weight, part in self._parts:
            second = part.second(stages, x[-2:])
            if second is None:
                return None
            inner = inner + weight * self.z[-3] * second
        h = self.solvers.h[:, None, None]
        return np.asarray(h * np.einsum("ik,jkn->jin", A, inner))


@dataclass(frozen=True, eq=False)
class Part:
    """d/ds along one real direction, by a central difference of length `step`."""

    whole: ChangeOfImage
    d: Array
    q: float
    step: float

    @cached_property
    def _ends(self) -> list[tuple[Array, Array]]:
        """States and parameters ahead and behind."""
        whole, found = self.whole, []
        for s in (self.step, -self.step):
            p = whole.family.full_parameters(whole.base.inner(whole.z))
            p[whole.family.active] += s * self.q
            found.append((whole.states + s * self.d, p))
        return found

    @cached_property
    def _sides(self) -> Sides | None:
        points, n = self.whole.family.points, self.whole.family.n
        ahead, behind = (points.products(U.reshape(-1, n), p) for U, p in self._ends)
        return None if ahead is None or behind is None else (ahead, behind)

    @cached_property
    def _slopes(self) -> Array:
        """d/ds f_p of the second and of the active parameter, (2, N, 3, n)."""
        whole = self.whole
        ends = [[whole._slopes(U, p, place) for place in (whole.base.second, whole.family.active)]
                for U, p in self._ends]  # fmt: skip
        return np.asarray((np.array(ends[0]) - np.array(ends[1])) / (2.0 * self.step))

    def second(self, stages: Array, parameters: Array) -> Array | None:
        """D^2 f [(d, q), (stages, parameters)] at all points."""
        if self.step == 0.0:
            return np.zeros_like(stages)
        if self._sides is None:
            return None
        rows = stages.reshape(-1, stages.shape[2])
        moved = np.array([ahead(row) - behind(row) for ahead, behind, row in zip(*self._sides, rows, strict=True)])
        second = moved.reshape(stages.shape) / (2.0 * self.step)
        return np.asarray(second + np.einsum("k,kjin->jin", parameters, self._slopes))
