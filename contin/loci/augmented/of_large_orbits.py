"""Curves in two parameters of folds, period doublings and torus bifurcations of orbits of large systems.

PD : g = 0 of [M + 1, b; c^T, 0] [v; g] = [0; 1], which is smooth where a second multiplier is -1; dg = -<w, dM v>, w
the left vector.
NS : log |mu| = 0 of the multiplier mu that is followed, [M - mu, b; c^H, 0] [v; g] = [0; 1], g(mu) = 0, by
Newton's method with g' = <w, v>; d mu = <w, dM v>/<w, v>.
LPC : t_p = 0 of [E'; b^T] t = e_last, the tangent of the family in the first parameter; E' dt = -dE' t.

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
from contin.linalg.krylov import gmres
from contin.linalg.vectors import dot, norm
from contin.loci.augmented.curve_equations import CurveEquations
from contin.loci.augmented.elimination import Scalars
from contin.loci.augmented.large_orbit_curve import LargeOrbitCurve
from contin.loci.augmented.large_orbits import LargeOrbitBase
from contin.machine import elementary
from contin.problems.large_orbits.cycle import Monodromy
from contin.problems.large_orbits.large_orbit import LargeOrbitProblem
from contin.problems.large_orbits.large_orbit_equations import Memory
from contin.problems.large_orbits.multipliers import REAL, critical_index
from contin.problems.large_orbits.sweeps import Sweeps
from contin.problems.two_parameters import indices

if TYPE_CHECKING:
    from contin.problems.large_orbits.linearised import OrbitLinearisation

Image = Callable[[LargeOrbitProblem, Array], Vector | None]
STEP: Final = 1e-5  # of differences, relative to sizes of the metric
SETTLED: Final = 1e-12  # correction of a multiplier
BUDGET: Final = 8  # of corrections


@dataclass(frozen=True, eq=False)
class Eigenpair:
    """A multiplier with its right vector v and left one w (w^T M = mu w^T), <w, v> = `product`."""

    value: complex
    v: Vector
    w: Vector
    product: complex


def eigenpair(sweeps: Sweeps, value: complex, b: Vector, c: Vector) -> Eigenpair | None:
    """The multiplier near `value`, by Newton's method with the borders b, c; real where they are."""
    n = sweeps.n
    last = np.append(np.zeros(n), 1.0).astype(np.result_type(b, c, value))
    mu = value
    for _ in range(BUDGET):

        def forward(x: Vector, mu: complex = mu) -> Vector:
            return np.append(sweeps.monodromy(x[:n]) - mu * x[:n] + b * x[n], np.einsum("i,i->", c, x[:n]))

        def backward(x: Vector, mu: complex = mu) -> Vector:
            return np.append(sweeps.transposed(x[:n]) - mu * x[:n] + c * x[n], np.einsum("i,i->", b, x[:n]))

        right = gmres(forward, lambda r: r, last)[0]
        left = gmres(backward, lambda r: r, last)[0]
        slope = np.einsum("i,i->", left[:n], right[:n])
        step = -right[n] / slope
        if not np.isfinite(step):
            return None
        mu = mu + step
        if abs(step) < SETTLED:
            return Eigenpair(mu, right[:n], left[:n], slope)
        if not abs(step) < 1.0:
            return None
    return Eigenpair(mu, right[:n], left[:n], slope) if abs(step) < np.sqrt(SETTLED) else None


@dataclass(eq=False)
class Followed:
    """log |mu| of one multiplier of a pair near a point, whose vectors are the borders."""

    base: LargeOrbitBase
    scale: Array
    value: complex
    b: Vector
    c: Vector
    _last: tuple[Array, Eigenpair | None] | None = field(default=None)

    def _pair(self, z: Array) -> Eigenpair | None:
        if self._last is None or not np.array_equal(self._last[0], z):
            sweeps = self.base.at(z).sweeps(self.base.inner(z))
            found = None if sweeps is None else eigenpair(sweeps, self.value, self.b, self.c)
            if found is not None and abs(np.imag(found.value)) <= REAL * abs(found.value):
                found = None  # the pair has met: what is real has another type
            self._last = z.copy(), found
        return self._last[1]

    def __call__(self, z: Array) -> Array:
        pair = self._pair(z)
        return np.array([np.nan if pair is None else elementary.log(abs(pair.value))])

    def along(self, z: Array, x: Array) -> Array:
        pair = self._pair(z)
        problem, inner = self.base.at(z), self.base.inner(z)
        sweeps = problem.sweeps(inner) if pair is not None else None
        if pair is None or sweeps is None:
            return np.full(1, np.nan)
        d = sweeps.along(pair.v)
        change = slope_of(self.base, z, x, self.scale, lambda family, at: family.image(at, d))
        if change is None:
            return np.full(1, np.nan)
        moved = sweeps.along(np.zeros(len(pair.v)), change)[-1, 2]
        rate = np.einsum("i,i->", pair.w, moved) / pair.product
        return np.array([float(np.real(rate / pair.value))])


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
            own = self.base.inner(scale)
            border = family.tangents(inner, own)[0]
            return Turning(self.base, scale, border)
        values, vectors = family.multipliers(inner, exactly=True)
        k = critical_index(values, self.type)
        sweeps = family.sweeps(inner)
        if k is None or sweeps is None:
            return lambda at: np.full(1, np.nan)
        if self.type == "PD":
            right = np.real(vectors[:, [k]])
            borders = Monodromy.at(sweeps, -1.0, right)
            return Flipped(self.base, scale, np.real(borders.b[:, 0]), np.real(borders.c[:, 0]))
        v = vectors[:, k]
        rough = eigenpair(sweeps, complex(values[k]), v / norm(v), v.conj() / norm(v))
        if rough is None:
            return lambda at: np.full(1, np.nan)
        b, c = rough.w.conj() / norm(rough.w), rough.v.conj() / norm(rough.v)
        return Followed(self.base, scale, rough.value, b, c)


def curve_of(problem: LargeOrbitProblem, z: Array, type_: str, parameters: Sequence[str], parent: Parent) -> Seed:
    """The curve of special orbits of a type in two parameters, from one of them."""
    first, second = indices(problem.system, parameters)
    p = problem.full_parameters(z)
    base = LargeOrbitBase(replace(problem, base=p.copy(), active=first, memory=Memory()), second)
    made = LargeOrbitCurve(base, (Special(base, type_),), type_, tuple(parameters))
    return Seed(made, np.concatenate([z[:-1], [p[second], p[first]]]), parent=parent)
