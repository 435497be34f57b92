"""A stretch of the curve near one accepted point: points at given arclength, and zeros of functions of them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Final

import numpy as np

from contin.abi import Array
from contin.continuation.problem import Problem
from contin.continuation.sample import Frame, Sample
from contin.continuation.settings import Settings
from contin.linalg.vectors import dot, norm

BUDGET: Final = 80  # of points, in a bracket that becomes narrower


@dataclass(frozen=True, eq=False)
class Stretch:
    """The curve around `base`, parametrised by the length s along base's tangent."""

    problem: Problem
    base: Sample
    frame: Frame
    settings: Settings
    halved: list[float] = field(default_factory=list)  # lengths of the parts that were halved to tell events apart

    def length_of(self, sample: Sample) -> float:
        """The parameter s of a point."""
        return dot(self.base.tangent, (sample.z - self.base.z) / self.frame.scale)

    def between(self, a: Sample, b: Sample, fraction: float) -> Sample | None:
        """The point at a fraction of the way from a to b (in s); None where Newton fails or leaves the stretch."""
        return self._between(a, b, (self.length_of(a), self.length_of(b)), fraction)

    def _between(self, a: Sample, b: Sample, lengths: tuple[float, float], fraction: float) -> Sample | None:
        compiled = self.problem.points_between(self.base, (a, b), lengths, (fraction,), self.frame, self.settings)
        if compiled is not None:
            return compiled[0]
        s_a, s_b = lengths
        s = s_a + fraction * (s_b - s_a)
        found = self.problem.probe(self.base, s, self.hermite(a, b, s_b - s_a, fraction), self.frame, self.settings)
        return found if found is None or self._is_near(found, a, b, 2.0 * self.distance(a, b)) else None

    def several(self, a: Sample, b: Sample, fractions: Sequence[float]) -> Sequence[Sample | None]:
        """`between` at several fractions."""
        lengths = s_a, s_b = self.length_of(a), self.length_of(b)
        compiled = self.problem.points_between(self.base, (a, b), lengths, fractions, self.frame, self.settings)
        if compiled is not None:
            return compiled
        x = np.asarray(fractions)
        guesses = self.hermite(a, b, s_b - s_a, x[:, None])
        samples = self.problem.probes(self.base, s_a + x * (s_b - s_a), guesses, self.frame, self.settings)
        slack = 2.0 * self.distance(a, b)
        return [s if s is not None and self._is_near(s, a, b, slack) else None for s in samples]

    def tests_between(
        self, a: Sample, b: Sample, fractions: Sequence[float], lengths: tuple[float, float]
    ) -> tuple[Array, Sequence[int]] | None:
        """Tests (m, k) and unstable counts of the points that `several` gives; None where one of these is not found.

        lengths : of a and b.
        """
        compiled = self.problem.tests_between(self.base, (a, b), lengths, fractions, self.frame, self.settings)
        if compiled is not None:
            return compiled if min(compiled[1]) >= 0 else None
        samples = [sample for sample in self.several(a, b, fractions) if sample is not None]
        if len(samples) < len(fractions):
            return None
        return np.array([sample.tests for sample in samples]), [sample.unstable for sample in samples]

    def _is_near(self, found: Sample, a: Sample, b: Sample, slack: float) -> bool:
        """False where Newton jumped to another branch."""
        return self.distance(found, a) <= slack and self.distance(found, b) <= slack

    def hermite(self, a: Sample, b: Sample, h: float, x: float | Array) -> Array:
        """Guesses at fractions x of the way from a to b, which is h long: a number, or (k, 1) for k rows."""
        chord = b.z - a.z
        linear, left = a.z + x * chord, 1 - x
        along_a, along_b = dot(self.base.tangent, a.tangent), dot(self.base.tangent, b.tangent)
        if h == 0.0 or min(abs(along_a), abs(along_b)) < 0.2:  # the parametrisation is poor here
            return np.asarray(linear)
        slope_a = self.frame.scale * a.tangent * (h / along_a) - chord
        slope_b = self.frame.scale * b.tangent * (h / along_b) - chord
        return np.asarray(linear + x * left * (left * slope_a - x * slope_b))

    def distance(self, a: Sample, b: Sample) -> float:
        return norm((a.z - b.z) / self.frame.scale)

    def zero(
        self, value: Callable[[Sample], float], a: Sample, b: Sample, accuracy: float
    ) -> tuple[Sample, Sample]:
        """Bracket of a sign change of `value` between a and b, narrowed to `accuracy` in s (secant inside bisection).

        The zero of the chord, then a point beyond it as far again, shrink the bracket on both sides; where they do not,
        the middle does, so that a jump (a corner of a piecewise equation) is found as surely as a zero.
        """
        f_a, f_b = value(a), value(b)
        s_a, s_b = self.length_of(a), self.length_of(b)
        width = abs(s_b - s_a)
        bisect, beyond, rough = False, False, False
        for _ in range(BUDGET):
            if width <= accuracy or f_b == 0.0:
                break
            fraction = 0.5
            if not bisect and f_a != f_b:
                fraction = f_a / (f_a - f_b)
                if beyond:  # the last zero of the chord is an end: twice as far from there lies the other side
                    aside = max(2.0 * min(fraction, 1.0 - fraction), 0.3 * accuracy / width)
                    fraction = aside if fraction < 0.5 else 1.0 - aside
                least = 0.1 * accuracy / width
                fraction = min(max(fraction, least), 1.0 - least)
            middle = self._between(a, b, (s_a, s_b), fraction)
            if middle is None:
                if fraction == 0.5:
                    break
                bisect = True
                continue
            f_middle = value(middle)
            if f_middle == 0.0:
                return middle, middle
            if (f_middle > 0.0) == (f_a > 0.0):
                a, f_a, s_a = middle, f_middle, self.length_of(middle)
            else:
                b, f_b, s_b = middle, f_middle, self.length_of(middle)
            new_width = abs(s_b - s_a)
            slow = new_width > 0.5 * width and not bisect
            rough |= slow and beyond
            bisect, beyond = slow and rough, slow and not rough
            width = new_width
        return a, b
