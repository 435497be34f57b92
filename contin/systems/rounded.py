"""Iterates of a map with other rounding errors, which large multipliers amplify until coefficients are made of them.

What is rounded at a point of a cycle is carried along it. Where a multiplier is 1e7, the iterate's derivatives at
different points differ by 1e-9 for a state in its last digit, and second ones by far more.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Final
from zlib import crc32

import numpy as np
from numpy.typing import ArrayLike

from contin.abi import Array, Vector
from contin.systems.chain_rule import Steps, form_of_iterate, path_of_iterates, slope_of_iterate
from contin.systems.protocol import form_by_form

ROUNDING: Final = 8.0 * float(np.finfo(float).eps)  # relative, of a derivative, which is itself a sum
OF_VALUES: Final = 2.0 * float(np.finfo(float).eps)  # ... and of the terms of f, as large as those of its linear part
PATTERNS: Final = 3


@dataclass(frozen=True, eq=False)
class RoundedMap:
    """A map whose values and derivatives are off by rounding, by signs that are made of the digits of the point."""

    base: Steps
    number: int  # of the pattern
    sizes: Array | None  # of the states (n,), where they are known: points of a cycle are solved for in these

    @property
    def n(self) -> int:
        return self.base.n

    @property
    def m(self) -> int:
        return self.base.m

    def jacobian(self, u: ArrayLike, p: ArrayLike) -> tuple[Array, Array]:
        x = np.asarray(u, dtype=float)
        value, matrix = self.base.jacobian(x, p)
        sizes = np.abs(value) + np.abs(matrix[:, : self.n]) @ np.abs(x)
        seed = x.tobytes()
        rounded = 1.0 + ROUNDING * self._signs(seed + b"J", matrix.size).reshape(matrix.shape)
        return value + OF_VALUES * sizes * self._signs(seed, self.n), matrix * rounded

    def derivative(self, u: ArrayLike, p: ArrayLike, *directions: ArrayLike) -> Vector:
        seed = b"".join(np.asarray(part).tobytes() for part in (u, *directions))
        form: Vector = self.base.derivative(u, p, *directions)
        return np.multiply(form, 1.0 + ROUNDING * self._signs(seed, self.n))

    def derivatives(self, u: Array, p: Array, *directions: Vector) -> Vector:
        forms: Vector = self.base.derivatives(u, p, *directions)
        seeds = (b"".join(part.tobytes() for part in row) for row in zip(u, *directions, strict=True))
        return np.multiply(forms, 1.0 + ROUNDING * np.array([self._signs(seed, self.n) for seed in seeds]))

    def start(self, u: ArrayLike) -> Array:
        """A point of a cycle that is known to rounding."""
        x = np.array(u, dtype=float)
        sizes = np.abs(x) if self.sizes is None else np.maximum(np.abs(x), self.sizes)
        near: Array = x + OF_VALUES * sizes * self._signs(x.tobytes() + b"x", self.n)
        return near

    def _signs(self, seed: bytes, count: int) -> Array:
        """+-1 at random, the same for the same seed."""
        bits = np.unpackbits(np.frombuffer(crc32(seed, self.number).to_bytes(4, "little"), np.uint8))
        signs: Array = np.asarray(2.0 * bits - 1.0, dtype=np.float64)
        return signs[:count] if count <= len(signs) else np.resize(signs, count)


@dataclass(frozen=True, eq=False)
class RoundedIterates:
    """u -> f^times(u, p) of such a map, as far as normal forms ask."""

    steps: RoundedMap
    times: int
    _paths: dict[bytes, list[tuple[Array, Array]]] = field(default_factory=dict, repr=False)

    def jacobian(self, u: ArrayLike, p: ArrayLike) -> tuple[Array, Array]:
        return slope_of_iterate(self.steps, self.times, self.steps.start(u), p)

    def derivative(self, u: ArrayLike, p: ArrayLike, *directions: ArrayLike) -> Vector:
        key = np.asarray(u, dtype=float).tobytes() + np.asarray(p, dtype=float).tobytes()
        if key not in self._paths:
            self._paths[key] = list(path_of_iterates(self.steps, self.times, self.steps.start(u), p))
        return form_of_iterate(self.steps, self._paths[key], p, directions)

    def derivatives(self, u: Array, p: Array, *directions: Vector) -> Vector:
        return form_by_form(self.derivative, u, p, directions)


def otherwise_rounded(base: Steps, times: int, sizes: Array | None) -> Sequence[RoundedIterates]:
    """The iterate of a map with other rounding errors; `sizes` of the states (n,), where they are known."""
    return [RoundedIterates(RoundedMap(base, number, sizes), times) for number in range(PATTERNS)]
