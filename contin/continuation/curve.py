"""A stretch of the curve near one accepted point: points at given arclength, and zeros of functions of them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from contin.continuation.problem import Frame, Problem, Sample
from contin.continuation.settings import Settings
from contin.linalg.vectors import dot, norm


@dataclass(frozen=True, eq=False)
class Stretch:
    """The curve around `base`, parametrised by the length s along base's tangent."""

    problem: Problem
    base: Sample
    frame: Frame
    settings: Settings

    def length_of(self, sample: Sample) -> float:
        """The parameter s of a point."""
        return dot(self.base.tangent, (sample.z - self.base.z) / self.frame.scale)

    def between(self, a: Sample, b: Sample, fraction: float) -> Sample | None:
        """The point at a fraction of the way from a to b (in s); None where Newton fails or leaves the stretch."""
        s_a, s_b = self.length_of(a), self.length_of(b)
        s = s_a + fraction * (s_b - s_a)
        found = self.problem.probe(self.base, s, self._hermite(a, b, s_a, s_b, s), self.frame, self.settings)
        if found is None:
            return None
        slack = 2.0 * self.distance(a, b)
        if self.distance(found, a) > slack or self.distance(found, b) > slack:  # Newton jumped to another branch
            return None
        return found

    def _hermite(self, a: Sample, b: Sample, s_a: float, s_b: float, s: float) -> np.ndarray:
        h = s_b - s_a
        if h == 0.0:
            return np.asarray(a.z)
        x = (s - s_a) / h
        along_a, along_b = dot(self.base.tangent, a.tangent), dot(self.base.tangent, b.tangent)
        linear = a.z + x * (b.z - a.z)
        if min(abs(along_a), abs(along_b)) < 0.2:  # the parametrisation is poor here
            return linear
        slope_a = self.frame.scale * a.tangent / along_a * h
        slope_b = self.frame.scale * b.tangent / along_b * h
        chord = b.z - a.z
        return linear + x * (1 - x) * ((1 - x) * (slope_a - chord) - x * (slope_b - chord))

    def distance(self, a: Sample, b: Sample) -> float:
        return norm((a.z - b.z) / self.frame.scale)

    def zero(
        self, value: Callable[[Sample], float], a: Sample, b: Sample, accuracy: float, budget: int = 60
    ) -> tuple[Sample, Sample]:
        """Bracket of a sign change of `value` between a and b, narrowed to `accuracy` in s (secant inside bisection).

        Ridders-like: the secant point is taken while it shrinks the bracket, the middle otherwise, so that a jump
        (a corner of a piecewise equation) is found as surely as a zero.
        """
        f_a, f_b = value(a), value(b)
        width = abs(self.length_of(b) - self.length_of(a))
        bisect = False
        for _ in range(budget):
            if width <= accuracy or f_b == 0.0:
                break
            fraction = 0.5 if bisect or f_a == f_b else min(max(f_a / (f_a - f_b), 0.01), 0.99)
            middle = self.between(a, b, fraction)
            if middle is None:
                if fraction == 0.5:
                    break
                bisect = True
                continue
            f_middle = value(middle)
            if f_middle == 0.0:
                return middle, middle
            if (f_middle > 0.0) == (f_a > 0.0):
                a, f_a = middle, f_middle
            else:
                b, f_b = middle, f_middle
            new_width = abs(self.length_of(b) - self.length_of(a))
            bisect = new_width > 0.5 * width and not bisect
            width = new_width
        return a, b
