"""All zeros of the reduced equation on a circle, where the kernel of J has dimension 2."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Final

import numpy as np

from contin.abi import Array
from contin.machine import elementary
from contin.problems.equilibria.branching.reduced import ReducedEquations

SAMPLES: Final = 48  # angles
CUBIC: Final = 0.05  # of its size between two angles: how well a cubic must describe h
LOW: Final = 0.3  # part of its size above which h has no zero between
CLEAR: Final = 1e3  # times its rounding errors: |h| between two zeros that are told apart
DEPTH: Final = 40  # halvings
MOST: Final = 4000  # evaluations; an h that is rough all around the circle would be halved for minutes
ACCURATE: Final = 1e-13  # of the angle


@dataclass(frozen=True, eq=False)
class _At:
    t: float
    h: float
    slope: float  # by t
    v: Array


@dataclass(eq=False)
class CircleZeros:
    """Zeros of h(t), c = r (cos t, sin t): intervals are halved until h is nearly a cubic with one zero, or none."""

    reduced: ReducedEquations
    radius: float
    noise: float = 0.0
    lost: bool = False  # somewhere h has no value, or is not told from zero
    found: list[float] = field(default_factory=list)
    evaluations: int = 0

    def points(self) -> list[Array] | None:
        """The zeros as points; None where not all may be there."""
        angles = 2.0 * np.pi * (np.arange(SAMPLES + 1) + 0.3137) / SAMPLES
        first = self._at(float(angles[0]), np.zeros(len(self.reduced.y)))
        before, values = first, [] if first is None else [first]
        for t in angles[1:-1]:
            if before is None:
                return None
            before = self._at(float(t), before.v)
            values += [] if before is None else [before]
        if first is None or before is None:
            return None
        values.append(_At(first.t + 2.0 * np.pi, first.h, first.slope, first.v))
        points = []
        for a, b in pairwise(values):
            points += [
                self.reduced.y + self.reduced.kernel @ self._c(zero.t) + zero.v for zero in self._between(a, b, 0)
            ]
        return None if self.lost else points

    def _c(self, t: float) -> Array:
        return self.radius * np.array([elementary.cos(t), elementary.sin(t)])

    def _at(self, t: float, v: Array) -> _At | None:
        self.evaluations += 1
        value = self.reduced.value(self._c(t), v) if self.evaluations <= MOST else None
        if value is None:
            self.lost = True
            return None
        self.noise = max(self.noise, value.noise)
        by_t = self.radius * np.array([-elementary.sin(t), elementary.cos(t)])
        return _At(t, float(value.h[0]), float(value.slopes[0] @ by_t), value.v)

    def _between(self, a: _At, b: _At, depth: int) -> Iterator[_At]:
        if self.lost:  # the answer is None already: halving on would take a time exponential in DEPTH
            return
        size, width = max(abs(a.h), abs(b.h)), b.t - a.t
        middle = self._at(0.5 * (a.t + b.t), a.v)
        if middle is None:
            return
        cubic = 0.5 * (a.h + b.h) + 0.125 * width * (a.slope - b.slope)
        size = max(size, abs(middle.h))
        if size < CLEAR * self.noise or depth > DEPTH:
            self.lost = True
            return
        if abs(middle.h - cubic) <= CUBIC * size and max(abs(a.slope), abs(b.slope)) * width < 8.0 * size:
            same = a.h * b.h > 0.0 and a.h * middle.h > 0.0
            if same and min(abs(a.h), abs(b.h), abs(middle.h)) > LOW * size:
                return
            if a.h * b.h <= 0.0 and min(a.slope * b.slope, a.slope * middle.slope) > 0.0:
                yield self._zero(a, b)
                return
            if same and a.slope * b.slope > 0.0 and a.slope * middle.slope > 0.0:
                return  # monotone
        yield from self._between(a, middle, depth + 1)
        yield from self._between(middle, b, depth + 1)

    def _zero(self, a: _At, b: _At) -> _At:
        """The zero between a and b, by Newton's method inside bisection."""
        positive, near = b.h > 0.0, a if abs(a.h) < abs(b.h) else b
        low, high = a.t, b.t
        while high - low > ACCURATE:
            t = near.t - near.h / near.slope if near.slope != 0.0 else low
            inside = low < t < high
            at = self._at(t if inside else 0.5 * (low + high), near.v)
            if at is None or at.h == 0.0:
                return near if at is None else at
            settled = inside and abs(at.t - near.t) < ACCURATE
            near = at
            if settled:
                break
            low, high = (low, at.t) if (at.h > 0.0) == positive else (at.t, high)
        return near
