"""Derivatives of a user's function along straight lines: complex steps where analytic, else high-order differences.

phi(t) = F(z + t v), z = (u, p). With F analytic and written so that it takes complex arguments, the Taylor
coefficients of phi come from a circle (`circles`), the first derivative from a complex step, without error. Otherwise
central stencils of order 6 to 8 are used (`stencils`), on the user's Jacobian where there is one (one order less to
difference).
"""

from __future__ import annotations

import math
import warnings
import zlib
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from contin.abi import Array, Vector
from contin.machine import elementary
from contin.systems.functions import tiny
from contin.systems.functions.circles import EPS, TINY, coefficients, derivative_on_circle, nodes
from contin.systems.functions.complex_steps import COMPLEX_STEP, slope
from contin.systems.functions.generic_change import GenericChange
from contin.systems.functions.known_lines import KnownLines, Line
from contin.systems.functions.polarised import are_alike, polarised
from contin.systems.functions.stencils import differentiated
from contin.systems.functions.tensors import second, third

AGREEMENT = 1e-5  # relative difference of a complex step and a real one, beyond which F is not analytic
ROUGH = 1e-4  # relative step of a difference of matrices
MANY = 20_000  # states that are asked in one direction
ROUNDED = 8.0 * EPS  # a length that is off by this from 1 is 1

Function = Callable[[Vector, Vector], Vector]
Functional = Callable[[Vector], Any]


@dataclass(frozen=True, eq=False)
class Lines:
    """Directional derivatives of F(u, p), both vectors; `sizes` (n + m,) are typical sizes of u and p.

    analytic : F takes complex arguments and is analytic (see `is_analytic`).
    slope : D F(u, p)[v] by the user's Jacobian, v (n + m,), or None.
    wider : than usual, of stencils and circles for derivatives of second and higher order; how much these differ tells
        errors.
    levels : how many times narrower stencils are tried; () for the usual ones.
    grain : (u, p) -> what F is off by at random (n,); None where that is rounding.
    unsure : derivatives are off by as much as rounding may make them: alike at the same place along the same direction.
    """

    function: Function
    sizes: Array
    analytic: bool
    slope: Callable[[Array, Array, Array], Array] | None = None
    wider: float = 1.0
    levels: tuple[float, ...] = ()
    grain: Callable[[Array, Array], Array] | None = None
    unsure: bool = False
    _change: GenericChange = field(default_factory=GenericChange, repr=False)
    _known: KnownLines = field(default_factory=KnownLines, init=False, repr=False)

    def first(self, u: Array, p: Array, v: Array) -> Array:
        """D F[v]."""
        if self.analytic:
            h = COMPLEX_STEP * self._reach(u, p, v)
            n = len(u)
            return slope(self.function(u + 1j * h * v[:n], p + 1j * h * v[n:]), h)
        if self.slope is not None:
            return self.slope(u, p, v)
        return self.pure(u, p, v, 1)

    def pure(self, u: Array, p: Array, v: Vector, order: int) -> Vector:
        """D^k F[v, ..., v], k = `order`."""
        n = len(u)
        reach = self._reach(u, p, v)
        if reach == 0.0:
            return np.zeros(n)
        if self.analytic:
            return np.asarray(self._on_circle(u, p, v, order, reach))
        room = self._room(u, p, v, reach)
        along, across, function = v[:n], v[n:], self.function
        if self.slope is not None and order > 1:
            slope = self.slope
            ahead = lambda t: slope(u + t * along, p + t * across, v)  # noqa: E731
            return differentiated(ahead, order - 1, reach * self.wider, self.levels, room=room, unsure=self._noise(v))
        ahead = lambda t: function(u + t * along, p + t * across)  # noqa: E731
        off = 0.0 if self.grain is None else self.grain(u, p)
        return differentiated(ahead, order, reach * self.wider, self.levels, off, room, self._noise(v))

    def _on_circle(self, u: Array, p: Array, v: Vector, order: int, reach: float) -> Vector:
        """`pure` of an analytic F, v real or complex: what is known of this line serves again."""
        n, power = len(u), elementary.pow(reach, order)
        if not power > TINY:
            return np.full(n, np.nan)
        line = Line.along(v if abs(reach - 1.0) < ROUNDED else v * reach)
        known = self._known.on(u, p, line.v)
        along, across, function = line.v[:n], line.v[n:], self.function

        def on_line(t: complex) -> Vector:
            if t not in known:
                known[t] = np.asarray(function(u + t * along, p + t * across))
            return known[t]

        changes = lambda: self._change.at(self.first, self.sizes, u, p)  # noqa: E731
        whole, room = np.iscomplexobj(line.v), self._room(u, p, line.v, 1.0)
        found = derivative_on_circle(
            on_line, order, self.wider, n, changes=changes, room=room, whole=whole, unsure=self._noise(v)
        )
        return line.turned(found, order) / (1.0 if abs(reach - 1.0) < ROUNDED else power)

    def functional(self, left: Functional, u: Array, p: Array, v: Array, order: int) -> float:
        """left(D^k F[v, ..., v]), k = `order`, of a linear functional."""
        return self.functional_with_terms(left, u, p, v, order)[0]

    def functional_with_terms(self, left: Functional, u: Array, p: Array, v: Array, order: int) -> tuple[float, Array]:
        """`functional`, and D^k F[v, ..., v] as well as that needs it.

        Of an analytic F one series of numbers: how it converges is asked of what is wanted, and not of components of F
        whose derivatives are below the rounding of F, for which circle after circle is tried.
        """
        n = len(u)
        reach = self._reach(u, p, v)
        if not self.analytic or reach == 0.0:
            terms = self.pure(u, p, v, order)
            return float(np.real(left(terms))), terms
        values: list[Vector] = []  # on the last circle
        terms, around = np.full(n, np.nan), len(nodes()[0])

        def on_line(t: complex) -> Vector:
            if len(values) == around:
                values.clear()
            values.append(np.asarray(self.function(u + t * v[:n], p + t * v[n:])))
            return np.array([left(values[-1])])

        def taken(r: float) -> None:
            nonlocal terms
            terms = coefficients(values, order) * (math.factorial(order) / elementary.pow(r, order))

        room = self._room(u, p, v, reach)
        noise = self._noise(v)
        found = derivative_on_circle(on_line, order, reach * self.wider, 1, taken, room=room, unsure=noise)
        return float(found[0]), terms

    def form(self, u: Array, p: Array, directions: Sequence[Vector]) -> Vector:
        """D^k F[d1, ..., dk], directions (n + m,), by polarisation; complex ones of an analytic F, k >= 2."""
        if len(directions) == 1:
            return self.first(u, p, directions[0])
        reaches = [self._reach(u, p, d) for d in directions]
        if any(reach == 0.0 for reach in reaches):
            return np.zeros(len(u))
        return polarised(lambda v, k: self.pure(u, p, v, k), directions, reaches)

    def takes_complex(self, u: Array, p: Array, directions: Sequence[Vector]) -> bool:
        """Whether `form` takes these directions, the complex ones among them as they are."""
        size = np.maximum(np.abs(np.concatenate([u, p])), self.sizes)
        return self.analytic and all(are_alike(d, size) for d in directions)

    def tensor(self, u: Array, p: Array, order: int) -> Array:
        """All derivatives of order 2 or 3 by the states, (n, .., n, n), the last axis that of F's components."""
        n = len(u)
        reach = np.array([self._reach(u, p, np.eye(n, n + len(p))[k]) for k in range(n)])

        def pure(v: Array) -> Array:
            return self.pure(u, p, np.append(v * reach, np.zeros(len(p))), order)

        found = second(pure, n) if order == 2 else third(pure, n)
        inverse = np.where(reach > 0.0, 1.0 / np.where(reach > 0.0, reach, 1.0), 0.0)
        for axis in range(order):
            found = found * inverse.reshape([-1 if k == axis else 1 for k in range(order + 1)])
        return found

    def along(self, matrix: Callable[[Array, Array], Array], u: Array, p: Array, v: Array) -> Array:
        """d/dt of a matrix-valued function at (u, p) + t v, t = 0, by a stencil."""
        n, reach = len(u), self._reach(u, p, v)
        if reach == 0.0:
            return np.zeros_like(matrix(u, p))
        room = self._room(u, p, v, reach)
        ahead = lambda t: matrix(u + t * v[:n], p + t * v[n:])  # noqa: E731
        return differentiated(ahead, 1, reach * self.wider, self.levels, room=room)

    def roughly_along(self, matrix: Callable[[Array, Array], Array], u: Array, p: Array, v: Array) -> Array:
        """The same to some 1e-8 by two matrices, not six, where these are exact: for Newton's method and tangents."""
        n, reach = len(u), self._reach(u, p, v)
        if reach == 0.0 or self.levels or self.grain is not None or self._room(u, p, v, reach) != 1.0:
            return self.along(matrix, u, p, v)
        step = ROUGH * reach * v
        ahead, behind = (matrix(u + s * step[:n], p + s * step[n:]) for s in (1.0, -1.0))
        return np.asarray((ahead - behind) / (2.0 * ROUGH * reach))

    def _reach(self, u: Array, p: Array, v: Array) -> float:
        """How far along v an unknown changes by its own size; 0 for v = 0."""
        size = np.maximum(np.abs(np.concatenate([u, p])), self.sizes)
        largest = float(np.max(np.abs(v) / size))
        return 0.0 if largest == 0.0 else 1.0 / largest

    def _noise(self, v: Vector) -> np.random.Generator | None:
        """Errors along v, which no other direction shares."""
        return np.random.default_rng(zlib.crc32(v.tobytes())) if self.unsure else None

    def _room(self, u: Array, p: Array, v: Array, reach: float) -> float:
        """How many times farther steps may go where states or parameters, those that move, are far apart in size."""
        n, size = len(u), np.maximum(np.abs(np.concatenate([u, p])), self.sizes)
        moved = slice(None) if v[:n].any() and v[n:].any() else slice(n) if v[:n].any() else slice(n, None)
        return 1.0 if self.levels else tiny.room(size[moved], v[moved], reach)


def is_analytic(function: Function, u: Array, p: Array, sizes: Array) -> bool:
    """True where the function takes complex arguments and its complex step agrees with a real difference.

    Tried beside (u, p) in two generic directions, so that what vanishes at a symmetric start does not hide anything;
    in one where so many states move that none hides the others by chance.
    """
    n = len(u)
    generator = np.random.default_rng(7)
    real = Lines(function, sizes, False)
    complex_ = Lines(function, sizes, True)
    for _ in range(2 if n <= MANY else 1):
        v = sizes * generator.uniform(-1.0, 1.0, sizes.size)
        shift = 0.01 * sizes * generator.uniform(-1.0, 1.0, sizes.size)
        z_u, z_p = u + shift[:n], p + shift[n:]
        try:
            with np.errstate(all="ignore"), warnings.catch_warnings():
                warnings.simplefilter("error", np.exceptions.ComplexWarning)  # imaginary parts thrown away
                by_step = complex_.first(z_u, z_p, v)
                by_circle = complex_.pure(z_u, z_p, v, 1)
        except (TypeError, ValueError, AttributeError, np.exceptions.ComplexWarning):
            return False  # no complex arguments: differences are taken instead
        with np.errstate(all="ignore"):
            by_difference = real.pure(z_u, z_p, v, 1)
        largest = float(np.max(np.abs(by_difference), initial=0.0))
        if not (np.all(np.isfinite(by_step)) and np.all(np.isfinite(by_circle)) and np.isfinite(largest)):
            return False
        gap = max(float(np.max(np.abs(by_step - by_difference))), float(np.max(np.abs(by_circle - by_difference))))
        if gap > AGREEMENT * largest + 1e-300:
            return False
    return True
