"""How the linearised equations of a large orbit change with the orbit, along any direction.

    D(T h (A x [J d + f_p q])) x = h (A x [T (d/ds J(u + s d, p + s q) x_u + d/ds f_p(..) x_p) + x_T (J d + f_p q)])

d/ds is a central difference along (d, q), made once for a point: D^2 f is symmetric, so it serves every direction x,
and each one more costs products only, neither Jacobians nor factors.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
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
    """Of d (N, 3, n), real or complex, and a change q (2,) of the second and the active parameter, at z of the curve.

    scale : its metric.  solvers : those of that point.
    """

    base: LargeOrbitBase
    z: Array
    scale: Array
    solvers: Solvers
    d: Vector
    q: Array = field(default_factory=lambda: np.zeros(2))

    @cached_property
    def places(self) -> tuple[int, int]:
        """Of the second and of the active parameter."""
        return self.base.second, self.family.active

    @cached_property
    def family(self) -> LargeOrbitProblem:
        return self.base.at(self.z)

    @cached_property
    def _parts(self) -> list[tuple[complex, Part]]:
        """Real directions and their weights."""
        if np.iscomplexobj(self.d):
            return [(1.0, self._part(self.d.real, self.q)), (1.0j, self._part(self.d.imag, np.zeros(2)))]
        return [(1.0, self._part(self.d, self.q))]

    def _part(self, d: Array, q: Array) -> Part:
        sizes = self.family.orbit_sizes(self.base.inner(self.z), self.base.inner(self.scale))
        reach = max(float(np.max(np.abs(d) / sizes)), float(np.max(np.abs(q) / self.scale[-2:])))
        return Part(self, d, q, STEP / reach if reach > 0.0 else 0.0)

    @cached_property
    def plain(self) -> Vector:
        """J d + f_p q"""
        moved = self.solvers.product(self.d)
        U, p = self.states, self.family.full_parameters(self.base.inner(self.z))
        for place, q in zip(self.places, self.q.tolist(), strict=True):
            moved = moved if q == 0.0 else moved + q * self._slopes(U, p, place)
        return np.asarray(moved)

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
            return np.asarray(np.einsum("k,kjin->jin", x[-3:], family.by_scalars(inner, self.places)))

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
class ChangeOfEquations:
    """How E' t changes, for t with the orbit's change and parameters of `image`, and the change of the period."""

    image: ChangeOfImage
    period: float

    @cached_property
    def _slopes(self) -> Array:
        """h (A x f_p) of the second and of the active parameter."""
        image = self.image
        found = image.family.by_scalars(image.base.inner(image.z), image.places)
        return np.asarray(found[1:] / image.z[-3])

    def along(self, x: Array) -> Vector | None:
        """dE' t along x, unscaled, but for its sign."""
        stages = self.image.stages(x)
        change = self.image.along(x, stages)
        if change is None:
            return None
        h = self.image.solvers.h[:, None, None]
        moved = h * np.einsum("ik,jkn->jin", A, self.image.solvers.product(stages))
        return np.asarray(change + self.period * (moved + np.einsum("k,kjin->jin", x[-2:], self._slopes)))


@dataclass(frozen=True, eq=False)
class Part:
    """d/ds along one real direction, by a central difference of length `step`."""

    whole: ChangeOfImage
    d: Array
    q: Array
    step: float

    @cached_property
    def _ends(self) -> list[tuple[Array, Array]]:
        """States and parameters ahead and behind."""
        whole, found = self.whole, []
        for s in (self.step, -self.step):
            p = whole.family.full_parameters(whole.base.inner(whole.z))
            p[list(whole.places)] += s * self.q
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
        ends = [[whole._slopes(U, p, place) for place in whole.places] for U, p in self._ends]
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
