"""Extrema of a column along a curve, held while further parameters vary (successive extremum continuation).

An extremum of phi over the solutions of E = 0, with the newest parameters fixed: D phi vanishes on the null space W of
E' in which these do not vary. With m directions in W that makes m scalars, so one more parameter gives a curve of
extrema, and an extremum of phi on that curve is one in two parameters, and so on (Kernevez and Doedel 1987).

Their derivatives along x need no more factors than W itself: with A = [E'; B], A w = e,

    (D phi w)' x = D^2 phi[w, x] + D phi w',    A w' = -[E''[w, x]; 0]
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Final, Protocol, cast

import numpy as np

from contin.abi import Array
from contin.continuation.corrector import is_singular
from contin.linalg.vectors import norm
from contin.loci.augmented.elimination import Bordered, Scalars, differenced, first_rows, null_space, orthonormal
from contin.offers import offers

if TYPE_CHECKING:
    from contin.loci.augmented.base import Base
    from contin.loci.augmented.curve_equations import CurveEquations

STEP: Final = 1e-3  # scaled, of the five-point differences of the column
MATRIX: Final = 1e-5  # scaled, of the central differences of E'
ROUNDS: Final = 3
SIDES: Final = (-2.0, -1.0, 1.0, 2.0)
FIRST: Final = np.array([1.0, -8.0, 8.0, -1.0]) / (12.0 * STEP)  # at `SIDES`
SECOND: Final = np.array([-1.0, 16.0, 16.0, -1.0]) / (12.0 * STEP * STEP)  # without the middle, which cancels


class Applied(Protocol):
    """A bordered linearisation that applies what it is made of."""

    def image(self, x: Array) -> Array:
        """E' x, both scaled."""


@dataclass(frozen=True)
class Extremal:
    """`column` is stationary while the parameter `newest` of the curve is fixed."""

    column: str
    newest: str

    @property
    def text(self) -> str:
        return f"extrema of {self.column}"

    def near(self, problem: CurveEquations, z: Array, scale: Array) -> Scalars:
        base = problem.base
        fixed = np.zeros((1, z.size))
        fixed[0, -1 - base.names.index(self.newest)] = 1.0
        count = base.varying - base.conditions - 1
        across = first_rows(count, z.size)
        for _ in range(ROUNDS):
            here = Directions.at(base, z, scale, np.vstack([fixed, across]))
            if here is not None and np.all(np.isfinite(here.w)):
                across = orthonormal(here.w.T)
        place = base.names.index(self.column) if self.column in base.names else None
        return Stationary(base, self.column, place, scale, np.vstack([fixed, across]))


@dataclass(frozen=True, eq=False)
class Directions:
    """W (N, m), scaled, at z: A w = e below E'."""

    base: Base
    z: Array
    scale: Array
    rows: Array
    here: Bordered

    @classmethod
    def at(cls, base: Base, z: Array, scale: Array, rows: Array) -> Directions | None:
        """None where the equations have no value, or no such directions."""
        here = base.linearise(z, scale, rows)
        return None if here is None or is_singular(here) else cls(base, z.copy(), scale, rows, here)

    @cached_property
    def w(self) -> Array:
        return null_space(self.here, len(self.rows))[:, 1:]

    @cached_property
    def _beside(self) -> list[tuple[Applied, Applied, float]] | None:
        """E' on both sides along each w, with what their difference is multiplied by; None where it is not applied."""
        found = []
        for w in self.w.T:
            length = norm(w)
            step = MATRIX / length * self.scale * w if length > 0.0 else np.zeros(len(w))
            sides = [self.base.linearise(self.z + s * step, self.scale, self.rows) for s in (1.0, -1.0)]
            if any(side is None or not offers(type(side), "image") for side in sides):
                return None
            ahead, behind = cast("list[Applied]", sides)
            found.append((ahead, behind, 0.5 * length / MATRIX))
        return found

    def turned(self, x: Array) -> Array | None:
        """W' along x (N, m), scaled; None where E' is not applied."""
        if self._beside is None:
            return None
        still = np.zeros(len(self.rows))
        images = [factor * (ahead.image(x) - behind.image(x)) for ahead, behind, factor in self._beside]
        return np.column_stack([-self.here.solve(np.append(image, still)) for image in images])


@dataclass(frozen=True, eq=False)
class Stationary:
    """The scalars D phi w.

    place : of the column among the varying parameters, where it is one.  rows : B below E'.
    """

    base: Base
    column: str
    place: int | None
    scale: Array
    rows: Array
    _last: list[Directions] = field(default_factory=list)  # derivatives are asked where the scalars were

    def __call__(self, z: Array) -> Array:
        here = self._directions(z)
        if here is None:
            return np.full(len(self.rows) - 1, np.nan)
        if self.place is not None:
            return np.asarray(here.w[-1 - self.place])
        return self._firsts(z, here.w)

    def along(self, z: Array, x: Array) -> Array:
        """The derivatives (m,) along x, both unscaled."""
        x = x / self.scale
        here = self._directions(z)
        turned = None if here is None else here.turned(x)
        if here is None or turned is None:
            return differenced(self, z, x, self.scale)
        if self.place is not None:
            return np.asarray(turned[-1 - self.place])
        return self._firsts(z, turned) + self._mixed(z, here.w, x)

    def _directions(self, z: Array) -> Directions | None:
        if not (self._last and np.array_equal(self._last[0].z, z)):
            self._last[:] = [found] if (found := Directions.at(self.base, z, self.scale, self.rows)) else []
        return self._last[0] if self._last else None

    def _firsts(self, z: Array, along: Array) -> Array:
        """D phi w of each of some scaled directions (N, m)."""
        return FIRST @ self._values(z, along)

    def _mixed(self, z: Array, along: Array, x: Array) -> Array:
        """D^2 phi[w, x], of the sum and of the difference of both, which are of one length."""
        length, lengths = norm(x), np.linalg.norm(along, axis=0)
        if length == 0.0 or not np.all(lengths > 0.0):
            return np.zeros(len(lengths))
        w, x = along / lengths, (x / length)[:, None]
        values = SECOND @ self._values(z, np.hstack([w + x, w - x]))
        ahead, aside = values.reshape(2, -1)
        return np.asarray(0.25 * length * lengths * (ahead - aside))

    def _values(self, z: Array, along: Array) -> Array:
        """The column (4, m) at `SIDES` steps along each direction."""
        steps = STEP * self.scale[:, None] * along
        stencil = np.concatenate([z + k * step for step in steps.T for k in SIDES])
        return np.asarray(self.base.column(self.column, stencil.reshape(-1, z.size)).reshape(-1, len(SIDES)).T)
