"""The scalars that vanish on curves of special orbits of large systems, with their derivatives along a direction.

PD : g = 0 of [M + 1, b; c^T, 0] [v; g] = [0; 1], which is smooth where a second multiplier is -1; dg = -<w, dM v>, w
the left vector.
NS : log |mu_1 mu_2| = 0 of the two multipliers of an invariant plane that is followed, which is smooth where they meet,
at resonances 1:1 and 1:2 (`contin.problems.large_orbits.invariant_plane`); beyond these they are real.
LPC : t_p = 0 of [E'; b^T] t = e_last, the tangent of the family in the parameter along which the curve moves less;
E' dt = -dE' t. (BPC : `branch_points_of_large_orbits`.)

dM v and dE' t along a direction are one way round the orbit, with the change of the linearised equations as its right
side (`change_of_image`): no factors of other orbits, and Jacobians beside the orbit once for all directions.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Array
from contin.linalg.vectors import dot, norm
from contin.loci.augmented.change_of_image import ChangeOfEquations, ChangeOfImage
from contin.loci.augmented.large_orbits import LargeOrbitBase
from contin.machine import elementary
from contin.problems.large_orbits.cycle import Monodromy
from contin.problems.large_orbits.invariant_plane import Across, Plane, plane_near

if TYPE_CHECKING:
    from contin.problems.large_orbits.linearised import OrbitLinearisation

STEP: Final = 1e-5  # of differences of the velocity, relative to sizes of the metric


@dataclass(eq=False)
class Followed:
    """log |mu_1 mu_2| / 2 of the two multipliers of a plane that is followed."""

    base: LargeOrbitBase
    scale: Array
    guess: Array
    _last: tuple[Array, AtPlane | None] | None = field(default=None)

    def _at(self, z: Array) -> AtPlane | None:
        if self._last is None or not np.array_equal(self._last[0], z):
            family, inner = self.base.at(z), self.base.inner(z)
            solvers = family.solvers(inner)
            across = None if solvers is None else Across(solvers.sweeps, family.velocity(inner))
            plane = None if across is None else plane_near(across, self.guess)
            found = None
            if solvers is not None and across is not None and plane is not None:
                one, other = (across.projected(v) for v in plane.right.T)
                d = solvers.sweeps.along(one + 1j * other)  # two real ones at once
                found = AtPlane(across, plane, ChangeOfImage(self.base, z.copy(), self.scale, solvers, d))
            self._last = z.copy(), found
        return self._last[1]

    def __call__(self, z: Array) -> Array:
        found = self._at(z)
        return np.array([np.nan if found is None else 0.5 * elementary.log(abs(found.plane.product))])

    def along(self, z: Array, x: Array) -> Array:
        found = self._at(z)
        change = None if found is None else found.image.along(x, found.image.stages(x))
        if found is None or change is None:
            return np.full(1, np.nan)
        across, plane = found.across, found.plane
        led = across.sweeps.along(np.zeros(len(plane.right)), change)[-1, 2]
        turned = across.change(plane.right, np.column_stack([led.real, led.imag]), self._turned(z, x))
        return np.array([0.5 * plane.rate(turned)])

    def _turned(self, z: Array, x: Array) -> Array:
        """The change of the velocity where the orbit begins, along x, by a central difference."""
        step = STEP / max(norm(x / self.scale), np.finfo(float).tiny) * x
        ends = []
        for at in (z + step, z - step):
            constants = self.base.problem.base.copy()
            constants[self.base.second] = at[-2]
            ends.append(self.base.problem.at_constants(constants).velocity(self.base.inner(at)))
        return np.asarray((ends[0] - ends[1]) * (0.5 * norm(x / self.scale) / STEP))


@dataclass(frozen=True, eq=False)
class AtPlane:
    """A plane that is followed, and how the linearised equations change."""

    across: Across
    plane: Plane
    image: ChangeOfImage


@dataclass(eq=False)
class Flipped:
    """g of the multiplier -1 near a point, whose vectors are the borders."""

    base: LargeOrbitBase
    scale: Array
    b: Array
    c: Array
    _last: tuple[Array, tuple[Array, float, ChangeOfImage] | None] | None = field(default=None)

    def _at(self, z: Array) -> tuple[Array, float, ChangeOfImage] | None:
        """w, g, and how the linearised equations change."""
        if self._last is None or not np.array_equal(self._last[0], z):
            solvers = self.base.at(z).solvers(self.base.inner(z))
            found = None
            if solvers is not None:
                sweeps = solvers.sweeps
                bordered, n = Monodromy(sweeps, -1.0, self.b[:, None], self.c[:, None]), sweeps.n
                unit = np.append(np.zeros(n), 1.0)
                right, left = bordered.solve(unit), bordered.adjoint(unit)
                image = ChangeOfImage(self.base, z.copy(), self.scale, solvers, sweeps.along(right[:n]))
                found = left[:n], float(right[n]), image
            self._last = z.copy(), found
        return self._last[1]

    def __call__(self, z: Array) -> Array:
        here = self._at(z)
        return np.array([np.nan if here is None else here[1]])

    def along(self, z: Array, x: Array) -> Array:
        here = self._at(z)
        if here is None:
            return np.full(1, np.nan)
        left, _, image = here
        change = image.along(x, image.stages(x))
        if change is None:
            return np.full(1, np.nan)
        return np.array([-dot(left, image.solvers.sweeps.along(np.zeros(len(left)), change)[-1, 2])])


@dataclass(eq=False)
class Turning:
    """t_p of the family's tangent, with the tangent at a point nearby as border."""

    base: LargeOrbitBase
    scale: Array
    border: Array
    _last: tuple[Array, TangentAt | None] | None = field(default=None)

    @cached_property
    def _own(self) -> Array:
        return self.base.inner(self.scale)

    def _at(self, z: Array) -> TangentAt | None:
        if self._last is None or not np.array_equal(self._last[0], z):
            family, inner = self.base.at(z), self.base.inner(z)
            here = family.linearisation(inner, self.border, self._own)
            solvers = family.solvers(inner)
            known = None
            if here is not None and solvers is not None:
                t = here.solve(np.append(np.zeros(len(self._own) - 1), 1.0))
                d = family.carried(inner, t * self._own)
                if d is not None:
                    raw = t[-2:] * self._own[-2:]
                    image = ChangeOfImage(self.base, z.copy(), self.scale, solvers, d, np.array([0.0, raw[1]]))
                    known = TangentAt(here, t, ChangeOfEquations(image, float(raw[0])))
            self._last = z.copy(), known
        return self._last[1]

    def __call__(self, z: Array) -> Array:
        here = self._at(z)
        return np.array([np.nan if here is None else here.t[-1]])

    def along(self, z: Array, x: Array) -> Array:
        here = self._at(z)
        change = None if here is None else here.change.along(x)
        if here is None or change is None:
            return np.full(1, np.nan)
        return np.array([float(here.linear.response(change)[-1])])


@dataclass(frozen=True, eq=False)
class TangentAt:
    """t (scaled), b^T t = 1, and how the linearised equations change."""

    linear: OrbitLinearisation
    t: Array
    change: ChangeOfEquations
