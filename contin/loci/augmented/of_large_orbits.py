"""Curves in two parameters of folds, period doublings and torus bifurcations of orbits of large systems.

PD : g = 0 of [M + 1, b; c^T, 0] [v; g] = [0; 1], which is smooth where a second multiplier is -1; dg = -<w, dM v>, w
the left vector.
NS : log |mu_1 mu_2| = 0 of the two multipliers of an invariant plane that is followed, which is smooth where they meet,
at resonances 1:1 and 1:2 (`contin.problems.large_orbits.invariant_plane`); beyond these they are real.
LPC : t_p = 0 of [E'; b^T] t = e_last, the tangent of the family in the parameter along which the curve moves less;
E' dt = -dE' t.

dM v and dE' t along a direction are one way round the orbit, with the change of the linearised equations as its right
side: differences of products with J, no factors of other orbits.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Array, Vector
from contin.continuation.branch import Parent
from contin.continuation.seed import Seed
from contin.linalg.vectors import dot, norm
from contin.loci.augmented.curve_equations import CurveEquations
from contin.loci.augmented.elimination import Scalars, first_rows, null_space
from contin.loci.augmented.large_orbit_curve import LargeOrbitCurve
from contin.loci.augmented.large_orbits import LargeOrbitBase, Latest
from contin.machine import elementary
from contin.problems.large_orbits.cycle import Monodromy
from contin.problems.large_orbits.invariant_plane import Across, Plane, plane_near
from contin.problems.large_orbits.large_orbit import LargeOrbitProblem
from contin.problems.large_orbits.large_orbit_equations import Memory
from contin.problems.large_orbits.multipliers import critical_index, critical_pair, plane_of
from contin.problems.two_parameters import indices

if TYPE_CHECKING:
    from contin.problems.large_orbits.linearised import OrbitLinearisation

Image = Callable[[LargeOrbitProblem, Array], Vector | None]
STEP: Final = 1e-5  # of differences, relative to sizes of the metric


@dataclass(eq=False)
class Followed:
    """log |mu_1 mu_2| / 2 of the two multipliers of a plane that is followed."""

    base: LargeOrbitBase
    scale: Array
    guess: Array
    _last: tuple[Array, tuple[Across, Plane] | None] | None = field(default=None)

    def _plane(self, z: Array) -> tuple[Across, Plane] | None:
        if self._last is None or not np.array_equal(self._last[0], z):
            family, inner = self.base.at(z), self.base.inner(z)
            sweeps = family.sweeps(inner)
            across = None if sweeps is None else Across(sweeps, family.velocity(inner))
            plane = None if across is None else plane_near(across, self.guess)
            self._last = z.copy(), None if across is None or plane is None else (across, plane)
        return self._last[1]

    def __call__(self, z: Array) -> Array:
        found = self._plane(z)
        return np.array([np.nan if found is None else 0.5 * elementary.log(abs(found[1].product))])

    def along(self, z: Array, x: Array) -> Array:
        found = self._plane(z)
        if found is None:
            return np.full(1, np.nan)
        across, plane = found
        one, other = (across.projected(v) for v in plane.right.T)
        d = across.sweeps.along(one + 1j * other)  # two real ones at once

        def image(family: LargeOrbitProblem, at: Array) -> Vector | None:
            moved = family.image(at, d)
            return None if moved is None else np.concatenate([moved.ravel(), family.velocity(at)])

        change = slope_of(self.base, z, x, self.scale, image)
        if change is None:
            return np.full(1, np.nan)
        led = across.sweeps.along(np.zeros(len(one)), change[: d.size].reshape(d.shape))[-1, 2]
        turned = across.change(plane.right, np.column_stack([led.real, led.imag]), change[d.size :].real)
        return np.array([0.5 * plane.rate(turned)])


@dataclass(eq=False)
class Flipped:
    """g of the multiplier -1 near a point, whose vectors are the borders."""

    base: LargeOrbitBase
    scale: Array
    b: Array
    c: Array
    _last: tuple[Array, tuple[Array, Array, float] | None] | None = field(default=None)

    def _at(self, z: Array) -> tuple[Array, Array, float] | None:
        """v, w and g."""
        if self._last is None or not np.array_equal(self._last[0], z):
            sweeps = self.base.at(z).sweeps(self.base.inner(z))
            found = None
            if sweeps is not None:
                bordered, n = Monodromy(sweeps, -1.0, self.b[:, None], self.c[:, None]), sweeps.n
                unit = np.append(np.zeros(n), 1.0)
                right, left = bordered.solve(unit), bordered.adjoint(unit)
                found = right[:n], left[:n], float(right[n])
            self._last = z.copy(), found
        return self._last[1]

    def __call__(self, z: Array) -> Array:
        here = self._at(z)
        return np.array([np.nan if here is None else here[2]])

    def along(self, z: Array, x: Array) -> Array:
        here, sweeps = self._at(z), self.base.at(z).sweeps(self.base.inner(z))
        if here is None or sweeps is None:
            return np.full(1, np.nan)
        d = sweeps.along(here[0])
        change = slope_of(self.base, z, x, self.scale, lambda family, at: family.image(at, d))
        if change is None:
            return np.full(1, np.nan)
        return np.array([-dot(here[1], sweeps.along(np.zeros(len(here[0])), change)[-1, 2])])


@dataclass(eq=False)
class Turning:
    """t_p of the family's tangent, with the tangent at a point nearby as border."""

    base: LargeOrbitBase
    scale: Array
    border: Array
    _last: tuple[Array, OrbitLinearisation | None] | None = field(default=None)

    @cached_property
    def _own(self) -> Array:
        return self.base.inner(self.scale)

    def _at(self, z: Array) -> OrbitLinearisation | None:
        if self._last is None or not np.array_equal(self._last[0], z):
            self._last = z.copy(), self.base.at(z).linearisation(self.base.inner(z), self.border, self._own)
        return self._last[1]

    def tangent(self, z: Array) -> Array | None:
        """t, scaled; b^T t = 1."""
        here = self._at(z)
        return None if here is None else here.solve(np.append(np.zeros(len(self._own) - 1), 1.0))

    def __call__(self, z: Array) -> Array:
        t = self.tangent(z)
        return np.array([np.nan if t is None else t[-1]])

    def along(self, z: Array, x: Array) -> Array:
        here, t = self._at(z), self.tangent(z)
        if here is None or t is None:
            return np.full(1, np.nan)
        problem, raw = self.base.at(z), t * self._own
        inner = self.base.inner(z)
        d = problem.carried(inner, raw)
        if d is None:
            return np.full(1, np.nan)
        known: Vector = d

        def image(family: LargeOrbitProblem, at: Array) -> Vector | None:
            moved = family.image(at, known)
            by = family.by_scalars(at, (family.active,))
            return None if moved is None else moved + np.einsum("k,kjin->jin", raw[-2:], by)

        change = slope_of(self.base, z, x, self.scale, image)
        if change is None:
            return np.full(1, np.nan)
        solved = here.response(change)
        return np.array([float(solved[-1])])


def slope_of(base: LargeOrbitBase, z: Array, x: Array, scale: Array, image: Image) -> Vector | None:
    """The derivative of `image` along x at z, by central differences."""
    length = norm(x / scale)
    step = STEP / length * x if length > 0.0 else x
    ends = []
    for at in (z + step, z - step):
        base_there = base.problem.base.copy()
        base_there[base.second] = at[-2]
        ends.append(image(base.problem.at_constants(base_there), base.inner(at)))
    if length == 0.0 or ends[0] is None or ends[1] is None:
        return None if ends[0] is None or ends[1] is None else np.zeros_like(ends[0])
    return np.asarray((ends[0] - ends[1]) * (0.5 * length / STEP))


@dataclass(frozen=True, eq=False)
class TurningInSecond:
    """`Turning` of the family in the second parameter: where the curve runs along the first one, that moves no fold."""

    turning: Turning

    @staticmethod
    def swapped(z: Array) -> Array:
        return np.append(z[:-2], z[[-1, -2]])

    def __call__(self, z: Array) -> Array:
        return self.turning(self.swapped(z))

    def along(self, z: Array, x: Array) -> Array:
        return self.turning.along(self.swapped(z), self.swapped(x))


def runs_along_first(base: LargeOrbitBase, z: Array, scale: Array) -> bool:
    """True where a curve of folds moves further in the first parameter than in the second, each in its unit.

    The null space of the equations with both parameters free has one direction that moves neither, and one along it.
    """
    here = base.linearise(z, scale, first_rows(2, z.size))
    if here is None or here.sign == 0.0:
        return False
    moved = null_space(here, 2)[-2:]
    if not np.all(np.isfinite(moved)):
        return False
    second, first = np.abs(np.linalg.svd(moved)[0][:, 0])
    return bool(first > second)


def in_second(base: LargeOrbitBase) -> LargeOrbitBase:
    """The same orbits as families in the second parameter."""
    family = replace(base.problem, active=base.second, memory=replace(base.problem.memory, solvers=None, origin=None))
    return replace(base, problem=family, second=base.problem.active, _latest=Latest())


@dataclass(frozen=True, eq=False)
class Special:
    """The condition of a type of special orbits."""

    base: LargeOrbitBase
    type: str

    @property
    def text(self) -> str:
        return f"the condition of {self.type}"

    def near(self, problem: CurveEquations, z: Array, scale: Array) -> Scalars:
        family, inner = self.base.at(z), self.base.inner(z)
        if self.type == "LPC":
            base, moved = self.base, TurningInSecond.swapped
            if not runs_along_first(base, z, scale):
                return Turning(base, scale, family.tangents(inner, base.inner(scale))[0])
            base, z, scale = in_second(base), moved(z), moved(scale)
            border = base.at(z).tangents(base.inner(z), base.inner(scale))[0]
            return TurningInSecond(Turning(base, scale, border))
        values, vectors = family.multipliers(inner, exactly=True)
        sweeps = family.sweeps(inner)
        if self.type == "NS":
            pair = critical_pair(values)
            return (lambda at: np.full(1, np.nan)) if pair is None else Followed(
                self.base, scale, plane_of(values, vectors, pair)
            )  # fmt: skip
        k = critical_index(values, self.type)
        if k is None or sweeps is None:
            return lambda at: np.full(1, np.nan)
        borders = Monodromy.at(sweeps, -1.0, np.real(vectors[:, [k]]))
        return Flipped(self.base, scale, np.real(borders.b[:, 0]), np.real(borders.c[:, 0]))


def curve_of(problem: LargeOrbitProblem, z: Array, type_: str, parameters: Sequence[str], parent: Parent) -> Seed:
    """The curve of special orbits of a type in two parameters, from one of them."""
    first, second = indices(problem.system, parameters)
    p = problem.full_parameters(z)
    base = LargeOrbitBase(replace(problem, base=p.copy(), active=first, memory=Memory()), second)
    made = LargeOrbitCurve(base, (Special(base, type_),), type_, tuple(parameters))
    return Seed(made, np.concatenate([z[:-1], [p[second], p[first]]]), parent=parent)
