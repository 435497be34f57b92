"""Equations whose linearisation solves bordered systems, and scalars h(z) = 0 besides, by block elimination.

    [E'; H; t] x = r,    A = [E'; B],    A V = [0; I],    x = y + V c,    A y = [r_E; 0]

E : equations of any discretisation, B : rows across their null space, V : that null space, H : derivatives of the
scalars, t : the tangent's row. Of the scalars only derivatives along V and y are needed, their own or central
differences: neither the size of E nor how it is factorised matters. (Govaerts 2000, ch. 3.)
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Final, Protocol, cast

import numpy as np

from contin.abi import Array
from contin.continuation.corrector import Forming, is_singular
from contin.linalg.vectors import norm
from contin.offers import offers

STEP: Final = 1e-5  # scaled, of the central differences of scalars

Scalars = Callable[[Array], Array]  # z -> (k,)


class Sloped(Protocol):
    """Scalars with derivatives of their own."""

    def __call__(self, z: Array) -> Array: ...

    def along(self, z: Array, x: Array) -> Array:
        """The derivatives (k,) along x, both unscaled."""


class Bordered(Protocol):
    """The scaled linearisation of E with the border rows below it."""

    @property
    def residual(self) -> Array:
        """Scaled E(z)."""

    @property
    def sign(self) -> float:
        """Of det A, 0 where A is singular."""

    @property
    def log_determinant(self) -> float: ...

    def solve(self, right: Array) -> Array:
        """A x = right, in scaled unknowns."""


@dataclass(frozen=True, eq=False)
class Augmented:
    """A `contin.continuation.corrector.Linearisation` of E and h, with one more row: the tangent (scaled).

    tangent : None where the scalars alone make the system square.
    """

    inner: Bordered
    scalars: Scalars
    values: Array  # h(z)
    z: Array
    scale: Array
    tangent: Array | None

    @property
    def _count(self) -> int:
        """Rows below E'."""
        return len(self.values) + (self.tangent is not None)

    @cached_property
    def null_space(self) -> Array:
        """V (N, k), k the number of rows below E'."""
        return null_space(self.inner, self._count)

    @cached_property
    def _small(self) -> Array:
        """What the rows below E' make of its null space, (k, k)."""
        slopes = [np.append(self.along(v), [] if self.tangent is None else [self.tangent @ v])
                  for v in self.null_space.T]  # fmt: skip
        return np.array(slopes).T

    def along(self, x: Array) -> Array:
        """Derivatives of the scalars along a scaled direction."""
        length = norm(x)
        if length == 0.0 or not self.values.size:
            return np.zeros(len(self.values))
        if hasattr(self.scalars, "along"):
            return np.asarray(cast(Sloped, self.scalars).along(self.z, self.scale * x))
        return differenced(self.scalars, self.z, x, self.scale)

    @property
    def form(self) -> Array | None:
        """Of branch points, see `contin.continuation.corrector.Forming`."""
        return cast(Forming, self.inner).form if offers(type(self.inner), "form") else None

    @cached_property
    def residual(self) -> Array:
        return np.concatenate([self.inner.residual, self.values])

    @cached_property
    def _determinant(self) -> tuple[float, float]:
        if not np.all(np.isfinite(self._small)):
            return 0.0, 0.0
        sign, size = np.linalg.slogdet(self._small)
        return float(sign), float(size)

    @property
    def is_singular(self) -> bool:
        return is_singular(self.inner) or self._determinant[0] == 0.0

    @property
    def sign(self) -> float:
        return self.inner.sign * self._determinant[0] if self.inner.sign != 0.0 else 0.0

    @property
    def log_determinant(self) -> float:
        return self.inner.log_determinant + self._determinant[1]

    def solve(self, right: Array) -> Array:
        count = len(right) - self._count
        y = np.zeros(len(self.z))
        if np.any(right[:count]):
            y = self.inner.solve(np.concatenate([right[:count], np.zeros(self._count)]))
        rest = right[count:] - np.append(self.along(y), [] if self.tangent is None else [self.tangent @ y])
        try:
            c = np.linalg.solve(self._small, rest)
        except np.linalg.LinAlgError:  # singular: the corrector fails, in words
            return np.full(len(self.z), np.nan)
        return np.asarray(y + self.null_space @ c)


def differenced(scalars: Scalars, z: Array, x: Array, scale: Array) -> Array:
    """Central differences of scalars along a scaled direction x."""
    length = norm(x)
    step = STEP / length * scale * x
    return np.asarray((scalars(z + step) - scalars(z - step)) * (0.5 * length / STEP))


def null_space(inner: Bordered, count: int) -> Array:
    """V (N, count) with E' V = 0 and B V = I."""
    units = np.eye(count, len(inner.residual) + count, len(inner.residual))
    return np.column_stack([inner.solve(unit) for unit in units])


def orthonormal(rows: Array) -> Array:
    """Orthonormal rows of the same span."""
    return np.asarray(np.linalg.qr(rows.T)[0].T)


def first_rows(count: int, size: int) -> Array:
    """Rows (count, size) that are across any null space but one of measure zero."""
    return orthonormal(np.random.default_rng(17).normal(size=(count, size)))
